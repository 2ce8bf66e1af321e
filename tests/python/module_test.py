"""The Python module: the bits of the programs, arrays as NumPy users expect them, threads, Ctrl-C, memory.

Needs SHADOWCACHE_BUILD, the folder of a build, and SHADOWCACHE_SOURCE, that of the sources.
"""
import ast
import gc
import json
import os
import pickle
import re
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

import shadowcache

BUILD = Path(os.environ["SHADOWCACHE_BUILD"])
SOURCE = Path(os.environ["SHADOWCACHE_SOURCE"])
MAP = SOURCE / "scenes/maps/sunrise.exr"

# A floor of 4 m, and a roof over its half x < 0.
VERTICES = np.array([[-2, 0, -2], [2, 0, -2], [2, 0, 2], [-2, 0, 2],
                     [-2, 1, -2], [0, 1, -2], [0, 1, 2], [-2, 1, 2]], dtype=np.float64)
TRIANGLES = np.array([[0, 2, 1], [0, 3, 2], [4, 6, 5], [4, 7, 6]])
OPEN, COVERED = (1.5, 0, 0), (-1.5, 0, 0)
UP = (0, 1, 0)


def run(program, *arguments):
    folder = {"shadowcache-make-set": "scenes", "shadowcache-bake": "bake"}.get(program, "render")
    command = [BUILD / folder / program, *map(str, arguments)]
    subprocess.run(command, check=True, capture_output=True)


@pytest.fixture(scope="module")
def scene():
    return shadowcache.load_set(VERTICES, TRIANGLES)


@pytest.fixture(scope="module")
def cache(scene):
    return shadowcache.bake(scene, spacing=0.25, level=3)


@pytest.fixture(scope="module")
def white():
    return shadowcache.Environment.constant(1)


@pytest.fixture(scope="module")
def camera():
    return shadowcache.Camera(eye=(3, 2, 4), look_at=(0, 0.3, 0), fov=40)


class Courtyard:
    """The bundled set with materials, baked by the program."""

    def __init__(self, folder):
        self.folder = folder
        self.file = folder / "courtyard.glb"
        self.camera = folder / "camera.json"
        self.cache = folder / "courtyard.vdb"
        run("shadowcache-make-set", "courtyard", "-o", self.file, "--camera", self.camera)
        run("shadowcache-bake", self.file, "-o", self.cache, "--spacing", 3, "--level", 2, "--rays", 4)
        self.scene = shadowcache.load_set(self.file)


@pytest.fixture(scope="module")
def courtyard(tmp_path_factory):
    return Courtyard(tmp_path_factory.mktemp("courtyard"))


# The bits of the programs.

def test_bake_has_the_bytes_of_the_program(courtyard, tmp_path):
    cache = shadowcache.bake(courtyard.scene, spacing=3, level=2, rays=4)
    size = cache.save(tmp_path / "mine.vdb")
    assert (tmp_path / "mine.vdb").read_bytes() == courtyard.cache.read_bytes()
    assert size == courtyard.cache.stat().st_size
    # Opened and saved again, too.
    shadowcache.Cache.open(courtyard.cache).save(tmp_path / "again.vdb")
    assert (tmp_path / "again.vdb").read_bytes() == courtyard.cache.read_bytes()


@pytest.mark.parametrize("options, arguments, cached", [
    ({"spp": 4}, ["--spp", 4], True),
    ({"spp": 4, "bounces": "unlimited", "seed": 7}, ["--spp", 4, "--bounces", "unlimited", "--seed", 7], True),
    ({"spp": 2, "bounces": 0}, ["--spp", 2, "--bounces", 0], False),
    ({"preview": True, "spp": 0}, ["--preview", "--spp", 0], True),
    ({"preview": True}, ["--preview"], True),
    ({"spp": 2, "transparent": True}, ["--spp", 2, "--transparent"], True),
    ({"camera_rays": 2, "samples": 3, "bounces": 1, "albedo": (.2, .3, .4)},
     ["--camera-rays", 2, "--samples", 3, "--bounces", 1, "--albedo", ".2,.3,.4"], True),
    ({"spp": 2, "estimator": "paper", "bounces": 0}, ["--spp", 2, "--estimator", "paper", "--bounces", 0], False),
])
def test_render_has_the_bits_of_the_program(courtyard, tmp_path, options, arguments, cached):
    aovs = ["irradiance", "normal", "depth"] + (["openness"] if cached else [])
    camera = shadowcache.Camera.load(courtyard.camera, frame=9)
    sky = shadowcache.Environment.load(MAP, rotate=100).rotate(20)
    mine = shadowcache.render(courtyard.scene, shadowcache.Cache.open(courtyard.cache) if cached else None,
                              sky, camera, size=(48, 27), frame=9, aovs=aovs, **options)
    run("shadowcache-render", courtyard.file, *(["--cache", courtyard.cache] if cached else []),
        "--env", MAP, "--env-rotate", 120, "--camera", courtyard.camera, "--frames", 9, "--size", "48x27",
        *(word for aov in aovs for word in ("--aov", aov)), *arguments, "-o", tmp_path / "theirs.exr")
    theirs = shadowcache.read_exr(tmp_path / "theirs.exr")
    assert set(mine) == {"color", *aovs} == set(theirs)
    for name, picture in mine.items():
        assert picture.dtype == np.float32
        channels = 4 if name == "color" and "transparent" in options else 3
        assert picture.shape == ((27, 48) if name in ("depth", "openness") else (27, 48, channels))
        assert np.array_equal(picture, theirs[name]), name
    assert mine["color"].max() > 0


def test_light_groups_are_layers_that_add_up(tmp_path, camera):
    (tmp_path / "night.mtl").write_text("newmtl wood\nKd .6 .5 .4\nnewmtl lamp\nKd 0 0 0\nKe 4 3 2\n")
    (tmp_path / "night.obj").write_text(
        "mtllib night.mtl\nusemtl wood\nv -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nf 1 4 3 2\n"
        "usemtl lamp\nv -1 .8 -1\nv -.6 .8 -1\nv -.6 .8 0\nv -1 .8 0\nf 5 6 7 8\n")
    scene = shadowcache.load_set(tmp_path / "night.obj")
    options = {"size": (24, 16), "spp": 4, "bounces": 1}
    mine = shadowcache.render(scene, None, shadowcache.Environment.constant(0.1), camera, light_groups=["*"], **options)
    groups = [name for name in mine if name.startswith("light:")]
    assert groups == ["light:sky", "light:lamp", "light:rest"]
    np.testing.assert_allclose(sum(mine[name] for name in groups), mine["color"], rtol=1e-5, atol=1e-6)
    assert mine["light:lamp"].max() > 0.01 and mine["light:sky"].max() > 0.01 and not mine["light:rest"].any()
    run("shadowcache-render", tmp_path / "night.obj", "--env", ".1,.1,.1", "--eye", "3,2,4", "--look-at", "0,.3,0",
        "--fov-y", 40, "--size", "24x16", "--spp", 4, "--bounces", 1, "--light-groups", "*", "-o", tmp_path / "a.exr")
    theirs = shadowcache.read_exr(tmp_path / "a.exr")
    assert set(mine) == set(theirs)
    np.testing.assert_array_equal(mine["light:lamp"], theirs["light:lamp"])
    with pytest.raises(shadowcache.Error, match="light_groups lump: no lamp.*lamp?"):
        shadowcache.render(scene, None, shadowcache.Environment.constant(1), camera, light_groups=["lump"], **options)


