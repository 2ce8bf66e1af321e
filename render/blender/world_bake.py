# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders a world alone to a map, in a Blender that was started for it.

Usage: blender -b --factory-startup --python-exit-code 1 -P world_bake.py -- WORLD.blend HELD.json NAME FRAME MAP.exr
HELD.json has what animation and drivers made of the nodes, and images that no file has, each with its texels beside it.
The map is made again at twice the size until its integral is that of a map of half the size and four times the samples.
"""

import json
import math
import os
import sys

import bpy
import numpy

FIRST_WIDTH, LAST_WIDTH, SAMPLES = 1024, 4096, 32
TOLERANCE = 0.01  # of the integral


def hold(world, values):
    """Puts values in the place of animation and drivers."""
    for tree in (world.node_tree, *bpy.data.node_groups):
        tree.animation_data_clear()
    for group, path, value in values:
        owner, _, name = path.rpartition(".")
        if owner:  # else a property of its own, which only drivers read
            setattr((bpy.data.node_groups[group] if group else world.node_tree).path_resolve(owner), name, value)


def hand_over(world, images, folder):
    """Puts images in the place of those whose texels the file does not have."""
    for group, node, file, settings in images:
        texels = numpy.load(os.path.join(folder, file))
        made = bpy.data.images.new(node, texels.shape[1], texels.shape[0], alpha=True, float_buffer=settings["is_float"])
        made.colorspace_settings.name, made.alpha_mode = settings["space"], settings["alpha_mode"]
        made.pixels.foreach_set(texels.ravel())
        made.update()
        tree = bpy.data.node_groups[group] if group else world.node_tree
        tree.nodes[node].image = made


def set_up(blend, held, name, frame):
    with bpy.data.libraries.load(blend) as (_, wanted):
        wanted.worlds = [name]
    scene = bpy.context.scene
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    scene.world = wanted.worlds[0]
    with open(held, encoding="utf-8") as file:
        found = json.load(file)
    hand_over(scene.world, found["images"], os.path.dirname(held))
    hold(scene.world, found["values"])
    camera = bpy.data.cameras.new("panorama")
    thing = bpy.data.objects.new("panorama", camera)
    # Its middle is at +x.
    thing.rotation_euler = (math.pi / 2, 0, -math.pi / 2)
    scene.collection.objects.link(thing)
    scene.camera = thing
    scene.frame_set(frame)
    scene.world.cycles.sampling_method = "NONE"  # nothing is lit
    render, cycles = scene.render, scene.cycles
    render.engine = "CYCLES"
    camera.type = "PANO"
    camera.cycles.panorama_type = "EQUIRECTANGULAR"
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.pixel_filter_type = "BOX"
    cycles.filter_width = 1
    render.resolution_percentage = 100
    render.image_settings.file_format = "OPEN_EXR"
    render.image_settings.color_depth = "32"
    render.image_settings.exr_codec = "ZIP"
    render.use_compositing = render.use_sequencer = False


def render(path, width, samples):
    """Renders the map; its integral over the sphere."""
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = width, width // 2
    scene.cycles.samples = samples
    scene.render.filepath = path
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(path)
    image.colorspace_settings.name = "Non-Color"
    texels = numpy.empty(len(image.pixels), numpy.float32)
    image.pixels.foreach_get(texels)
    bpy.data.images.remove(image)
    rows = texels.reshape(width // 2, width, 4)[..., :3].sum(axis=1, dtype=float)
    edges = numpy.cos(numpy.linspace(0, math.pi, width // 2 + 1))
    return (rows * (edges[:-1] - edges[1:])[:, None]).sum(axis=0) * 2 * math.pi / width


def main():
    blend, held, name, frame, path = sys.argv[sys.argv.index("--") + 1:]
    set_up(blend, held, name, int(frame))
    width = FIRST_WIDTH
    while True:
        wanted = render(path, width // 2, 4 * SAMPLES)
        found = render(path, width, SAMPLES)
        if numpy.allclose(found, wanted, rtol=TOLERANCE, atol=1e-9):
            return
        if width == LAST_WIDTH:
            sys.exit("its integral is %s, and %s by other samples" % (found, wanted))
        width *= 2


main()
