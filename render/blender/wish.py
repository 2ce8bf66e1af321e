# SPDX-License-Identifier: GPL-3.0-or-later
"""What a 3D view wants to see: plain data, which another thread may read."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Wish:
    programs: str    # their folder
    load: dict       # keys of the request load
    stamps: tuple    # of its files
    gains: tuple     # of the request lamps
    world: object    # keys of the request environment, or a world_map.Baking that makes them
    view: dict       # keys of the request camera, but for pixel_aspect
    aspect: float    # of the view
    size: tuple      # in pixels
    options: dict    # of the picture when it rests
    frame: int
    note: str        # on the cache, for the status line
