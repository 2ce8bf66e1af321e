"""Runs something with the depsgraph of a render.

A render has a depsgraph of its own, with the levels of modifiers, the visibility of objects, collections and
modifiers, the resolution of curves and the number of particles that are set for renders, and geometry nodes that ask
are told that it is no viewport. An engine gets it from Blender. The other way is to copy the settings of renders over
those of the viewport before evaluating: that needs a list of all such settings, in modifiers, nodes, curves,
particles, collections and Simplify, and is wrong wherever the list has a gap. So this starts a render with an engine
that draws nothing.
"""

import bpy

from .cameras import STAND_IN

PLAIN = {"use_compositing": False, "use_sequencer": False, "use_multiview": False, "use_freestyle": False,
         "use_single_layer": True}


def with_render_depsgraph(work):
    """Returns work(depsgraph, set_frame), called within a render of the context's scene; what it raises is raised.
    set_frame(frame) evaluates the depsgraph in that frame."""
    results, errors = [], []

    class Engine(bpy.types.RenderEngine):
        bl_idname = "SHADOWCACHE_EXPORT"
        bl_label = "Shadowcache export"

        def render(self, depsgraph):
            try:
                results.append(work(depsgraph, lambda frame: self.frame_set(frame, 0.0)))
            except Exception as error:  # to the caller: Blender would print it and go on
                errors.append(error)
            finally:
                # Without a result Blender may crash when the render ends.
                self.end_result(self.begin_result(0, 0, 1, 1))

    scene = bpy.context.scene
    render = scene.render
    before = {name: getattr(render, name) for name in ("engine", *PLAIN)}
    camera = None if scene.camera else add_camera(scene)
    bpy.utils.register_class(Engine)
    try:
        for name, value in PLAIN.items():
            setattr(render, name, value)
        render.engine = Engine.bl_idname
        bpy.ops.render.render()
    finally:
        for name, value in before.items():
            setattr(render, name, value)
        bpy.utils.unregister_class(Engine)
        if camera:
            bpy.data.cameras.remove(camera)
    if errors:
        raise errors[0]
    if not results:
        raise RuntimeError("Blender rendered nothing, expected a view layer that is used for renders")
    return results[0]


def add_camera(scene):
    """A hidden camera, because Blender renders nothing without one."""
    camera = bpy.data.cameras.new(STAND_IN)
    thing = bpy.data.objects.new(STAND_IN, camera)
    thing.hide_render = True
    scene.collection.objects.link(thing)
    scene.camera = thing
    return camera
