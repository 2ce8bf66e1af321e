# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the programs are, by the add-on's preferences."""

import bpy

from . import programs

NEEDED = ("shadowcache-bake", "shadowcache-render")


class ShadowcachePreferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    folder: bpy.props.StringProperty(
        name="Programs", subtype="DIR_PATH",
        description="Folder of shadowcache-bake and shadowcache-render, or of a build. Empty: those on PATH")

    def draw(self, context):
        column = self.layout.column()
        column.prop(self, "folder")
        for name in NEEDED:
            try:
                column.label(text=programs.find(name, program_folder()), icon="CHECKMARK")
            except programs.Missing as missing:
                column.label(text=str(missing), icon="ERROR")


def program_folder():
    addon = bpy.context.preferences.addons.get(__package__)
    return bpy.path.abspath(addon.preferences.folder) if addon and addon.preferences else ""


def register():
    bpy.utils.register_class(ShadowcachePreferences)


def unregister():
    bpy.utils.unregister_class(ShadowcachePreferences)
