# SPDX-License-Identifier: GPL-3.0-or-later
"""Options of shadowcache-render that are properties of a scene, by the table that the program prints (--options).

option_table.json is that table; a test compares the two.
"""

import json
import os

with open(os.path.join(os.path.dirname(__file__), "option_table.json"), encoding="utf-8") as file:
    ROWS = {row["blender"]: row for row in json.load(file)}

MOST_INT = 2**31 - 1


def property_of(name, bpy, /, **own):
    """The property of a row, by its name in Blender; `own`: what is said otherwise here."""
    row = ROWS[name]
    said = {"name": name.replace("_", " ").title(), "description": row["help"], **own}
    if row["form"] == "flag":
        return bpy.props.BoolProperty(**said)
    if row["form"] == "word":
        said.setdefault("items", [(word, word.replace("-", " ").title(), "") for word in row["choices"]])
        return bpy.props.EnumProperty(**{"default": row["standard"], **said})
    least, most = row["range"]
    if row["form"] == "whole":
        standard = int(row["standard"] or 0)
        return bpy.props.IntProperty(**{"min": int(least), "max": int(min(most, MOST_INT)), "default": standard, **said})
    return bpy.props.FloatProperty(**{"min": least, "max": most, "default": float(row["standard"] or 0), **said})


def values_of(settings):
    """Keys of the request options."""
    return {row["serve"]: getattr(settings, name) for name, row in ROWS.items()}
