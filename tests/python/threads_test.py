"""Threads and processes that use the module: the same bits, progress, memory, pickles."""
import gc
import os
import pickle
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import shadowcache
from small_set import MAP, OPEN, TRIANGLES, UP, VERTICES


def test_threads_of_a_call(scene, cache, white, camera):
    def all_of(threads):
        baked = shadowcache.bake(scene, spacing=0.5, level=2, threads=threads)
        directions = np.broadcast_to(UP, (2000, 3))
        return [shadowcache.load_set(VERTICES, TRIANGLES, threads=threads).bounds, baked.items(),
                shadowcache.render(scene, cache, white, camera, size=(48, 27), spp=4, threads=threads)["color"],
                cache.visibility(OPEN, UP, directions, threads=threads),
                cache.irradiance(np.broadcast_to(OPEN, (2000, 3)), UP, white, threads=threads),
                *cache.sampler(white).sample(OPEN, UP, count=9, threads=threads).values(),
                *cache.sampler(white).look_up(OPEN, UP, directions, threads=threads).values()]

    alone = all_of(0)
    found = {}
    calls = [threading.Thread(target=lambda n=n: found.setdefault(n, all_of(n))) for n in (1, 2, 3)]
    for call in calls:
        call.start()
    for call in calls:
        call.join()
    for n in (1, 2, 3):
        assert len(found[n]) == len(alone)
        assert all(np.array_equal(a, b) for a, b in zip(found[n], alone))
    with pytest.raises(shadowcache.Error, match="threads -1: expected 0"):
        all_of(-1)


def test_other_threads_run(scene, cache, white, camera):
    ticks, ended = [], threading.Event()

    def tick():
        while not ended.is_set():
            ticks.append(time.monotonic())
            time.sleep(0.005)

    thread = threading.Thread(target=tick)
    thread.start()
    begin = time.monotonic()
    shadowcache.render(scene, cache, white, camera, size=(128, 72), spp=64, threads=1)
    seconds = time.monotonic() - begin
    ended.set()
    thread.join()
    during = sum(begin <= t <= begin + seconds for t in ticks)
    assert seconds > 0.2 and during > 20 * seconds


