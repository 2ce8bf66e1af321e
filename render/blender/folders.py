# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the files of a scene are kept."""

import os

import bpy

from .set_file import SetFile


def folder_of(scene):
    """Of a scene's settings; a path relative to a file that is not saved is in Blender's temporary folder."""
    path = scene.shadowcache.cache_folder or "//shadowcache"
    if path.startswith("//") and not bpy.data.filepath:
        return os.path.join(bpy.app.tempdir, "shadowcache")
    return os.path.normpath(bpy.path.abspath(path))


def set_file_of(scene, layer_name):
    return SetFile(folder_of(scene), bpy.path.clean_name("%s.%s" % (scene.name, layer_name)))
