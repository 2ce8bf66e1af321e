# SPDX-License-Identifier: GPL-3.0-or-later
"""Packs the add-on as a zip that Blender installs, with the exporter of scenes/.

Usage: python3 render/blender/pack.py shadowcache-blender.zip
"""

import os
import sys
import zipfile

HERE = os.path.dirname(os.path.abspath(__file__))
EXPORTER = os.path.join(HERE, os.pardir, os.pardir, "scenes", "blender_export")
SUFFIXES = (".py", ".json", ".toml")
THEN = (1980, 1, 1, 0, 0, 0)  # so that equal sources make equal bytes


def files():
    """Path in the zip, and of the source, of each file."""
    for folder, inside in ((HERE, "shadowcache"), (EXPORTER, "shadowcache/blender_export")):
        for name in sorted(os.listdir(folder)):
            if name == "LICENSE" or name.endswith(SUFFIXES) and name != os.path.basename(__file__):
                yield "%s/%s" % (inside, name), os.path.join(folder, name)


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    with zipfile.ZipFile(sys.argv[1] + ".part", "w", zipfile.ZIP_DEFLATED) as out:
        for inside, path in files():
            with open(path, "rb") as file:
                out.writestr(zipfile.ZipInfo(inside, THEN), file.read(), zipfile.ZIP_DEFLATED)
    os.replace(sys.argv[1] + ".part", sys.argv[1])


main()