def test_calls_of_several_threads_at_once(scene, cache, white, sunrise, camera):
    skies = [white, sunrise]
    alone = [shadowcache.render(scene, cache, sky, camera, size=(64, 36), spp=4)["color"] for sky in skies]
    found = {}

    def render(i):
        found[i] = shadowcache.render(scene, cache, skies[i % 2], camera, size=(64, 36), spp=4)["color"]

    threads = [threading.Thread(target=render, args=(i,)) for i in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(np.array_equal(found[i], alone[i % 2]) for i in range(6))


def test_bits_do_not_depend_on_threads(scene, cache, white, camera):
    pictures = []
    for threads in (1, 0):
        shadowcache.set_threads(threads)
        pictures.append(shadowcache.render(scene, cache, white, camera, size=(64, 36), spp=4)["color"])
    assert np.array_equal(*pictures)


def test_progress(scene, cache, camera, capfd):
    sky = shadowcache.Environment.constant(1)  # no other test has lit the set by it

    def steps():
        seen = []
        shadowcache.render(scene, cache, sky, camera, size=(96, 54), spp=16,
                           progress=lambda task, done, total: seen.append((task, done, total)))
        assert all(0 <= done <= total for _, done, total in seen)
        assert seen == sorted(seen, key=lambda step: (step[0] == "frame 1", step[1]))
        assert seen[-1][1] == seen[-1][2]
        return {task for task, _, _ in seen}

    assert steps() == {"predict light", "frame 1"}
    assert steps() == {"frame 1"}  # the lit set is kept
    assert capfd.readouterr() == ("", "")  # nothing is printed


def test_a_callback_that_raises_ends_the_call(scene, cache, white, camera):
    class Enough(Exception):
        pass

    calls = []

    def enough(*progress):
        calls.append(progress)
        raise Enough("enough")

    with pytest.raises(Enough, match="enough"):
        shadowcache.render(scene, cache, white, camera, size=(640, 360), spp=64, progress=enough)
    assert len(calls) == 1


def test_objects_that_die_in_a_callback(camera):
    kept = {"scene": shadowcache.load_set(VERTICES, TRIANGLES), "sky": shadowcache.Environment.constant(1)}
    kept["cache"] = shadowcache.bake(kept["scene"], spacing=0.5, level=2)

    def forget(*_):
        kept.clear()
        gc.collect()

    color = shadowcache.render(kept["scene"], kept["cache"], kept["sky"], camera, size=(96, 54), spp=16,
                               progress=forget)["color"]
    assert np.isfinite(color).all() and not kept


def resident():
    with open("/proc/self/statm", encoding="ascii") as statm:
        return int(statm.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def test_memory_stays_flat(scene, cache, white, camera):
    def once():
        shadowcache.render(scene, cache, white, camera, size=(160, 90), spp=1, aovs=["normal"])
        cache.irradiance(np.zeros((10000, 3)), UP, white)
        gc.collect()

    for _ in range(5):
        once()
    before = resident()
    for _ in range(20):
        once()
    grown = (resident() - before) / 1e6
    print(f"{grown:.1f} MB more after 20 renders")
    assert grown < 8


def test_pickles_are_files(small):
    """Scene, Cache and Environment in another process: by the file and how it was read; others refuse by name."""
    scene = shadowcache.load_set(small.file, scale=2, smooth=20)
    cache = shadowcache.Cache.open(small.cache, memory="4M")
    sky = shadowcache.Environment.load(MAP, rotate=30).rotate(12)
    code = ("import pickle, sys; scene, cache, sky = pickle.load(sys.stdin.buffer); "
            "print(scene.bounds.tolist(), scene.triangles, cache.header['fingerprint'], len(cache), sky.rotation, "
            "sky.integrate().tolist())")
    told = subprocess.run([sys.executable, "-c", code], input=pickle.dumps((scene, cache, sky)), capture_output=True, cwd="/")
    assert told.returncode == 0, told.stderr
    assert told.stdout.decode().strip() == " ".join(map(str, (
        scene.bounds.tolist(), scene.triangles, cache.header["fingerprint"], len(cache), 42.0, sky.integrate().tolist())))
    plain = pickle.loads(pickle.dumps(small.scene))
    assert not np.array_equal(plain.bounds, scene.bounds)  # the control: without the option


def test_pickles_that_are_refused(scene, cache, white, tmp_path):
    for thing, name in ((scene, "Scene"), (cache, "Cache"), (white, "Environment")):
        with pytest.raises(shadowcache.Error, match=f"^{name}: of no file"):
            pickle.dumps(thing)
    small = tmp_path / "set.obj"
    small.write_text("v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 3 2\n", encoding="utf-8")
    kept = pickle.dumps(shadowcache.load_set(small))
    small.write_text("v 0 0 0\nv 2 0 0\nv 0 0 1\nf 1 3 2\n", encoding="utf-8")
    with pytest.raises(shadowcache.Error, match="set.obj: has changed"):
        pickle.loads(kept)
    small.unlink()
    with pytest.raises(shadowcache.Error, match="set.obj"):
        pickle.loads(kept)


SUB_INTERPRETER = """
import _xxsubinterpreters as interpreters
def other(code):
    interpreter = interpreters.create()
    try:
        interpreters.run_string(interpreter, code)
    finally:
        interpreters.destroy(interpreter)
other("print('runs')")
try:
    other("import shadowcache")
except interpreters.RunFailedError as error:
    print(error)
import shadowcache
print(shadowcache.load_set([[0, 0, 0], [1, 0, 0], [0, 0, 1]], [[0, 2, 1]]))
"""


def test_other_interpreters():
    """A sub-interpreter is told to be a process, where it is the first to import as well; the main one goes on."""
    told = subprocess.run([sys.executable, "-c", SUB_INTERPRETER], capture_output=True, text=True, timeout=60)
    lines = told.stdout.splitlines()
    assert told.returncode == 0 and lines[0] == "runs", told.stderr
    assert "a sub-interpreter cannot import it" in lines[1]
    assert lines[2] == "<shadowcache.Scene: 1 triangles, 1 x 0 x 1 m>"
