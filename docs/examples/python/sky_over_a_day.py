"""Irradiance of a place over a day, as the sky turns about it: of the set, and without the set.

Usage: sky_over_a_day.py CACHE MAP X,Y,Z OUT.png
"""
import sys

import numpy as np
from matplotlib.figure import Figure

import shadowcache

cache_file, map_file, place, out = sys.argv[1:]
cache = shadowcache.Cache.open(cache_file)
sky = shadowcache.Environment.load(map_file)

# Of the items within a voxel of the place that face up, the most open one: others may lie below it. Its normal is that of
# the surface.
items = cache.items()
points = (items["voxel"] + items["position"]) * cache.spacing
distance = np.linalg.norm(points - [float(word) for word in place.split(",")], axis=1)
near = (items["normal"][:, 1] > 0.9) & (distance <= cache.spacing)
if not near.any():
    sys.exit(f"{cache_file}: nothing faces up within {cache.spacing:g} m of {place}")
points, normals = points[near], items["normal"][near]
item = np.argmax(cache.irradiance(points, normals, shadowcache.Environment.constant(1))[:, 0])
point, normal = points[item], normals[item]

hours = np.arange(0, 24.25, 0.25)
turned = [sky.rotate(15 * hour) for hour in hours]
seen = np.array([cache.irradiance(point, normal, light) for light in turned])

directions, radiances, densities = sky.sample(1 << 16)
cosine = np.maximum(0, directions[:, 1])  # a turn about +Y changes nothing without a set
unshadowed = (radiances * (cosine / densities)[:, None]).mean(axis=0)

figure = Figure(figsize=(7, 3.6), layout="constrained")
axes = figure.subplots()
for channel, color in enumerate(("tab:red", "tab:green", "tab:blue")):
    axes.plot(hours, seen[:, channel], color=color)
    axes.axhline(unshadowed[channel], color=color, linestyle=":", linewidth=1)
axes.set(xlabel="hour, 15 degrees each", ylabel="irradiance [radiance sr]", xlim=(0, 24), xticks=range(0, 25, 3), ylim=0)
axes.set_title("({:.1f}, {:.1f}, {:.1f}): lines with the set, dots without".format(*point), fontsize=10)
figure.savefig(out, dpi=100)
