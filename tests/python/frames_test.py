"""Scenes in a frame: the program's bits, with caches and light groups, rays that meet what moves, pickles, refusals by name."""
import json
import pickle
import struct
import warnings
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import shadowcache
from shadowcache import Lamps
from small_set import run

UP = (0, 1, 0)
SKY = shadowcache.Environment.constant((0.1, 0.2, 0.3))
CAMERA = shadowcache.Camera((0.4, 3, 2.5), (0, 0, 0))
LOOK = {"size": (24, 16), "camera_rays": 2, "samples": 4, "bounces": 1}


def write_glb(path, floats, tree):
    """`tree` with `floats`, arrays of vectors or numbers, as its accessors."""
    data, views, accessors = b"", [], []
    for values in floats:
        values = np.asarray(values, dtype="<f4")
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": values.nbytes})
        accessors.append({"bufferView": len(views) - 1, "componentType": 5126, "count": len(values),
                          "type": "SCALAR" if values.ndim == 1 else "VEC3"})
        data += values.tobytes()
    whole = {"asset": {"version": "2.0"}, "buffers": [{"byteLength": len(data)}], "bufferViews": views, "accessors": accessors, **tree}
    text = json.dumps(whole).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(data), 0x004E4942) + data
    path.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)


def square(side, height):
    a, b, c, d = ((x * side / 2, height, z * side / 2) for x, z in ((-1, -1), (-1, 1), (1, 1), (1, -1)))
    return [a, b, c, a, c, d]


def moving_to(node, sampler):
    return {"channels": [{"sampler": 0, "target": {"node": node, "path": "translation"}}], "samplers": [sampler]}


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    """A floor, a lamp that stands still, and a lamp and a board that move along +X in frames 0 to 24."""
    path = tmp_path_factory.mktemp("frames") / "set.glb"
    lamp = {"type": "point", "intensity": 2, "extras": {"radius": 0.1}}
    write_glb(path, [square(4, 0), square(0.8, 0.5), [0, 1], [(-1.5, 1, 0), (1.5, 1, 0)], [(-1, 0, 0.3), (1, 0, 0.3)]], {
        "scene": 0, "scenes": [{"nodes": [0, 1, 2, 3]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}, {"primitives": [{"attributes": {"POSITION": 1}}]}],
        "nodes": [{"mesh": 0}, {"name": "board", "mesh": 1},
                  *({"name": name, "translation": place, "extensions": {"KHR_lights_punctual": {"light": 0}}}
                    for name, place in (("moving", (0, 0, 0)), ("still", (0, 1.5, -1))))],
        "animations": [moving_to(2, {"input": 2, "output": 3}), moving_to(1, {"input": 2, "output": 4})],
        "extensionsUsed": ["KHR_lights_punctual"], "extensions": {"KHR_lights_punctual": {"lights": [lamp]}}})
    return path


def loaded(file, **options):
    with pytest.warns(UserWarning, match=r"^2 nodes move and are left out; Scene.at_frame\(N\)"):
        return shadowcache.load_set(file, **options)


@pytest.fixture(scope="module")
def scene(file):
    return loaded(file)


@pytest.fixture(scope="module")
def cache(file):
    run("bake", file, "-o", file.parent / "set.vdb", "--spacing", 0.4, "--level", 2, "--rays", 4)
    return shadowcache.Cache.open(file.parent / "set.vdb")


def picture(scene, cache, frame, **options):
    return shadowcache.render(scene, cache, SKY, CAMERA, frame=frame, **{**LOOK, **options})


@pytest.mark.parametrize("with_cache", [False, True])
def test_a_frame_has_the_programs_bits(file, scene, cache, tmp_path, with_cache):
    used, words = (cache, ["--cache", cache.path]) if with_cache else (None, [])
    run("render", file, *words, "--env", "0.1,0.2,0.3", "--eye", "0.4,3,2.5", "--look-at", "0,0,0", "--frames", "6,20", "--size", "24x16",
        "--camera-rays", 2, "--samples", 4, "--bounces", 1, "--light-groups", "*", "-o", tmp_path / "a.#.exr")
    for frame in (20, 6):
        mine = picture(scene.at_frame(frame), used, frame, light_groups=["*"])
        name, = tmp_path.glob(f"a.*{frame}.exr")
        theirs = shadowcache.read_exr(name)
        assert {"color", "light:moving", "light:still", "light:sky"} <= set(mine)
        for layer, values in mine.items():
            assert np.array_equal(values, theirs[layer]), layer
        assert mine["light:moving"].mean() > 0.01
        for other in (scene.at_frame(frame + 1), scene):  # the controls
            assert not np.array_equal(picture(other, used, frame)["color"], mine["color"])


def test_no_lamp_that_moves_changes_what_is_known_of_the_others(scene, cache):
    """Their light has the mean of many rays, with the cache as without; the control is 5 % brighter."""
    posed = scene.at_frame(6)
    options = {"camera_rays": 16, "samples": 16}
    with_cache, without = ([picture(posed, used, seed, **options)["color"].mean() for seed in range(1, 17)] for used in (cache, None))

    def differ(a, b):
        """Apart by more than six standard errors."""
        return abs(np.mean(a) - np.mean(b)) > 6 * np.sqrt((np.var(a) + np.var(b)) / (len(a) - 1))

    with warnings.catch_warnings():
        warnings.simplefilter("error")  # that the cache counts other lamps
        picture(posed, cache, 6)
    assert not differ(with_cache, without) and differ(np.multiply(with_cache, 1.05), without)


