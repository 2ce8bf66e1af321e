# SPDX-License-Identifier: GPL-3.0-or-later
"""Shadowcache as a render engine of Blender. The programs are processes of their own."""

bl_info = {
    "name": "Shadowcache",
    "author": "The Shadowcache authors",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "Properties > Render > Render Engine",
    "description": "Renders sets under environment maps from a cache of their visibility",
    "category": "Render",
}

from . import engine, operators, panels, preferences, properties  # noqa: E402

PARTS = (preferences, properties, engine, operators, panels)


def register():
    for part in PARTS:
        part.register()


def unregister():
    for part in reversed(PARTS):
        part.unregister()