@pytest.mark.parametrize("options, lens", [
    ({"focus": 3}, {"radius": 0.2, "focus": 3}),
    ({"focus": 4, "blades": 6, "blade_rotation": 45}, {"radius": 0.2, "focus": 4, "blades": 6, "rotation": np.pi / 4}),
    ({}, {"radius": 0.2, "focus": 5})])
def test_lens_is_that_of_a_file(scene, white, tmp_path, options, lens):
    def render(camera):
        return shadowcache.render(scene, None, white, camera, size=(48, 27), camera_rays=8, samples=1)["color"]

    track = {"yfov": np.radians(40), "fps": 24, "lens": lens,
             "frames": [{"origin": [3, 0.5, 4], "forward": [-0.6, 0, -0.8], "up": [0, 1, 0]}]}
    (tmp_path / "camera.json").write_text(json.dumps({"cam": track}), encoding="utf-8")
    mine = shadowcache.Camera((3, 0.5, 4), (0, 0.5, 0), fov=40, lens_radius=0.2, **options)
    theirs = shadowcache.Camera.load(tmp_path / "camera.json")
    assert np.allclose(render(mine), render(theirs), atol=1e-3)
    # The control: a pinhole's picture is sharp.
    assert not np.allclose(render(shadowcache.Camera((3, 0.5, 4), (0, 0.5, 0), fov=40)), render(theirs), atol=0.05)


def test_a_baked_cache_renders_as_its_file(courtyard, tmp_path):
    sky = shadowcache.Environment.constant((1, 2, 3))
    camera = shadowcache.Camera.load(courtyard.camera, frame=2)
    pictures = [shadowcache.render(courtyard.scene, cache, sky, camera, size=(32, 18), spp=2)["color"]
                for cache in (shadowcache.bake(courtyard.scene, spacing=3, level=2, rays=4),
                              shadowcache.Cache.open(courtyard.cache))]
    assert np.array_equal(*pictures)


def test_the_next_camera_finds_the_light_predicted(courtyard):
    """The light of a scene and sky is predicted once; the pictures are those of a cache that knows nothing."""
    skies = [shadowcache.Environment.constant((1, 2, 3)), shadowcache.Environment.constant((3, 2, 1))]
    kept = shadowcache.Cache.open(courtyard.cache)

    def render(cache, frame, sky=skies[0], **options):
        tasks = []
        camera = shadowcache.Camera.load(courtyard.camera, frame=frame)
        color = shadowcache.render(courtyard.scene, cache, sky, camera, size=(16, 9), spp=2, **options,
                                   progress=lambda task, *_: tasks.append(task))["color"]
        return color, "predict light" in tasks

    for predicts, frame, options in (
            (True, 2, {}), (False, 9, {}), (False, 2, {"seed": 3}), (True, 9, {"sky": skies[1]}), (False, 2, {"sky": skies[1]}),
            (True, 2, {"bounces": 2}), (True, 2, {"albedo": 0.2}), (True, 2, {})):
        color, predicted = render(kept, frame, **options)
        alone, always = render(shadowcache.Cache.open(courtyard.cache), frame, **options)
        assert np.array_equal(color, alone) and always and predicted == predicts, (frame, options)


def test_arrays_are_the_set_of_a_file(scene, tmp_path):
    lines = [f"v {x} {y} {z}" for x, y, z in VERTICES] + [f"f {a} {b} {c}" for a, b, c in TRIANGLES + 1]
    (tmp_path / "set.obj").write_text("\n".join(lines) + "\n")
    of_file = shadowcache.load_set(tmp_path / "set.obj")
    headers = [shadowcache.bake(s, spacing=0.5, level=2).header for s in (scene, of_file)]
    assert headers[0] == headers[1]
    assert scene.triangles == of_file.triangles == 4
    assert np.array_equal(scene.bounds, [[-2, 0, -2], [2, 1, 2]])
    assert shadowcache.load_set([str(tmp_path / "set.obj")], up="z", scale=2).bounds[1, 1] == 4


def test_a_spacing_that_nobody_gave_is_not_refused():
    """Where numbers are large a finer one than this has no room: it is the one that is chosen."""
    far = shadowcache.load_set(VERTICES * 1e-3 + (1e9, 0, 0), TRIANGLES)
    assert 0.5 < shadowcache.bake(far).spacing < 1
    with pytest.raises(shadowcache.Error, match="^spacing 1e-05: too small for this set, expected at least 0.5"):
        shadowcache.bake(far, spacing=1e-5)
    assert shadowcache.bake(shadowcache.load_set(VERTICES * 1e-3, TRIANGLES)).spacing < 1e-4  # the control: near


# What the cache predicts.

def test_irradiance_of_a_white_sky(cache, white):
    open_, covered = cache.irradiance([OPEN, COVERED], UP, white)
    assert open_ == pytest.approx([np.pi] * 3, rel=0.1)
    assert 0 < covered[0] < 0.8 * open_[0]


def test_two_environments(cache):
    points = np.random.default_rng(1).uniform((-2, 0, -2), (2, 0, 2), (500, 3))
    sky = shadowcache.Environment.load(MAP)
    turned = cache.irradiance(points, UP, sky.rotate(90))
    assert np.array_equal(turned, cache.irradiance(points, UP, shadowcache.Environment.load(MAP, rotate=90)))
    assert not np.allclose(turned, cache.irradiance(points, UP, sky), rtol=0.05)
    two, five = (cache.irradiance(points, UP, shadowcache.Environment.constant(c)) for c in (2, 5))
    assert np.allclose(two * 2.5, five, rtol=1e-5)


def test_visibility(cache):
    assert cache.visibility(OPEN, UP, UP) == 1
    assert cache.visibility(COVERED, UP, UP) == 0
    to_the_open = cache.visibility((-0.2, 0, 0), UP, (1, 1, 0))
    assert isinstance(to_the_open, float) and to_the_open > 0.5


