"""The module makes what the programs make: the bytes of a bake, the bits of a picture; and what a camera is."""
import functools
import json

import numpy as np
import pytest

import shadowcache
from small_set import MAP, TRIANGLES, VERTICES, run


@functools.lru_cache(maxsize=None)
def turned():
    """The map turned by 120 degrees, in two steps."""
    return shadowcache.Environment.load(MAP, rotate=100).rotate(20)


def expect_bytes_of_the_program(baked, folder):
    """A bake by the module, and a cache that is opened and saved again, are the file of the program."""
    size = shadowcache.bake(baked.scene, **baked.options).save(folder / "mine.vdb")
    assert (folder / "mine.vdb").read_bytes() == baked.cache.read_bytes()
    assert size == baked.cache.stat().st_size
    shadowcache.Cache.open(baked.cache).save(folder / "again.vdb")
    assert (folder / "again.vdb").read_bytes() == baked.cache.read_bytes()


def expect_bits_of_the_program(baked, folder, options, arguments, cached):
    """Every layer of a picture is that of the program."""
    aovs = ["irradiance", "normal", "depth"] + (["openness"] if cached else [])
    camera = shadowcache.Camera.load(baked.camera, frame=9)
    mine = shadowcache.render(baked.scene, shadowcache.Cache.open(baked.cache) if cached else None,
                              turned(), camera, size=(32, 18), frame=9, aovs=aovs, **options)
    run("render", baked.file, *(["--cache", baked.cache] if cached else []),
        "--env", MAP, "--env-rotate", 120, "--camera", baked.camera, "--frames", 9, "--size", "32x18",
        *(word for aov in aovs for word in ("--aov", aov)), *arguments, "-o", folder / "theirs.exr")
    theirs = shadowcache.read_exr(folder / "theirs.exr")
    assert set(mine) == {"color", *aovs} == set(theirs)
    for name, picture in mine.items():
        assert picture.dtype == np.float32
        channels = 4 if name == "color" and "transparent" in options else 3
        assert picture.shape == ((18, 32) if name in ("depth", "openness") else (18, 32, channels))
        assert np.array_equal(picture, theirs[name]), name
    assert mine["color"].max() > 0


def test_bake_has_the_bytes_of_the_program(small, tmp_path):
    expect_bytes_of_the_program(small, tmp_path)


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
def test_render_has_the_bits_of_the_program(small, tmp_path, options, arguments, cached):
    expect_bits_of_the_program(small, tmp_path, options, arguments, cached)


def test_light_groups_are_layers_that_add_up(tmp_path, camera):
    (tmp_path / "night.mtl").write_text("newmtl wood\nKd .6 .5 .4\nnewmtl lamp\nKd 0 0 0\nKe 4 3 2\n")
    (tmp_path / "night.obj").write_text(
        "mtllib night.mtl\nusemtl wood\nv -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nf 1 4 3 2\n"
        "usemtl lamp\nv -1 .8 -1\nv -.6 .8 -1\nv -.6 .8 0\nv -1 .8 0\nf 5 6 7 8\n")
    scene = shadowcache.load_set(tmp_path / "night.obj")
    options = {"size": (24, 16), "spp": 4, "bounces": 1}
    sky = shadowcache.Environment.constant(0.1)
    mine = shadowcache.render(scene, None, sky, camera, light_groups=["*"], **options)
    groups = [name for name in mine if name.startswith("light:")]
    assert groups == ["light:sky", "light:lamp", "light:rest"]
    np.testing.assert_allclose(sum(mine[name] for name in groups), mine["color"], rtol=1e-5, atol=1e-6)
    assert mine["light:lamp"].max() > 0.01 and mine["light:sky"].max() > 0.01 and not mine["light:rest"].any()
    run("render", tmp_path / "night.obj", "--env", ".1,.1,.1", "--eye", "3,2,4", "--look-at", "0,.3,0",
        "--fov-y", 40, "--size", "24x16", "--spp", 4, "--bounces", 1, "--light-groups", "*", "-o", tmp_path / "a.exr")
    theirs = shadowcache.read_exr(tmp_path / "a.exr")
    assert set(mine) == set(theirs)
    np.testing.assert_array_equal(mine["light:lamp"], theirs["light:lamp"])
    with pytest.raises(shadowcache.Error, match="light_groups lump: no lamp.*lamp?"):
        shadowcache.render(scene, None, sky, camera, light_groups=["lump"], **options)


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


def test_a_baked_cache_renders_as_its_file(small):
    sky = shadowcache.Environment.constant((1, 2, 3))
    camera = shadowcache.Camera.load(small.camera, frame=2)
    pictures = [shadowcache.render(small.scene, cache, sky, camera, size=(32, 18), spp=2)["color"]
                for cache in (shadowcache.bake(small.scene, **small.options), shadowcache.Cache.open(small.cache))]
    assert np.array_equal(*pictures)


def test_options_that_the_command_line_has(scene, cache, white, camera):
    """Filter, crop and target error do to the picture what they do there."""
    def render(**options):
        return shadowcache.render(scene, cache, white, camera, size=(16, 9), **options)["color"]

    whole = render(camera_rays=4, samples=1, filter="box")
    assert not np.array_equal(whole, render(camera_rays=4, samples=1, filter_width=3.0))
    part = render(camera_rays=4, samples=1, filter="box", crop=(4, 2, 6, 5))
    assert np.array_equal(part, whole[2:7, 4:10])
    coarse, fine = (render(target_error=error, samples=1, bounces=0) for error in (1e-1, 1e-3))
    assert coarse.shape == fine.shape and not np.array_equal(coarse, fine)
    assert np.array_equal(render(spp=2, material={"roughness": 1.0}), render(spp=2, material={"roughness": 1}))


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
    def at(x):
        return shadowcache.load_set(VERTICES * 1e-3 + (x, 0, 0), TRIANGLES)

    far = at(1e9)
    assert 0.5 < shadowcache.bake(far).spacing < 1
    with pytest.raises(shadowcache.Error, match="^spacing 1e-05: too small for this set, expected at least 0.5"):
        shadowcache.bake(far, spacing=1e-5)
    assert shadowcache.bake(at(1e6)).spacing < 1e-3  # the control: nearer


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


def test_what_a_camera_is():
    camera = shadowcache.Camera((1, 2, 3), (1, 2, 0), fov=40, lens_radius=0.02)
    assert camera.origin.tolist() == [1, 2, 3] and camera.forward.tolist() == [0, 0, -1] and camera.up.tolist() == [0, 1, 0]
    assert camera.fov == pytest.approx(40) and camera.lens_radius == 0.02
