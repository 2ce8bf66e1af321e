"""What a render shows: the instances of the depsgraph, and what of them cannot be expressed."""

from dataclasses import dataclass

import bpy
import numpy

from .differences import differences

IGNORED = {"EMPTY", "LATTICE", "ARMATURE", "SPEAKER", "LIGHT_PROBE", "CAMERA"}


@dataclass
class Shown:
    """A mesh, a camera or a lamp at its place. The mesh and its materials live until the depsgraph changes."""
    row: int         # among the depsgraph's instances
    name: str
    kind: str        # MESH, CAMERA or LIGHT
    key: tuple       # the same for all that show the same mesh with the same materials
    thing: object    # the evaluated object: only until the walk goes on


def walk(depsgraph, report):
    """Yields what is shown, one after the other. A render depsgraph has no more than a render shows: objects that are
    hidden there, or in hidden or excluded collections, are not in it."""
    looked_at = set()
    for row, instance in enumerate(depsgraph.object_instances):
        thing = instance.object
        if not instance.show_self:
            if instance.show_particles:
                name_hair(thing, depsgraph, report)
            continue
        data = thing.data
        owner = instance.instance_object or thing
        if isinstance(data, bpy.types.Mesh):
            key = (owner.as_pointer(), data.as_pointer())
            kind = "MESH"
        elif thing.type in ("CAMERA", "LIGHT"):
            key, kind = (), thing.type
        else:
            key, kind = (owner.as_pointer(), 0), ""
        instancer = instance.parent if instance.is_instance else None
        looked = *key, kind, instancer and instancer.as_pointer()
        if looked not in looked_at:
            looked_at.add(looked)
            look_at(thing, kind, instancer, depsgraph, report)
        if kind:
            yield Shown(row, thing.name, kind, key, thing)


def look_at(thing, kind, instancer, depsgraph, report):
    """Adds to the report what an object has that is not exported; instancer: the object that shows it, or None."""
    if not kind and thing.type not in IGNORED and not has_mesh(thing):
        report.add("%s %s" % (thing.type.lower(), thing.name))
    if kind != "MESH":
        return
    for owner in (thing, instancer) if instancer else (thing,):
        for text in unlike_others(owner, depsgraph.view_layer):
            report.add("object %s: %s" % (owner.name, text))
    sizes = [axis.length for axis in thing.matrix_world.to_3x3().col]
    if min(sizes) == 0 < max(sizes):
        report.add("object %s: it is flat, by a scale of 0" % thing.name)
    name_hair(thing, depsgraph, report)


def name_hair(thing, depsgraph, report):
    """Of an object that emits it, which may be hidden itself."""
    is_on = "show_render" if depsgraph.mode == "RENDER" else "show_viewport"
    for modifier in thing.modifiers:
        if modifier.type == "PARTICLE_SYSTEM" and getattr(modifier, is_on):
            settings = modifier.particle_system.settings
            if settings.type == "HAIR" and settings.render_type == "PATH":
                report.add("object %s: hair %s" % (thing.name, modifier.particle_system.name))


def unlike_others(thing, layer):
    """As texts, how rays meet an object otherwise than a surface, and what of it is not understood. What an instancer
    has so holds for all that it shows."""
    yield from differences(thing)
    if thing.is_shadow_catcher:
        yield "shadow catcher"
    if thing.is_holdout or thing.original.holdout_get(view_layer=layer):
        yield "holdout"
    if thing.original.indirect_only_get(view_layer=layer):
        yield "indirect only"


def has_mesh(thing):
    """Curves and texts come once with their mesh, and once more as what they are."""
    return thing.type in ("CURVE", "SURFACE", "FONT", "META")


def materials_of(thing, depsgraph):
    """Material, or None, for each slot."""
    override = depsgraph.view_layer_eval.material_override
    slots = [slot.material for slot in thing.material_slots]
    return [override] * max(len(slots), 1) if override else slots


def world_matrices(depsgraph):
    """Of all instances, (n, 4, 4); Blender has them by columns."""
    values = numpy.empty(16 * len(depsgraph.object_instances), numpy.float32)
    depsgraph.object_instances.foreach_get("matrix_world", values)
    return values.reshape(-1, 4, 4).transpose(0, 2, 1).astype(float)


def other_layers(depsgraph):
    """View layers that a render makes and that are not exported."""
    return [v.name for v in depsgraph.scene.view_layers if v.use and v.name != depsgraph.view_layer.name]
