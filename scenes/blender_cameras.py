"""Renders the alpha of one set through several cameras in Cycles, and exports set and cameras as the exporter does.

Usage: blender -b --factory-startup --python-exit-code 1 --python blender_cameras.py -- FOLDER
Each camera is a frame of FOLDER/NAME.json, its alpha FOLDER/NAME.exr; the set is FOLDER/set.ply.
"""

import math
import os
import sys

import bpy

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import blender_export  # noqa: E402


def make_set():
    """Spheres and bars, near and far, that leave most of the picture to the sky."""
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    for i in range(6):
        place = (0.7 * i - 1.75, 1.2 * i, 0.25 * (i % 3))
        bpy.ops.mesh.primitive_uv_sphere_add(radius=0.3, location=place)
        bpy.ops.mesh.primitive_cube_add(size=1, location=(place[0], place[1], -0.8))
        bpy.context.object.scale = (0.08, 0.08, 1.2)


def make_camera():
    data = bpy.data.cameras.new("camera")
    thing = bpy.data.objects.new("camera", data)
    thing.location = (0.3, -4, 0.4)
    thing.rotation_euler = (math.radians(87), math.radians(4), math.radians(3))
    bpy.context.scene.collection.objects.link(thing)
    bpy.context.scene.camera = thing
    return data


def plain(data):
    data.type, data.lens, data.shift_x, data.shift_y = "PERSP", 40, 0, 0
    data.clip_start, data.clip_end, data.dof.use_dof = 0.1, 100, False
    bpy.context.scene.render.pixel_aspect_x = 1


def shifted(data):
    data.shift_x, data.shift_y = 0.2, -0.1


def orthographic(data):
    data.type, data.ortho_scale, data.shift_x = "ORTHO", 5, -0.15


def wide_pixels(data):
    bpy.context.scene.render.pixel_aspect_x = 2
    data.shift_y = 0.05


def clipped(data):
    data.clip_start, data.clip_end = 4.6, 8.3


def soft(data, blades=0):
    data.dof.use_dof, data.dof.focus_distance, data.dof.aperture_fstop = True, 5, 0.06
    data.dof.aperture_blades, data.dof.aperture_rotation = blades, 0.4


def triangular(data):
    soft(data, 3)


def main():
    folder = sys.argv[sys.argv.index("--") + 1]
    make_set()
    data = make_camera()
    scene = bpy.context.scene
    scene.frame_start = scene.frame_end = 1
    render = scene.render
    render.engine, render.film_transparent = "CYCLES", True
    render.resolution_x, render.resolution_y, render.resolution_percentage = 96, 64, 100
    scene.cycles.samples, scene.cycles.max_bounces = 256, 0
    scene.cycles.pixel_filter_type = "BOX"
    scene.cycles.filter_width, scene.cycles.use_adaptive_sampling, scene.cycles.use_denoising = 1, False, False
    render.image_settings.file_format, render.image_settings.color_mode = "OPEN_EXR", "RGBA"
    for set_up in (plain, shifted, orthographic, wide_pixels, clipped, soft, triangular):
        plain(data)
        set_up(data)
        name = os.path.join(folder, set_up.__name__)
        left_out = blender_export.with_render_depsgraph(
            lambda depsgraph, set_frame: blender_export.export_camera(depsgraph, name + ".json", set_frame))
        assert not left_out, left_out
        render.filepath = name + ".exr"
        bpy.ops.render.render(write_still=True)
    blender_export.with_render_depsgraph(
        lambda depsgraph, set_frame: blender_export.export(depsgraph, os.path.join(folder, "set.ply"), set_frame))


main()