def test_rays_meet_what_moves(scene):
    early, late = scene.at_frame(0), scene.at_frame(24)
    places = np.array([(-1, 2, 0.3), (1, 2, 0.3)])
    for posed, on_board in ((early, [True, False]), (late, [False, True]), (scene, [False, False])):
        found = posed.intersect(places, (0, -1, 0))
        assert np.allclose(found["position"][:, 1], np.where(on_board, 0.5, 0)) and ((found["triangle"] < 0) == on_board).all()
        assert (found["start"][:, 1] > found["position"][:, 1]).all()
        assert np.array_equal(posed.occluded(places * (1, 0, 1) + (0, 0.1, 0), UP), on_board)
    assert (scene.lamps, early.lamps, scene.frame, early.frame) == (1, 2, None, 0)
    assert early.triangles == scene.triangles == 2 and np.array_equal(early.bounds, scene.bounds)


def test_frames_of_several_threads(scene, cache):
    """Each has its own things that move, whatever the others do with the same set."""
    def colors(frame):
        return picture(scene.at_frame(frame), cache, 1)["color"]

    frames = [3, 9, 15, 21]
    alone = [colors(frame) for frame in frames]
    with ThreadPoolExecutor(4) as pool:
        assert all(map(np.array_equal, pool.map(colors, frames), alone))
    assert not np.array_equal(alone[0], alone[1])  # the control


def test_frames_a_second(file, scene):
    slow = loaded(file, fps=12).at_frame(6)
    assert np.array_equal(picture(slow, None, 1)["color"], picture(scene.at_frame(12), None, 1)["color"])
    assert not np.array_equal(picture(slow, None, 1)["color"], picture(scene.at_frame(6), None, 1)["color"])  # the control


def test_gains_of_lamps_that_move(file, scene):
    bright, off = loaded(file, lamp=["moving=2"]), loaded(file, lamps="off")
    groups = [picture(s.at_frame(9), None, 9, light_groups=["*"], samples=64) for s in (scene, bright)]
    assert np.mean(groups[1]["light:moving"]) == pytest.approx(2 * np.mean(groups[0]["light:moving"]), rel=0.1)
    assert np.mean(groups[1]["light:still"]) == pytest.approx(np.mean(groups[0]["light:still"]), rel=0.1)
    assert off.at_frame(9).lamps == 0
    with pytest.raises(shadowcache.Error, match="^lamp movign: .*did you mean moving"):
        shadowcache.load_set(file, lamp=["movign=2"])


def test_a_set_that_stands_still_is_the_same_in_all_frames(file):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        whole = shadowcache.load_set(file, frame=12)
    floor = shadowcache.load_set(np.array(square(4, 0)), np.arange(6).reshape(2, 3))
    for scene in (whole, floor):
        assert scene.at_frame(3).frame is None and scene.at_frame(3).lamps == scene.lamps
    assert np.array_equal(picture(whole.at_frame(3), None, 1)["color"], picture(whole, None, 1)["color"])


def test_pickles(scene):
    lit = scene.with_lamps(Lamps.suns((0, -1, 0.2), (1, 2, 3), angle=3)).with_lamps(
        Lamps.spots((0, 2, 0), (0.1, -1, 0), 4, inner=10, outer=30, radius=0.05, camera=True)
        + Lamps.areas((0, 2, 1), (1, 0, 0), (0, 0, 0.5), 2, shape="ellipse", spread=90) + Lamps.points((1, 1, 1), 1)).at_frame(7)
    with pytest.warns(UserWarning, match="2 nodes move"):
        again = pickle.loads(pickle.dumps(lit))
    assert (again.frame, again.lamps) == (7, 6)
    assert np.array_equal(picture(again, None, 7)["color"], picture(lit, None, 7)["color"])
    assert not np.array_equal(picture(again, None, 7)["color"], picture(scene.at_frame(7), None, 7)["color"])  # the control


@pytest.mark.parametrize("call, text", [
    (lambda posed, cache: posed.at_frame(4), "^Scene.at_frame: the scene is in frame 6, expected the one"),
    (lambda posed, cache: posed.with_lamps(Lamps.points(UP, 1)), "^Scene.with_lamps: the scene is in frame 6"),
    (lambda posed, cache: shadowcache.bake(posed), "^bake: the scene is in frame 6"),
    (lambda posed, cache: cache.irradiance((0, 0, 0), UP, SKY, scene=posed), "^Cache: the scene is in frame 6"),
    (lambda posed, cache: cache.operator((0, 0, 0), UP, scene=posed), "^Cache: the scene is in frame 6"),
    (lambda posed, cache: cache.visibility((0, 0, 0), UP, UP, scene=posed), "^Cache: the scene is in frame 6"),
    (lambda posed, cache: picture(posed, cache, 6, preview=True), "^cache: does not count lamps that move"),
])
def test_refusals(scene, cache, call, text):
    with pytest.raises(shadowcache.Error, match=text):
        call(scene.at_frame(6), cache)
