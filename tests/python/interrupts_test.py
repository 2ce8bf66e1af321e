"""Ctrl-C ends each call of the module within a second, or, where other programs slow the machine down, within a second of the processor."""
import os
import signal
import threading
import time
from functools import partial

import numpy as np
import pytest

import shadowcache
from small_set import MAP, OPEN, UP


def many(count, place=OPEN):
    """Rows of one place, or of one direction, that take no memory."""
    return np.broadcast_to(place, (count, 3))


# Calls by name, each with what it needs made before it is called.
CALLS = {
    "render": lambda scene, cache, white: partial(
        shadowcache.render, scene, cache, white, shadowcache.Camera((3, 2, 4), (0, 0.3, 0)), size=(640, 360), spp=4096),
    "bake": lambda scene, cache, white: partial(shadowcache.bake, scene, spacing=0.004, rays=255),
    "map": lambda scene, cache, white: partial(shadowcache.Environment.from_array(np.ones((64, 128, 3))).rotate, 1),
    "from_array": lambda scene, cache, white: partial(shadowcache.Environment.from_array, np.broadcast_to(1.0, (4096, 8192, 3))),
    "sample": lambda scene, cache, white: partial(white.sample, 1 << 24),
    "look_up": lambda scene, cache, white: partial(white.look_up, many(1 << 24, UP)),
    "visibility": lambda scene, cache, white: partial(cache.visibility, OPEN, UP, many(1 << 26, UP)),
    "intersect": lambda scene, cache, white: partial(scene.intersect, many(1 << 24), UP),
    "occluded": lambda scene, cache, white: partial(scene.occluded, many(1 << 24), UP),
    "visibility in the air": lambda scene, cache, white: partial(
        cache.visibility, (1, 0.5, 0), UP, many(1 << 24, UP), scene=scene),
    "irradiance": lambda scene, cache, white: partial(cache.irradiance, many(1 << 22), UP, white),
    "irradiance in the air": lambda scene, cache, white: partial(
        cache.irradiance, many(1 << 16, (0.5, 0.5, 0.5)), UP, white, scene=scene),
    "operator": lambda scene, cache, white: partial(
        cache.operator, many(1 << 14, (0.5, 0.5, 0.5)), UP, scene=scene, bounces=2),
    "sampler": lambda scene, cache, white: lambda: cache.sampler(white).sample(OPEN, UP, count=1 << 22),
    "sampler's look_up": lambda scene, cache, white: lambda: cache.sampler(white).look_up(OPEN, UP, many(1 << 20, UP)),
    "integrate": lambda scene, cache, white: lambda: shadowcache.Environment.load(MAP).integrate(),
    "patches": lambda scene, cache, white: partial(white.patches, 5),
    "with_lamps": lambda scene, cache, white: lambda: scene.with_lamps(shadowcache.Lamps.points(OPEN, 1)),
}


def spent():
    """Seconds until now: of the clock, and of the processor by all threads."""
    return time.monotonic(), time.process_time()


def assert_soon(sent):
    """A second at most since `sent`, by one of the two, and no long wait."""
    wall, busy = np.subtract(spent(), sent)
    print(f"ended {wall:.2f} s after the signal, {busy:.2f} s of the processor")
    assert min(wall, busy) < 1
    assert wall < 20


@pytest.mark.parametrize("name", CALLS)
def test_interrupt_within_a_second(scene, cache, white, name):
    call, sent = CALLS[name](scene, cache, white), []

    def interrupt():
        sent.append(spent())
        os.kill(os.getpid(), signal.SIGINT)

    threading.Timer(0.05, interrupt).start()
    with pytest.raises(KeyboardInterrupt):
        while True:  # some calls are done before
            call()
    assert_soon(sent[0])
    # The module goes on.
    assert cache.visibility(OPEN, UP, UP) == 1


def grid(side):
    """Vertices and 2 side^2 triangles of rough ground."""
    x, z = np.meshgrid(np.arange(side + 1) * 0.01, np.arange(side + 1) * 0.01, indexing="ij")
    height = np.random.default_rng(1).random(x.shape) * 0.005
    corner = (np.arange(side)[:, None] * (side + 1) + np.arange(side)).ravel()
    offsets = np.array([[0, 1, side + 1], [1, side + 2, side + 1]])
    return np.stack([x, height, z], axis=-1).reshape(-1, 3), (corner[:, None, None] + offsets).reshape(-1, 3)


def test_interrupt_while_a_large_set_is_built():
    vertices, triangles = grid(700)
    begin = time.monotonic()
    assert shadowcache.load_set(vertices, triangles).triangles == 980000
    seconds, late, of_the_rest = time.monotonic() - begin, [], []
    for share in (0.2, 0.4, 0.8):  # the last ones are of the acceleration structure
        sent = []
        timer = threading.Timer(share * seconds, lambda at=sent: (at.append(time.monotonic()), os.kill(os.getpid(), signal.SIGINT)))
        timer.start()
        try:
            shadowcache.load_set(vertices, triangles)
            timer.cancel()
            timer.join()
        except KeyboardInterrupt:
            late.append(time.monotonic() - sent[0])
            of_the_rest += [late[-1] / ((1 - share) * seconds)] if share < 0.5 else []
    print(f"of {seconds:.2f} s; ended so many seconds after the signal: {late}, parts of what was left: {of_the_rest}")
    assert len(late) >= 2 and max(late) < 1
    assert min(of_the_rest) < 0.5  # a call that went on to its end would have taken all of it
