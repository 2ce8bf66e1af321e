"""Where to put solar panels: mean irradiance of all that faces up, over a day of a sky that turns, seen from above.

Usage: panels_on_a_roof.py CACHE MAP LEAST_HEIGHT OUT.png

Looks at what is above a height [m], and marks the ten best places, at least a metre apart.
"""
import sys

import numpy as np
from matplotlib.figure import Figure

import shadowcache

PANELS, APART = 10, 1.0

cache_file, map_file, height, out = sys.argv[1:]
cache = shadowcache.Cache.open(cache_file)
sky = shadowcache.Environment.load(map_file)

items = cache.items()
points = (items["voxel"] + items["position"]) * cache.spacing
up = (items["normal"][:, 1] > 0.5) & (points[:, 1] >= float(height))
if not up.any():
    sys.exit(f"{cache_file}: nothing faces up above {height} m")
items, points = items[up], points[up]

# One call looks all places up, on all cores.
turned = [sky.rotate(angle) for angle in range(0, 360, 15)]
day = np.mean([cache.irradiance(points, items["normal"], light).mean(axis=1) for light in turned], axis=0)

# What lies below something is darker: the best of each column of voxels is its top.
columns = items["voxel"][:, [0, 2]]
low = columns.min(axis=0)
roof = np.full(columns.max(axis=0) - low + 1, -1.0)
np.maximum.at(roof, tuple((columns - low).T), day)

chosen = []
for place in np.argsort(-day):
    if all(np.linalg.norm(points[place] - points[other]) >= APART for other in chosen):
        chosen.append(place)
    if len(chosen) == PANELS:
        break

figure = Figure(figsize=(7, 5), layout="constrained")
axes = figure.subplots()
high = low + roof.shape
extent = np.array([low[0], high[0], high[1], low[1]]) * cache.spacing
shown = axes.imshow(np.ma.masked_less(roof.T, 0), extent=extent, interpolation="nearest")
axes.scatter(points[chosen, 0], points[chosen, 2], s=60, facecolors="none", edgecolors="red", linewidths=1.2)
axes.set(xlabel="x [m]", ylabel="z [m]")
figure.colorbar(shown, label="mean irradiance of a day [radiance sr]", shrink=0.8)
figure.savefig(out, dpi=100)
for place in chosen:
    print("{:8.2f} {:8.2f} {:8.2f}  {:.3g}".format(*points[place], day[place]))
