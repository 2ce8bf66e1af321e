# SPDX-License-Identifier: GPL-3.0-or-later
"""Light groups of a view layer: what they ask of the renderer, and the passes Combined_NAME that come of it."""

import bpy

from . import shining
from .blender_export.shown import materials_of

PREFIX = "Combined_"
OTHER = "other=*"  # what shines in no group of the layer


def names(layer):
    """Those of a view layer; Blender before 3.2 has none."""
    return [group.name for group in getattr(layer, "lightgroups", ())]


def of_world(scene):
    return getattr(scene.world, "lightgroup", "") if scene.world else ""


def members(depsgraph, shown):
    """The groups of the view layer that each name has, "" for none of them."""
    known, found = names(depsgraph.view_layer), {}
    for instance in depsgraph.object_instances:
        thing = instance.object
        if not instance.show_self:
            continue
        if isinstance(thing.data, bpy.types.Mesh):
            of_thing = {material.name for material in materials_of(thing, depsgraph) if material}
        else:
            of_thing = {thing.name} if thing.type == "LIGHT" else set()
        for name in of_thing & shown:
            found.setdefault(name, set()).add(thing.lightgroup if thing.lightgroup in known else "")
    return found


def rules_of(depsgraph, path):
    """Texts of the option light-groups, for a set's file, and what of the groups they cannot say."""
    shown = shining.names(path) if names(depsgraph.view_layer) else set()
    rules, left_out = [OTHER] if shown else [], []
    for name, groups in sorted(members(depsgraph, shown).items()):
        group = next(iter(groups))
        if len(groups) > 1:
            left_out.append("light group of %s: its objects are of several" % name)
        elif "*" in name or "=" in group:
            left_out.append("light group of %s: %s in a name" % (name, "*" if "*" in name else "="))
        elif group:
            rules.append("%s%s=%s" % (PREFIX, group, name))
    return rules, left_out


def join_sky(picture, rules, group):
    """Has the light of the sky be of the world's group."""
    sky = picture.rows.get("sky" if rules else "picture")
    if not group or sky is None:
        return
    others = picture.rows.get(PREFIX + group)
    picture.rows[PREFIX + group] = [a + b for a, b in zip(others, sky)] if others else sky
