# SPDX-License-Identifier: GPL-3.0-or-later
"""Direct light by this engine, the rest by Cycles: the scenes that Cycles renders, and how they follow.

They have no objects of their own: the scene is their Background Set, so that what it shows is what they show. The
compositor renders them after the scene, in the scene's frame and size.
"""

import bpy

from . import hybrid_check, hybrid_nodes

# Of the scene that Cycles renders with everything, and of the one with lamps and emission alone: it is there where their
# direct light is Cycles', and this engine's is that of the map alone.
REST, LAMPS = "Cycles", "Lamps"
FLAGS = ("use_pass_diffuse_direct", "use_pass_diffuse_color", "use_pass_glossy_direct", "use_pass_glossy_color")
MATTES = "use_pass_cryptomatte_material"
# What the scenes of Cycles have of the scene's.
OF_RENDER = ("resolution_x", "resolution_y", "resolution_percentage", "pixel_aspect_x", "pixel_aspect_y", "use_border",
             "use_crop_to_border", "border_min_x", "border_max_x", "border_min_y", "border_max_y", "film_transparent",
             "use_motion_blur", "fps", "fps_base", "frame_map_old", "frame_map_new", "use_simplify",
             "simplify_subdivision_render", "simplify_child_particles_render")
OF_SCENE = ("frame_start", "frame_end", "frame_step", "frame_current")
OF_CYCLES = ("samples", "use_adaptive_sampling", "adaptive_threshold", "adaptive_min_samples")  # for the lamps
FILTERS = {"blackman-harris": "BLACKMAN_HARRIS", "gaussian": "GAUSSIAN", "box": "BOX"}


def scenes_of(scene):
    """By REST and LAMPS; None where there is none. A copy of a scene has none of its own."""
    settings = scene.shadowcache
    both = {REST: settings.hybrid_rest, LAMPS: settings.hybrid_lamps}
    return {word: other if other and other.background_set == scene else None for word, other in both.items()}


def lights_lamps(scene):
    """Whether the direct light of lamps and emitters in a scene's hybrid is this engine's."""
    return not scenes_of(scene)[LAMPS]


def is_on(scene):
    """Whether the compositor makes a hybrid of a scene."""
    render = scene.render
    return bool(render.use_compositing and scene.use_nodes and hybrid_nodes.group_node(scene.node_tree))


def make(scene, layer, needs):
    """Scenes and nodes, or brings them up to date."""
    if not hasattr(scene, "cycles"):
        raise ValueError("Cycles is not there: enable it in Preferences > Add-ons")
    settings, there = scene.shadowcache, scenes_of(scene)
    settings.hybrid_rest = there[REST] or new_scene(scene, REST)
    if needs.lamps:
        settings.hybrid_lamps = there[LAMPS] or new_scene(scene, LAMPS)
    else:
        settings.hybrid_lamps = None
        if there[LAMPS]:
            bpy.data.scenes.remove(there[LAMPS])
    for of in (layer, *layers_of(scene)):
        for flag in FLAGS:
            setattr(of, flag, True)
    setattr(settings.hybrid_rest.view_layers[0], MATTES, bool(needs.masked))
    follow(scene)
    hybrid_nodes.make(scene, layer.name, settings.hybrid_rest, settings.hybrid_lamps, needs.masked)


def remove(scene):
    """Scenes and nodes; what the nodes fed is fed by the render again."""
    if scene.node_tree:
        hybrid_nodes.remove(scene.node_tree)
    for other in scenes_of(scene).values():
        if other:
            bpy.data.scenes.remove(other)


def new_scene(scene, word):
    found = bpy.data.scenes.new("%s %s" % (scene.name, word))
    found.background_set = scene
    found.render.engine = "CYCLES"
    for name, value in scene.cycles.items():  # those that are not the default
        found.cycles[name] = value
    if word == LAMPS:
        found.cycles.max_bounces = 0
    return found


def layers_of(scene):
    return [other.view_layers[0] for other in scenes_of(scene).values() if other]


def follow(scene, camera=None):
    """Gives the scenes of Cycles what they must have of the scene; the set, they have."""
    settings, there = scene.shadowcache, scenes_of(scene)
    for word, other in there.items():
        if not other:
            continue
        wanted = {(other, name): getattr(scene, name) for name in OF_SCENE}
        wanted.update({(other.render, name): getattr(scene.render, name) for name in OF_RENDER})
        wanted[other, "camera"] = camera or scene.camera
        wanted[other, "world"] = scene.world if word == REST else None
        wanted[other.cycles, "pixel_filter_type"] = FILTERS[settings.filter]
        wanted[other.cycles, "filter_width"] = settings.filter_width
        wanted[other.view_layers[0], "use"] = True
        wanted[other.cycles, "use_denoising"] = False  # Combined alone would be denoised, and passes taken from it
        wanted[other.cycles, "film_exposure"] = 1
        if word == LAMPS and there[REST]:
            wanted.update({(other.cycles, name): getattr(there[REST].cycles, name) for name in OF_CYCLES})
        for (owner, name), value in wanted.items():
            if getattr(owner, name) != value:
                setattr(owner, name, value)


def hold(scene):
    """Cycles renders nothing after an error, until a frame without one."""
    for layer in layers_of(scene):
        layer.use = False


def prepare(depsgraph, camera, entries, path):
    """Before Cycles renders a frame: its scenes follow. entries, path: as of needs_of(). Raises ValueError where the
    picture would be wrong."""
    scene = depsgraph.scene.original
    needs = hybrid_check.needs_of(depsgraph, entries, path)
    missing = [flag for of in (depsgraph.view_layer, *layers_of(scene)) for flag in FLAGS if not getattr(of, flag)]
    missing += set(needs.masked) - hybrid_nodes.masked(scene.node_tree)
    there = scenes_of(scene)
    if not there[REST]:
        missing.append("its scene")
    if lights_lamps(scene):
        missing += needs.lamps
    if scene.render.use_single_layer:
        raise ValueError("a hybrid would be wrong: Render Single Layer leaves Cycles out")
    if missing:
        raise ValueError("Hybrid: press Update, for " + ", ".join(dict.fromkeys(missing)))
    follow(scene, camera.original)
