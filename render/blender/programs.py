# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the programs of Shadowcache are."""

import os
import shutil

HOW_TO_GET = ("install them (docs/blender.md), or name their folder in "
              "Edit > Preferences > Add-ons > Shadowcache")


class Missing(Exception):
    """A program is not there; the text says how to get it."""


def find(name, folder=""):
    """Path of a program: in `folder` or its folders bake/ and render/, as a build has them, or else on PATH."""
    if folder:
        for part in ("", "bin", "bake", "render"):
            path = os.path.join(folder, part, name)
            if os.path.isfile(path) and os.access(path, os.X_OK):
                return path
        raise Missing("%s: no program %s there: %s" % (folder, name, HOW_TO_GET))
    path = shutil.which(name)
    if not path:
        raise Missing("%s is not on PATH: %s" % (name, HOW_TO_GET))
    return path