def test_visibility_in_the_air(scene, cache):
    """By rays, exactly; without the scene such places are refused, and what is no number is none."""
    points = np.random.default_rng(6).uniform((-1.9, 0.3, -1.9), (1.9, 0.8, 1.9), (300, 3))
    directions = np.random.default_rng(7).normal(size=(300, 3)) * (1, 0, 1) + UP
    found = cache.visibility(points, UP, directions, scene=scene)
    assert np.array_equal(found == 1, ~scene.occluded(points, directions)) and 0.1 < found.mean() < 0.9
    assert not np.array_equal(found == 1, ~scene.occluded(points, -directions))  # the control
    assert cache.visibility((0, 50, 0), UP, UP, scene=scene) == 1 and cache.visibility((-1, 0.5, 0), UP, UP, scene=scene) == 0
    on_the_floor = cache.visibility([OPEN, COVERED], UP, [(1, 1, 0)] * 2)
    both = cache.visibility([OPEN, (0, 50, 0), COVERED], UP, [(1, 1, 0)] * 3, scene=scene)
    assert np.array_equal(both[[0, 2]], on_the_floor)
    for call in (cache.visibility, lambda *places: cache.visibility([OPEN, (0, 50, 0)], UP, UP)):
        with pytest.raises(shadowcache.Error, match=r"points: \(0, 50, 0\) is at no surface .* scene="):
            call((0, 50, 0), UP, UP)
    assert np.isnan(cache.visibility((0, 50, 0), UP, (0, 0, 0), scene=scene)) and np.isnan(cache.visibility((np.nan, 0, 0), UP, UP))
    with pytest.raises(shadowcache.Error, match="scene: not the one"):
        cache.visibility(OPEN, UP, UP, scene=box_with_a_window(0.5))


def test_no_call_on_places_in_the_air_has_no_number(scene, cache, white):
    """An answer of finite numbers, with the scene where one is taken."""
    air = np.array([(0.5, 0.4, 0.3), (-1, 0.6, 0.2), (0, 30, 0)])
    sampler = cache.sampler(white)
    for found in (cache.visibility(air, UP, UP, scene=scene), cache.irradiance(air, UP, white, scene=scene, bounces=2),
                  cache.operator(air, UP, scene=scene, level=1, bounces=2), *sampler.sample(air, UP, count=4).values(),
                  *sampler.look_up(air, UP, UP).values(), *scene.intersect(air, (0, -1, 0)).values(), scene.occluded(air, UP)):
        assert np.isfinite(found).all()


def test_many_places_are_as_one_place_each(cache, white):
    rng = np.random.default_rng(2)
    points = rng.uniform((-2, 0, -2), (2, 0, 2), (20000, 3))
    directions = rng.normal(size=(20000, 3))
    some = rng.integers(0, 20000, 100)
    irradiance = cache.irradiance(points, UP, white)
    visibility = cache.visibility(points, UP, directions)
    for i in some:
        assert np.array_equal(cache.irradiance(points[i], UP, white), irradiance[i], equal_nan=True)
        assert np.array_equal(cache.visibility(points[i], UP, directions[i]), visibility[i], equal_nan=True)
    assert np.isfinite(irradiance).all()


def test_broadcasting(cache, white):
    points = np.array([OPEN, COVERED, OPEN])
    assert cache.irradiance(points, UP, white).shape == (3, 3)
    assert cache.irradiance(OPEN, UP, white).shape == (3,)
    assert cache.irradiance(np.empty((0, 3)), UP, white).shape == (0, 3)
    directions = np.array([(0, 1, 0), (1, 1, 0)])
    table = cache.visibility(points[:, None], UP, directions)
    assert table.shape == (3, 2) and table.dtype == np.float32
    assert np.array_equal(table[:, 0], [1, 0, 1])


@pytest.mark.parametrize("form", [
    lambda a: a.astype(np.float32), lambda a: a.astype(np.float16), np.asfortranarray, lambda a: a[::-1][::-1],
    lambda a: np.repeat(a, 2, axis=0)[::2], lambda a: a.astype(">f8"), lambda a: a.tolist(),
    lambda a: np.moveaxis(a.T.copy(), 0, 1)])
def test_any_form_of_an_array(cache, white, form):
    points = np.round(np.random.default_rng(3).uniform((-2, 0, -2), (2, 0, 2), (50, 3)) * 64) / 64
    expected = cache.irradiance(points, UP, white)
    assert np.array_equal(cache.irradiance(form(points), UP, white), expected, equal_nan=True)


def test_integers_and_normals_of_any_length(cache, white):
    assert np.array_equal(cache.irradiance(np.array([1, 0, 1]), (0, 7, 0), white),
                          cache.irradiance((1.0, 0, 1.0), UP, white))


def test_not_a_number_comes_back(cache, white):
    points = [OPEN, (np.nan, 0, 0), OPEN, OPEN, OPEN]
    normals = [UP, UP, (0, 0, 0), (0, np.inf, 0), (0, 1e200, 0)]
    good = [True, False, False, False, True]
    assert np.array_equal(np.isfinite(cache.irradiance(points, normals, white)).all(axis=1), good)
    assert np.array_equal(np.isfinite(cache.visibility(points, normals, UP)), good)
    assert np.isnan(cache.visibility(OPEN, UP, (0, 0, 0)))


def box_with_a_window(albedo):
    """A room of 2 m whose ceiling is open, all of one colour."""
    low, high = np.array([-1.0, 0, -1]), np.array([1.0, 2, 1])
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]) * (high - low) + low
    quads = [(0, 4, 5, 1), (0, 1, 3, 2), (4, 6, 7, 5), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])
    return shadowcache.load_set(corners, triangles, colors=np.full((8, 3), albedo))


def test_irradiance_with_bounces(white):
    room = box_with_a_window(0.6)
    baked = shadowcache.bake(room, spacing=0.2, level=3)
    below = [(0, 2, 0.1), (0, -1, 0)]
    at = room.intersect(*below)["position"]
    direct, one, all_of_it = (baked.irradiance(at, UP, white, bounces=b, scene=room)[0] for b in (0, 1, "unlimited"))
    assert direct == baked.irradiance(at, UP, white)[0] and direct < one < all_of_it
    camera = shadowcache.Camera((0.01, 1.99, 0.1), (0, 0, 0.1), fov=2)
    for bounces, found in ((1, one), ("unlimited", all_of_it)):
        truth = shadowcache.render(room, None, white, camera, size=(16, 16), camera_rays=32, samples=16, bounces=bounces,
                                   aovs=["irradiance"])["irradiance"].mean()
        assert found == pytest.approx(truth, rel=0.05)
        assert found != pytest.approx(1.15 * truth, rel=0.05)  # the control: 15 per cent off
    # Colours of the set, or one for all of it.
    assert baked.irradiance(at, UP, white, bounces=1, albedo=0.6)[0] == pytest.approx(one, rel=1e-4)
    assert baked.irradiance(at, UP, white, bounces=1, albedo=0)[0] == pytest.approx(direct, rel=0.01)


def test_bounces_that_cannot_be_predicted(scene, cache, white):
    with pytest.raises(shadowcache.Error, match="holds no transport"):
        shadowcache.bake(scene, spacing=1, level=1, transport=False).irradiance(OPEN, UP, white, bounces=1)
    with pytest.raises(shadowcache.Error, match="scene: not the one"):
        cache.irradiance(OPEN, UP, white, bounces=1, scene=box_with_a_window(0.5))
    for bad in (-1, 1001, "many"):
        with pytest.raises(ValueError, match="bounces: expected 0 to 1000"):
            cache.irradiance(OPEN, UP, white, bounces=bad)


