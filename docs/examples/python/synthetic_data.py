"""Pictures to learn from: a set under N skies, from N cameras each, of one bake.

Usage: synthetic_data.py SET CACHE MAP CAMERAS N OUT.png

CAMERAS is a camera file; N of its frames are taken, from the first to the 24th. OUT.png is a sheet of all pictures; colour, normals
and depth of each are in OUT.npz, linear, (N, N, height, width, 3).
"""
import sys
import time

import numpy as np
from matplotlib.figure import Figure

import shadowcache

SIZE, LAST_FRAME = (96, 54), 24

set_file, cache_file, map_file, camera_file, count, out = sys.argv[1:]
count = int(count)
scene, cache = shadowcache.load_set(set_file), shadowcache.Cache.open(cache_file)
sky = shadowcache.Environment.load(map_file)
skies = [sky.rotate(360 * i / count) for i in range(count)]
frames = np.linspace(1, LAST_FRAME, count).astype(int).tolist()
cameras = [shadowcache.Camera.load(camera_file, frame=frame) for frame in frames]

begin = time.monotonic()
pictures = [[shadowcache.render(scene, cache, light, camera, size=SIZE, camera_rays=4, samples=4, bounces=0,
                                aovs=["normal", "depth"]) for camera in cameras] for light in skies]
print(f"{count * count / (time.monotonic() - begin):.1f} pictures a second")
data = {name: np.array([[picture[name] for picture in row] for row in pictures]) for name in pictures[0][0]}
np.savez_compressed(out.rpartition(".")[0] + ".npz", **data)

# A row a sky, a column a camera; exposed so that the mean is at a fifth.
sheet = data["color"].swapaxes(1, 2).reshape(count * SIZE[1], count * SIZE[0], 3)
shown = np.clip(sheet * (0.2 / sheet.mean()), 0, 1) ** (1 / 2.2)
figure = Figure(figsize=(shown.shape[1] / 100, shown.shape[0] / 100))
figure.figimage(shown)
figure.savefig(out, dpi=100)
