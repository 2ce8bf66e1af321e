"""What the module refuses, in words of Python that name what was given."""
import re

import numpy as np
import pytest

import shadowcache
from small_set import COVERED, OPEN, TRIANGLES, UP, VERTICES


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