def test_items_are_a_view(cache):
    items = cache.items()
    assert len(items) == len(cache) > 100
    assert items.dtype.names == ("voxel", "patch", "position", "normal", "exposure")
    assert not items.flags.owndata and not items.flags.writeable
    assert np.shares_memory(items, cache.items())
    world = (items["voxel"] + items["position"]) * cache.spacing
    assert world.min() >= -2.01 and world.max() <= 2.01
    assert np.allclose(np.linalg.norm(items["normal"], axis=1), 1, atol=1e-5)
    copy = items.copy()
    other = shadowcache.bake(shadowcache.load_set(VERTICES, TRIANGLES), spacing=0.25, level=3)
    kept = other.items()
    del other
    gc.collect()
    assert np.array_equal(kept, copy)


# Rays.

def test_rays_meet_the_roof(scene):
    origins = [(-1, 3, 0), (1, 3, 0), (-1, 0.5, 0), (1, 3, 0), (np.nan, 0, 0)]
    directions = [(0, -2, 0), (0, -2, 0), (0, 1, 0), (0, 1, 0), (0, 1, 0)]
    met = scene.intersect(origins, directions)
    assert met["distance"] == pytest.approx([2, 3, 0.5, np.inf, np.nan], nan_ok=True)
    assert met["triangle"].tolist()[3:] == [-1, -1] and (met["triangle"][:3] >= 0).all()
    assert np.allclose(met["position"][:3], [(-1, 1, 0), (1, 0, 0), (-1, 1, 0)])
    assert np.allclose(met["normal"][:3], [(0, 1, 0), (0, 1, 0), (0, -1, 0)])  # on the ray's side
    assert np.isnan(met["position"][3:]).all() and np.isnan(met["normal"][3:]).all()
    assert scene.occluded(origins, directions).tolist() == [True, True, True, False, False]
    assert scene.occluded((-1, 0.5, 0), (0, 2, 0)) is True
    assert scene.occluded((-1, 0.5, 0), (0, 2, 0), reach=0.4) is False
    assert scene.occluded((-1, 0.5, 0), (0, 2, 0), reach=0.6) is True
    with pytest.raises(ValueError, match="reach"):
        scene.occluded(origins, directions, reach=0)


def test_rays_start_off_the_surface_that_was_met(scene):
    rng = np.random.default_rng(4)
    down = scene.intersect(rng.uniform((-1.9, 2, -1.9), (1.9, 2, 1.9), (3000, 3)), (0, -1, 0))
    assert not scene.occluded(down["start"], UP).any()
    assert scene.occluded(down["position"] - (0, 1e-3, 0), UP).all()  # the control: below the surface
    directions = rng.normal(size=(3000, 3)) * (1, 0, 1) + UP
    seen = visible_past_the_roof(down["start"], directions) | (down["position"][:, 1] > 0.5)
    assert (scene.occluded(down["start"], directions) == ~seen).mean() > 0.999


# Environments.

def test_environment_of_an_array():
    texels = np.zeros((8, 16, 3), dtype=np.float32)
    texels[0] = 5  # around +Y
    sky = shadowcache.Environment.from_array(texels)
    radiance, density = sky.look_up([(0, 1, 0), (0, -1, 0)])
    assert np.array_equal(radiance, [[5, 5, 5], [0, 0, 0]]) and density[0] > 0 and density[1] == 0
    assert sky.integrate() == pytest.approx(np.full(3, 5 * 2 * np.pi * (1 - np.cos(np.pi / 8))), rel=1e-5)
    assert shadowcache.Environment.constant((1, 2, 3)).integrate() == pytest.approx(4 * np.pi * np.array([1, 2, 3]))


def test_environment_turns_counter_clockwise():
    texels = np.zeros((32, 64, 3))
    texels[16, 32] = 1  # +Z
    sky = shadowcache.Environment.from_array(texels).rotate(90)  # to +X, seen from above
    directions = sky.sample(16)[0]
    assert np.allclose(directions, [1, 0, 0], atol=0.2)


def test_samples_have_their_densities():
    sky = shadowcache.Environment.load(MAP)
    directions, radiances, densities = sky.sample(4096, seed=5)
    assert np.allclose(np.linalg.norm(directions, axis=1), 1, atol=1e-5)
    found, density = sky.look_up(directions)
    assert np.allclose(found, radiances) and np.allclose(density, densities, rtol=1e-4)
    weights = np.array([.2126, .7152, .0722])
    # The density is that of the luminance: each sample alone has the integral.
    assert np.allclose(radiances @ weights / densities, sky.integrate() @ weights, rtol=1e-3)
    assert not np.array_equal(directions, sky.sample(4096, seed=6)[0])

def visible_past_the_roof(points, directions):
    """Whether rays from the floor miss the roof, x in [-2, 0], z in [-2, 2], 1 m above."""
    with np.errstate(divide="ignore", invalid="ignore"):
        at = points + directions / directions[..., 1:2]
    hit = (np.abs(at[..., 0] + 1) < 1) & (np.abs(at[..., 2]) < 2)
    return (directions[..., 1] > 0) & ~hit


@pytest.mark.parametrize("control", [True, False])
def test_samples_make_the_irradiance(cache, control):
    sky = shadowcache.Environment.load(MAP)
    points = np.array([OPEN, (0.3, 0, 0.5), COVERED])
    found = cache.sampler(sky).sample(points, UP, count=4096, control=control)
    assert found["direction"].shape == found["radiance"].shape == found["control"].shape == (3, 4096, 3)
    assert found["pdf"].shape == (3, 4096) and found["integral"].shape == (3, 3)
    assert np.allclose(np.linalg.norm(found["direction"], axis=-1), 1, atol=1e-5)
    seen = visible_past_the_roof(points[:, None].astype(np.float32), found["direction"])
    light = found["radiance"] * np.where(seen, found["direction"][..., 1], 0)[..., None]
    weight = 1 / found["pdf"][..., None]
    irradiance = (light * weight).mean(axis=1)
    if control:
        irradiance = found["integral"] + ((light - found["control"]) * weight).mean(axis=1)
    # Brute force: directions by the light alone.
    by_light, radiance, pdf = sky.sample(1 << 18)
    for point, ours in zip(points, irradiance):
        above = visible_past_the_roof(point.astype(np.float32), by_light) * by_light[:, 1]
        truth = (radiance * (above / pdf)[:, None]).mean(axis=0)
        assert np.allclose(ours, truth, rtol=0.03)
        assert not np.allclose(ours, 1.1 * truth, rtol=0.03)  # the control: 10 per cent off


def test_samples_are_what_is_looked_up(cache, white):
    sampler = cache.sampler(white)
    drawn = sampler.sample(OPEN, UP, count=64)
    known = sampler.look_up(OPEN, UP, drawn["direction"])
    assert np.allclose(known["pdf"], drawn["pdf"], rtol=0.01)
    assert np.allclose(known["control"], drawn["control"], atol=0.01)
    assert sampler.look_up(OPEN, UP, (0, -1, 0))["pdf"] == 0
    assert np.isnan(sampler.look_up(OPEN, UP, (0, 0, 0))["pdf"])
    assert np.isnan(sampler.sample((np.nan, 0, 0), UP)["integral"]).all()


