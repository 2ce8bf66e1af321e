# Renders one grid of an OpenVDB file with Blender (3.4, headless), as an artist would show it:
#   blender -b --factory-startup --python-exit-code 1 -P scenes/volume_picture.py -- \
#       grids.vdb GRID out.png [WIDTH HEIGHT SAMPLES]
# A fog volume glows in the false colours of the reports, a vector by its direction or colour; the
# file must hold the grid `surface` too, which tells where a grid's own zeros end. GRID `density` gets
# no material at all: it is what Blender shows at once.
import math
import sys

import bpy
from mathutils import Matrix, Vector

arguments = sys.argv[sys.argv.index("--") + 1:]
file, name, output = arguments[:3]
width, height, samples = (int(a) for a in (arguments[3:] or ["480", "270", "32"]))

# What the file holds, as Blender reads it.
scene = bpy.context.scene
for thing in list(bpy.data.objects):
    bpy.data.objects.remove(thing)
volume = bpy.data.volumes.new("cache")
volume.filepath = file
cache = bpy.data.objects.new("cache", volume)
cache.matrix_world = Matrix.Rotation(math.pi / 2, 4, "X")  # +Y up becomes Blender's +Z up
scene.collection.objects.link(cache)
if not volume.grids.load():
    sys.exit("Blender cannot load %s: %s" % (file, volume.grids.error_message))
grid = volume.grids.get(name)
if grid is None:
    sys.exit("Blender finds no grid %s in %s" % (name, file))
print("grid", grid.name, grid.data_type)


def glow(grid):
    """A volume material: the grid's colour on the voxels of `surface`, opaque within one."""
    material = bpy.data.materials.new(grid.name)
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    value = nodes.new("ShaderNodeAttribute")
    value.attribute_name = grid.name
    surface = nodes.new("ShaderNodeAttribute")
    surface.attribute_name = "surface"
    # Between a voxel and the empty one beside it both grids fade alike: their ratio does not.
    ratio = nodes.new("ShaderNodeVectorMath")
    ratio.operation = "DIVIDE"
    links.new(value.outputs["Vector"], ratio.inputs[0])
    links.new(surface.outputs["Vector"], ratio.inputs[1])
    there = nodes.new("ShaderNodeMath")
    there.operation = "GREATER_THAN"
    there.inputs[1].default_value = 0.4
    links.new(surface.outputs["Fac"], there.inputs[0])
    density = nodes.new("ShaderNodeMath")
    density.operation = "MULTIPLY"
    density.inputs[1].default_value = 40
    emission = nodes.new("ShaderNodeEmission")
    absorption = nodes.new("ShaderNodeVolumeAbsorption")
    absorption.inputs["Color"].default_value = (0, 0, 0, 1)
    both = nodes.new("ShaderNodeAddShader")
    output = nodes.new("ShaderNodeOutputMaterial")
    if grid.data_type == "FLOAT":
        color = nodes.new("ShaderNodeValToRGB")
        stops = [(68, 1, 84), (59, 81, 139), (33, 144, 141), (92, 200, 99), (253, 231, 37)]
        ramp = color.color_ramp.elements
        while len(ramp) < len(stops):
            ramp.new(0.5)
        for k, stop in enumerate(stops):
            ramp[k].position = k / (len(stops) - 1)
            ramp[k].color = [((c / 255 + 0.055) / 1.055) ** 2.4 for c in stop] + [1]
        links.new(ratio.outputs[0], color.inputs["Fac"])
    else:
        # Directions have negative parts: -1 to 1 becomes 0 to 1. Light has none.
        is_direction = "direction" in grid.name
        color = nodes.new("ShaderNodeVectorMath")
        color.operation = "MULTIPLY_ADD"
        color.inputs[1].default_value = (0.5, 0.5, 0.5) if is_direction else (0.3, 0.3, 0.3)
        color.inputs[2].default_value = (0.5, 0.5, 0.5) if is_direction else (0, 0, 0)
        links.new(ratio.outputs[0], color.inputs[0])
    links.new(there.outputs[0], density.inputs[0])
    links.new(density.outputs[0], emission.inputs["Strength"])
    links.new(density.outputs[0], absorption.inputs["Density"])
    links.new(color.outputs[0], emission.inputs["Color"])
    links.new(emission.outputs[0], both.inputs[0])
    links.new(absorption.outputs[0], both.inputs[1])
    links.new(both.outputs[0], output.inputs["Volume"])
    return material


if name == "density":
    sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    sun.data.energy = 10
    sun.rotation_euler = (0.6, 0.3, 0)
    scene.collection.objects.link(sun)
else:
    volume.materials.append(glow(grid))

bpy.context.view_layer.update()
corners = [cache.matrix_world @ Vector(corner) for corner in cache.bound_box]
low = Vector(min(c[k] for c in corners) for k in range(3))
high = Vector(max(c[k] for c in corners) for k in range(3))
middle, radius = (low + high) / 2, (high - low).length / 2
camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
back = Vector((0.35, -0.75, 1.0)).normalized()
camera.location = middle + back * radius * 2.9
camera.rotation_euler = back.to_track_quat("Z", "Y").to_euler()
camera.data.angle = math.radians(44)
camera.data.clip_end = 10 * radius
scene.collection.objects.link(camera)
scene.camera = camera

world = bpy.data.worlds.new("world")
world.use_nodes = True
world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.9, 0.9, 0.9, 1)
scene.world = world
scene.render.engine = "CYCLES"
scene.cycles.samples = samples
scene.cycles.use_denoising = False
scene.cycles.volume_bounces = 0
scene.cycles.volume_step_rate = 1
scene.view_settings.view_transform = "Standard"
scene.render.resolution_x, scene.render.resolution_y = width, height
scene.render.resolution_percentage = 100
scene.render.image_settings.file_format = "PNG"
scene.render.filepath = output
bpy.ops.render.render(write_still=True)
