"""Draws a cache that shadowcache and pyopenvdb (Debian package python3-openvdb) have open at once.

Usage: beside_pyopenvdb.py CACHE OUT.png

Left: the grid `openness`, which every volume tool reads, in the fullest layer of voxels: means over all sides of a voxel.
Right: the irradiance that a white sky would give what faces up, the brightest of each voxel.
"""
import sys

import numpy as np
import pyopenvdb as vdb
from matplotlib.figure import Figure

import shadowcache

cache_file, out = sys.argv[1:]
cache = shadowcache.Cache.open(cache_file)
items = cache.items()
grid = vdb.read(cache_file, "openness")
assert np.isclose(grid.transform.voxelSize()[0], cache.spacing)

heights, counts = np.unique(items["voxel"][:, 1], return_counts=True)
layer = int(heights[np.argmax(counts)])
low = items["voxel"].min(axis=0)
size = items["voxel"].max(axis=0) - low + 1
openness = np.zeros((size[0], 1, size[2]), np.float32)
grid.copyToArray(openness, ijk=(int(low[0]), layer, int(low[2])))

here = items[(items["voxel"][:, 1] == layer) & (items["normal"][:, 1] > 0.5)]
points = (here["voxel"] + here["position"]) * cache.spacing
light = cache.irradiance(points, here["normal"], shadowcache.Environment.constant(1))[:, 0]
brightest = np.full((size[0], size[2]), -1.0)
np.maximum.at(brightest, tuple((here["voxel"] - low)[:, [0, 2]].T), light)
seen = np.ma.masked_less(brightest, 0)

extent = np.array([low[0], low[0] + size[0], low[2] + size[2], low[2]]) * cache.spacing
figure = Figure(figsize=(10, 3.8), layout="constrained")
axes = figure.subplots(1, 2, sharex=True, sharey=True)
pictures = (np.ma.masked_array(openness[:, 0], seen.mask), seen)
titles = (f"pyopenvdb: openness at y = {layer * cache.spacing:.2g} m", "shadowcache: irradiance of a white sky")
for axis, picture, title in zip(axes, pictures, titles):
    shown = axis.imshow(picture.T, extent=extent, interpolation="nearest")
    axis.set_title(title, fontsize=10)
    axis.set(xlabel="x [m]")
    figure.colorbar(shown, ax=axis, shrink=0.8)
axes[0].set_ylabel("z [m]")
figure.savefig(out, dpi=100)