# What is refused.

@pytest.mark.parametrize("call, kind, text", [
    (lambda c, w: c.irradiance(np.zeros((4, 2)), UP, w), ValueError, r"points: shape \(4, 2\), expected \(..., 3\)"),
    (lambda c, w: c.irradiance(1.0, UP, w), ValueError, "points: shape"),
    (lambda c, w: c.irradiance(np.zeros((4, 3)), np.zeros((5, 3)), w), ValueError, "broadcast"),
    (lambda c, w: c.irradiance(np.zeros(3, dtype=complex), UP, w), TypeError, "points: dtype complex128"),
    (lambda c, w: c.irradiance(["a", "b", "c"], UP, w), TypeError, "points: dtype"),
    (lambda c, w: c.irradiance(None, UP, w), TypeError, "points: dtype object"),
    (lambda c, w: c.irradiance(np.ones(3, dtype=bool), UP, w), TypeError, "points: dtype bool"),
    (lambda c, w: c.irradiance(np.ma.masked_equal([OPEN, COVERED], 1.5), UP, w), ValueError, "points: some values are masked; fill"),
    (lambda c, w: shadowcache.Lamps.points(np.ma.masked_equal([OPEN, COVERED], 1.5), 1), ValueError, "positions: some values are masked"),
    (lambda c, w: c.irradiance(OPEN, UP, None), TypeError, "Environment"),
    (lambda c, w: w.look_up((0, 0, 0)), ValueError, "other than 0"),
    (lambda c, w: shadowcache.Environment.constant(-1), ValueError, "at least 0"),
    (lambda c, w: shadowcache.Environment.constant(np.nan), ValueError, "finite"),
    (lambda c, w: shadowcache.Environment.constant(0).sample(3), ValueError, "black"),
    (lambda c, w: shadowcache.Environment.from_array(np.full((2, 4, 3), np.inf)), ValueError, "texels: .*finite"),
    (lambda c, w: shadowcache.Environment.from_array(np.zeros((2, 4))), ValueError, "texels: shape"),
    (lambda c, w: shadowcache.Environment.from_array(np.zeros((0, 4, 3))), ValueError, "texels: shape"),
    (lambda c, w: w.rotate(np.inf), ValueError, "rotate"),
    (lambda c, w: shadowcache.load_set(VERTICES), TypeError, "triangles"),
    (lambda c, w: shadowcache.load_set(VERTICES, TRIANGLES * 1.0), TypeError, "triangles: .*integers"),
    (lambda c, w: shadowcache.load_set(VERTICES, TRIANGLES - 1), ValueError, r"triangles\[0\]: vertex -1"),
    (lambda c, w: shadowcache.load_set(VERTICES, TRIANGLES + 5), ValueError, r"expected 0 to 8 - 1"),
    (lambda c, w: shadowcache.load_set(VERTICES * np.nan, TRIANGLES), ValueError, r"vertices\[0\]"),
    (lambda c, w: shadowcache.load_set(VERTICES, TRIANGLES, colors=VERTICES), ValueError, "albedos"),
    (lambda c, w: shadowcache.load_set(VERTICES, TRIANGLES, normals=VERTICES[:3]), ValueError, "row for each vertex"),
    (lambda c, w: shadowcache.load_set(VERTICES, TRIANGLES * 0), shadowcache.Error, "no triangle left"),
    (lambda c, w: shadowcache.load_set("none.obj"), shadowcache.Error, "none.obj"),
    (lambda c, w: shadowcache.load_set([]), ValueError, "vertices: shape"),
    (lambda c, w: shadowcache.load_set(VERTICES, TRIANGLES, up="x"), shadowcache.Error, "up x: expected one of y, z"),
    (lambda c, w: shadowcache.load_set(VERTICES, TRIANGLES, scale=0), shadowcache.Error, "scale"),
    (lambda c, w: shadowcache.Cache.open("none.vdb"), shadowcache.Error, "none.vdb: no such file"),
    (lambda c, w: c.save("cache.obj"), shadowcache.Error, "cache.obj"),
    (lambda c, w: c.save("/no/such/folder/a.vdb"), shadowcache.Error, "/no/such/folder"),
    (lambda c, w: shadowcache.Environment.load("none.exr"), shadowcache.Error, "none.exr"),
    (lambda c, w: shadowcache.Camera((0, 0, 0), (0, 0, 0)), shadowcache.Error, ""),
    (lambda c, w: shadowcache.Camera((0, 0, 0), (0, 0, 1), fov=180), shadowcache.Error, "^fov 180: expected"),
    (lambda c, w: shadowcache.Camera((0, 0, 0), (0, 0, 1), lens_radius=-1), ValueError, "lens_radius"),
    (lambda c, w: shadowcache.Camera((0, 0, 0), (0, 0, 1), lens_radius=np.nan), ValueError, "lens_radius"),
    (lambda c, w: shadowcache.Camera((0, 0, 0), (0, 0, 1), lens_radius=1, focus=0), ValueError, "focus"),
    (lambda c, w: shadowcache.Camera((0, 0, 0), (0, 0, 1), lens_radius=1, blades=2), ValueError, "blades"),
    (lambda c, w: shadowcache.Camera((0, 0, 0), (0, 0, 1), lens_radius=1, blade_rotation=np.inf), ValueError, "rotation"),
    (lambda c, w: shadowcache.set_threads(-1), shadowcache.Error, "threads"),
])
def test_refusals(cache, white, call, kind, text):
    with pytest.raises(kind, match=text):
        call(cache, white)


@pytest.mark.parametrize("options, text", [
    ({"size": (0, 4)}, "^size"), ({"spp": 0}, "^spp 0"), ({"bounces": -1}, "^bounces -1"),
    ({"bounces": "many"}, "^bounces many"), ({"aovs": ["nothing"]}, "^aovs nothing"),
    ({"estimator": "nothing"}, "^estimator nothing"), ({"albedo": 2}, "^albedo"),
    ({"estimator": "mis", "preview": True}, "^preview"), ({"estimator": "mis", "aovs": ["openness"]}, "^aovs openness"),
    ({"clamp_indirect": -1}, "^clamp_indirect -1: expected 0"), ({"samples": 2}, "^spp cannot be combined with samples"),
    ({"filter": "gausian"}, "did you mean gaussian"), ({"crop": (0, 0, 9, 9)}, "^crop 0,0,9x9: expected a part of the frame"),
    ({"material": {"rough": 1}}, "^material rough=1: expected roughness=")])
def test_refusals_of_render(scene, cache, white, camera, options, text):
    with pytest.raises(shadowcache.Error, match=text):
        shadowcache.render(scene, cache, white, camera, **{"size": (8, 8), "spp": 1, **options})


def test_cache_of_another_set(cache, white, camera):
    other = shadowcache.load_set(VERTICES * 2, TRIANGLES)
    with pytest.raises(shadowcache.Error, match="baked for another set.* stale_ok=True"):
        shadowcache.render(other, cache, white, camera, size=(8, 8), spp=1)
    assert shadowcache.render(other, cache, white, camera, size=(8, 8), spp=1, stale_ok=True)["color"].max() > 0
    with pytest.raises(shadowcache.Error, match="holds no transport.*transport=False, or render with bounces 0"):
        plain = shadowcache.bake(other, spacing=1, level=1, transport=False)
        shadowcache.render(other, plain, white, camera, size=(8, 8), spp=0, preview=True)


CPP = re.compile(r"::|#define|PYBIND|pybind|\bstd\b|Object\b")


def test_no_names_of_cpp(scene, cache, white, camera):
    """Help and messages have the names of Python, whatever is given in whatever place."""
    sampler, thing, asked = cache.sampler(white), object(), 0
    owners = [shadowcache, scene, cache, white, camera, sampler, shadowcache.Cache, shadowcache.Environment, shadowcache.Camera,
              shadowcache.Lamps]
    for owner in owners:
        for name in dir(owner):
            call = getattr(owner, name)
            if name.startswith("_") or not callable(call) or name == "Error":
                continue
            assert not CPP.search(call.__doc__), (name, call.__doc__)
            for arguments in ((), (thing,), (3,), ([thing],), (["a.obj", thing],), (None, None), (thing,) * 2, (thing,) * 3,
                              (thing,) * 4, ("word",) * 2, (cache, white)):
                for keywords in ({}, {"threads": thing}, {"seed": -1}, {"bounces": 1.5}, {"scene": thing}, {"level": thing}):
                    try:
                        call(*arguments, **keywords)
                    except (TypeError, ValueError, AttributeError, shadowcache.Error) as error:
                        assert not CPP.search(str(error)), (name, arguments, keywords, str(error))
                        asked += 1
    assert asked > 500
    with pytest.raises(TypeError, match="set: expected the paths"):
        shadowcache.load_set(["a.obj", 3])


@pytest.mark.parametrize("name", ["zero", "null", "full"])
def test_devices_are_refused_by_name(tmp_path, name):
    for call, extensions in ((shadowcache.load_set, ("obj", "ply", "stl", "off", "om", "glb", "gltf")),
                             (shadowcache.Environment.load, ("exr", "hdr")), (shadowcache.Cache.open, ("vdb",)),
                             (shadowcache.Camera.load, ("json",)), (shadowcache.read_exr, ("exr",))):
        for path in ["/dev/" + name] + [tmp_path / f"{name}.{extension}" for extension in extensions]:
            if path != "/dev/" + name and not path.exists():
                path.symlink_to("/dev/" + name)
            with pytest.raises(shadowcache.Error, match=re.escape(str(path))):
                call(path)


def test_a_black_sky(scene, cache, camera):
    """Nothing of it is NaN, and it is black."""
    black = shadowcache.Environment.constant(0)
    radiance, density = black.look_up([(0, 1, 0), (1, -1, 0.3)])
    assert np.array_equal(radiance, np.zeros((2, 3))) and np.array_equal(density, np.zeros(2))
    assert np.array_equal(black.integrate(), np.zeros(3)) and not black.patches(1).any()
    assert not cache.irradiance([OPEN, COVERED], UP, black, bounces=2).any()
    found = cache.sampler(black).sample(OPEN, UP, count=4)
    assert not found["pdf"].any() and not found["integral"].any()
    along = cache.sampler(black).look_up(OPEN, UP, [UP, (1, 1, 0)])
    assert not along["pdf"].any() and not along["control"].any()
    for held in (cache, None):
        for options in ({"spp": 2, "bounces": 2}, {"preview": True} if held else {"spp": 1}):
            pictures = shadowcache.render(scene, held, black, camera, size=(16, 9), aovs=["variance", "irradiance"], **options)
            assert all(np.isfinite(picture).all() for picture in pictures.values()) and not pictures["color"].any()
    part = shadowcache.Environment.from_array(np.eye(3)[None, [0, 0, 0, 0]] * [[[1, 1, 1]], [[0, 0, 0]]])  # black below
    assert np.isfinite(part.look_up([(0, -1, 0), (0, 1, 0)])[1]).all()


# Threads, Ctrl-C, memory.

def long_render(scene, cache, white, camera, **options):
    return shadowcache.render(scene, cache, white, camera, size=(640, 360), spp=4096, **options)


def for_ever(call):
    while True:
        call()


def turn_for_ever(sky):
    while True:
        sky = sky.rotate(1)


@pytest.mark.parametrize("call", [
    long_render,
    lambda scene, cache, white, camera: shadowcache.bake(scene, spacing=0.004, rays=255),
    lambda scene, cache, white, camera: turn_for_ever(shadowcache.Environment.from_array(np.ones((2048, 4096, 3)))),
    lambda scene, cache, white, camera: for_ever(lambda: shadowcache.Environment.from_array(np.broadcast_to(1.0, (4096, 8192, 3)))),
    lambda scene, cache, white, camera: for_ever(lambda: white.sample(1 << 24)),
    lambda scene, cache, white, camera: for_ever(lambda: white.look_up(np.broadcast_to(UP, (1 << 24, 3)))),
    lambda scene, cache, white, camera: for_ever(lambda: cache.visibility(OPEN, UP, np.broadcast_to(UP, (1 << 26, 3)))),
    lambda scene, cache, white, camera: for_ever(lambda: scene.intersect(np.broadcast_to(OPEN, (1 << 24, 3)), UP)),
    lambda scene, cache, white, camera: for_ever(lambda: scene.occluded(np.broadcast_to(OPEN, (1 << 24, 3)), UP)),
    lambda scene, cache, white, camera: for_ever(lambda: cache.visibility((1, 0.5, 0), UP, np.broadcast_to(UP, (1 << 24, 3)), scene=scene)),
    lambda scene, cache, white, camera: for_ever(lambda: cache.irradiance(np.broadcast_to(OPEN, (1 << 22, 3)), UP, white)),
    lambda scene, cache, white, camera: for_ever(lambda: cache.irradiance(np.full((1 << 16, 3), 0.5), UP, white, scene=scene)),
    lambda scene, cache, white, camera: for_ever(lambda: cache.operator(np.full((1 << 14, 3), 0.5), UP, scene=scene, bounces=2)),
    lambda scene, cache, white, camera: for_ever(lambda: cache.sampler(white).sample(OPEN, UP, count=1 << 22)),
    lambda scene, cache, white, camera: for_ever(lambda: cache.sampler(white).look_up(OPEN, UP, np.broadcast_to(UP, (1 << 20, 3)))),
    lambda scene, cache, white, camera: for_ever(lambda: shadowcache.Environment.load(MAP).integrate()),
    lambda scene, cache, white, camera: for_ever(lambda: white.patches(5)),
    lambda scene, cache, white, camera: for_ever(lambda: scene.with_lamps(shadowcache.Lamps.points(OPEN, 1))),
], ids=["render", "bake", "map", "from_array", "sample", "look_up", "visibility", "intersect", "occluded", "visibility in the air",
        "irradiance", "irradiance in the air", "operator", "sampler", "sampler's look_up", "integrate", "patches", "with_lamps"])
def test_interrupt_within_a_second(scene, cache, white, camera, call):
    sent = []

    def interrupt():
        sent.append(time.monotonic())
        os.kill(os.getpid(), signal.SIGINT)

    timer = threading.Timer(0.7, interrupt)
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        call(scene, cache, white, camera)
    late = time.monotonic() - sent[0]
    print(f"ended {late:.2f} s after the signal")
    assert late < 1
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
    vertices, triangles = grid(1000)
    begin = time.monotonic()
    assert shadowcache.load_set(vertices, triangles).triangles == 2000000
    seconds, late = time.monotonic() - begin, []
    for share in (0.2, 0.4, 0.6, 0.8):  # the last ones are of the acceleration structure
        sent = []
        timer = threading.Timer(share * seconds, lambda at=sent: (at.append(time.monotonic()), os.kill(os.getpid(), signal.SIGINT)))
        timer.start()
        try:
            shadowcache.load_set(vertices, triangles)
            timer.cancel()
            timer.join()
        except KeyboardInterrupt:
            late.append(time.monotonic() - sent[0])
    print(f"of {seconds:.1f} s; ended so many seconds after the signal: {late}")
    assert len(late) >= 2 and max(late) < 1


def test_threads_of_a_call(scene, cache, white, camera):
    def all_of(threads):
        baked = shadowcache.bake(scene, spacing=0.5, level=2, threads=threads)
        directions = np.broadcast_to(UP, (2000, 3))
        return [shadowcache.load_set(VERTICES, TRIANGLES, threads=threads).bounds, baked.items(),
                shadowcache.render(scene, cache, white, camera, size=(96, 54), spp=4, threads=threads)["color"],
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


def test_pickles_are_files(courtyard):
    """Scene, Cache and Environment in another process: by the file and how it was read; others refuse by name."""
    scene = shadowcache.load_set(courtyard.file, scale=2, smooth=20)
    cache = shadowcache.Cache.open(courtyard.cache, memory="4M")
    sky = shadowcache.Environment.load(MAP, rotate=30).rotate(12)
    code = ("import pickle, sys; scene, cache, sky = pickle.load(sys.stdin.buffer); "
            "print(scene.bounds.tolist(), scene.triangles, cache.header['fingerprint'], len(cache), sky.rotation, "
            "sky.integrate().tolist())")
    told = subprocess.run([sys.executable, "-c", code], input=pickle.dumps((scene, cache, sky)), capture_output=True, cwd="/")
    assert told.returncode == 0, told.stderr
    assert told.stdout.decode().strip() == " ".join(map(str, (
        scene.bounds.tolist(), scene.triangles, cache.header["fingerprint"], len(cache), 42.0, sky.integrate().tolist())))
    plain = pickle.loads(pickle.dumps(courtyard.scene))
    assert not np.array_equal(plain.bounds, scene.bounds)  # the control: without the option


def test_pickles_that_are_refused(scene, cache, white, courtyard, tmp_path):
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


def test_orthographic_camera(scene, white, tmp_path):
    camera = shadowcache.Camera((0, 5, 0.001), (0, 0, 0), height=3)
    assert camera.height == 3 and camera.fov is None and "orthographic, 3 m high" in repr(camera)
    pictures = shadowcache.render(scene, None, white, camera, size=(30, 30), camera_rays=1, samples=1, filter="box",
                                  aovs=["depth", "position"])
    # All along the view: the floor 5 m below everywhere, and the roof 4 m below on the left.
    depth = pictures["depth"]
    assert np.allclose(depth[:, 16:], 5, atol=0.01) and np.allclose(depth[:, :14], 4, atol=0.01)
    x = pictures["position"][15, :, 0]
    assert np.diff(x) == pytest.approx(np.full(29, 0.1), abs=0.1) and x[-1] - x[0] == pytest.approx(2.9, abs=0.1)
    with pytest.raises(ValueError, match="fov cannot be combined with height"):
        shadowcache.Camera((0, 5, 0), (0, 0, 0), height=3, fov=40)
    for bad in (0, -1, np.nan, np.inf):
        with pytest.raises(ValueError, match="^height"):
            shadowcache.Camera((0, 5, 0), (0, 0, 1), height=bad)
    assert shadowcache.Camera((0, 5, 0), (0, 0, 1)).height is None


def test_handedness_of_a_map():
    """The formula of from_array's help, texel by texel; a mirrored map is another."""
    assert "a = pi - 2 pi x" in shadowcache.Environment.from_array.__doc__
    texels = np.random.default_rng(8).random((6, 12, 3))
    x, y = np.meshgrid((np.arange(12) + 0.5) / 12, (np.arange(6) + 0.5) / 6)
    a, b = np.pi - 2 * np.pi * x, np.pi / 2 - np.pi * y
    directions = np.stack([np.cos(b) * np.sin(a), np.sin(b), np.cos(b) * np.cos(a)], axis=-1)
    assert np.allclose(shadowcache.Environment.from_array(texels).look_up(directions)[0], texels, rtol=1e-5)
    assert not np.allclose(shadowcache.Environment.from_array(texels[:, ::-1]).look_up(directions)[0], texels, rtol=0.1)


def test_help_has_all_aovs(scene, white, camera):
    with pytest.raises(shadowcache.Error) as error:
        shadowcache.render(scene, None, white, camera, aovs=["nothing"])
    names = str(error.value).split("expected one of ")[1].split(", ")
    assert len(names) > 20 and set(names) <= set(re.findall(r"\w+", shadowcache.render.__doc__))


def test_what_a_camera_is():
    camera = shadowcache.Camera((1, 2, 3), (1, 2, 0), fov=40, lens_radius=0.02)
    assert camera.origin.tolist() == [1, 2, 3] and camera.forward.tolist() == [0, 0, -1] and camera.up.tolist() == [0, 1, 0]
    assert camera.fov == pytest.approx(40) and camera.lens_radius == 0.02


def test_other_threads_run(scene, cache, white, camera):
    ticks, ended = [], threading.Event()

    def tick():
        while not ended.is_set():
            ticks.append(time.monotonic())
            time.sleep(0.005)

    thread = threading.Thread(target=tick)
    thread.start()
    begin = time.monotonic()
    shadowcache.render(scene, cache, white, camera, size=(320, 180), spp=64)
    seconds = time.monotonic() - begin
    ended.set()
    thread.join()
    during = sum(begin <= t <= begin + seconds for t in ticks)
    assert seconds > 0.2 and during > 20 * seconds


def test_calls_of_several_threads_at_once(scene, cache, white, camera):
    skies = [white, shadowcache.Environment.load(MAP)]
    alone = [shadowcache.render(scene, cache, sky, camera, size=(96, 54), spp=4)["color"] for sky in skies]
    found = {}

    def render(i):
        found[i] = shadowcache.render(scene, cache, skies[i % 2], camera, size=(96, 54), spp=4)["color"]

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
        shadowcache.render(scene, cache, sky, camera, size=(320, 180), spp=64,
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

    color = shadowcache.render(kept["scene"], kept["cache"], kept["sky"], camera, size=(320, 180), spp=64,
                               progress=forget)["color"]
    assert np.isfinite(color).all() and not kept


def resident():
    with open("/proc/self/statm", encoding="ascii") as statm:
        return int(statm.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def test_memory_stays_flat(scene, cache, white, camera):
    def once():
        shadowcache.render(scene, cache, white, camera, size=(160, 90), spp=4, aovs=["normal"])
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


# Help.

def test_everything_has_help():
    for name, thing in vars(shadowcache).items():
        if name.startswith("_"):
            continue
        assert thing.__doc__, name
        for member, value in vars(thing).items() if isinstance(thing, type) else ():
            if not member.startswith("_"):
                assert value.__doc__, f"{name}.{member}"
    assert "load_set" in shadowcache.__doc__


def test_repr(scene, cache, white, camera):
    assert repr(scene) == "<shadowcache.Scene: 4 triangles, 4 x 1 x 4 m>"
    assert re.fullmatch(r"<shadowcache.Cache: \d+ items, spacing 0.25 m, in memory>", repr(cache))
    assert repr(white) == "<shadowcache.Environment: constant, 1 x 1, rotated by 0 degrees>"
    assert repr(camera).startswith("<shadowcache.Camera: at (3, 2, 4), along (-0.")
    assert cache.path is None and cache.nbytes > 0 and cache.header["level"] == 3


def test_stub_names_everything():
    stub = ast.parse((BUILD / "python/shadowcache.pyi").read_text(encoding="utf-8"))

    def names(body):
        return {node.name for node in body if isinstance(node, (ast.FunctionDef, ast.ClassDef))
                and not node.name.startswith("_")}

    def public(thing):
        return {name for name in vars(thing) if not name.startswith("_")}

    assert names(stub.body) == public(shadowcache)
    for node in stub.body:
        if isinstance(node, ast.ClassDef) and node.name != "Error":
            assert names(node.body) == public(getattr(shadowcache, node.name)), node.name


def table(program):
    """Options of a program as it prints them, by their names in Python."""
    rows = json.loads(subprocess.run([BUILD / program, "--options"], capture_output=True, check=True).stdout)
    return {row["python"]: row for row in rows if "python" in row}


def keywords_of(name):
    """Keyword arguments of a function of the stub."""
    stub = ast.parse((BUILD / "python/shadowcache.pyi").read_text(encoding="utf-8"))
    found = next(node for node in stub.body if isinstance(node, ast.FunctionDef) and node.name == name)
    return {argument.arg for argument in found.args.kwonlyargs} - {"frame", "progress", "threads"}


def test_options_are_those_of_the_table(scene, cache, white, camera):
    """The stub names options of the table, the help of the call tells them, and no other is taken."""
    for call, program in (("render", "render/shadowcache-render"), ("load_set", "render/shadowcache-render"),
                          ("bake", "bake/shadowcache-bake")):
        names = keywords_of(call) - {"colors", "normals", "cameras"}
        assert names <= set(table(program)), names
        for name in names:
            assert "\n%s: " % name in getattr(shadowcache, call).__doc__, name
    with pytest.raises(TypeError, match="unexpected keyword argument 'sampels', did you mean samples"):
        shadowcache.render(scene, cache, white, camera, sampels=1)


def test_ends_of_ranges(scene, cache, white, camera):
    """Each number of render() is taken at both ends of its range; what is beyond is refused under its name."""
    rows = table("render/shadowcache-render")
    walked = 0
    for name in sorted(keywords_of("render")):
        row = rows[name]
        if "range" not in row or row["range"][1] is None or name == "seed":
            continue
        least, most = row["range"]
        whole = row["form"] == "whole"
        for value in (least, most):
            # Refused, but for the threads: that is found out last.
            with pytest.raises(shadowcache.Error, match="^threads -1"):
                shadowcache.render(scene, cache, white, camera, threads=-1, **{name: int(value) if whole else value})
        for value in (least - 1, most + max(1, most * 0.01)):
            with pytest.raises(shadowcache.Error, match="^%s .*expected" % name):
                shadowcache.render(scene, cache, white, camera, **{name: int(value) if whole else value})
        with pytest.raises(TypeError, match="^%s: expected a (whole )?number" % name):
            shadowcache.render(scene, cache, white, camera, **{name: [1, 2]})
        walked += 1
    assert walked >= 7


def test_options_that_the_command_line_has(scene, cache, white, camera):
    """Filter, crop and target error do to the picture what they do there."""
    def render(**options):
        return shadowcache.render(scene, cache, white, camera, size=(16, 9), **options)["color"]

    whole = render(camera_rays=4, samples=1, filter="box")
    assert not np.array_equal(whole, render(camera_rays=4, samples=1, filter_width=3.0))
    part = render(camera_rays=4, samples=1, filter="box", crop=(4, 2, 6, 5))
    assert np.array_equal(part, whole[2:7, 4:10])
    coarse, fine = (render(target_error=error, samples=1, bounces=0) for error in (1e-1, 1e-4))
    assert coarse.shape == fine.shape and not np.array_equal(coarse, fine)
    assert np.array_equal(render(spp=2, material={"roughness": 1.0}), render(spp=2, material={"roughness": 1}))


def examples_of_page():
    page = (SOURCE / "docs/python.md").read_text(encoding="utf-8")
    examples = re.findall(r"^```python\n(.*?)^```$", page, re.DOTALL | re.MULTILINE)
    assert len(examples) >= 5
    return examples


def test_types(tmp_path):
    """mypy accepts the stub, and by it the examples of docs/python.md, one after the other; not a wrong use."""
    def mypy(name, text):
        (tmp_path / name).write_text(text, encoding="utf-8")
        checked = subprocess.run([sys.executable, "-m", "mypy", "--strict", "--ignore-missing-imports", name,
                                  BUILD / "python/shadowcache.pyi"], cwd=tmp_path, capture_output=True, text=True)
        return checked.returncode, checked.stdout + checked.stderr

    status, text = mypy("page.py", "\n".join(examples_of_page()))
    assert status == 0, text
    status, text = mypy("wrong.py", "import shadowcache\nshadowcache.Camera(eye=(0, 0, 1), look_at=(0, 0, 0), fov='wide')\n")
    assert status == 1 and "wrong.py:2" in text and "shadowcache.pyi" not in text, text


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


def test_page(courtyard, tmp_path, monkeypatch):
    """The examples of docs/python.md, one after the other in one folder."""
    for name, file in (("courtyard.glb", courtyard.file), ("camera.json", courtyard.camera), ("sky.exr", MAP)):
        (tmp_path / name).symlink_to(file)
    monkeypatch.chdir(tmp_path)
    names = {}
    for number, example in enumerate(examples_of_page()):
        exec(compile(example, f"docs/python.md, example {number + 1}", "exec"), names)
    assert names["by_angle"].shape == (24, 3) and np.isfinite(names["by_angle"]).all()
