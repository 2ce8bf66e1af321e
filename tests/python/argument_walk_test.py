"""Every array of every call of the module in every form that NumPy has: the values of plain doubles, or a named refusal.

A process that dies fails the test; so does a message without the argument's name.
"""
import functools
import gc
import resource

import numpy as np
import pytest

import shadowcache

UP = (0.0, 1.0, 0.0)
VERTICES = np.array([[-2, 0, -2], [2, 0, -2], [2, 0, 2], [-2, 0, 2],
                     [-2, 1, -2], [0, 1, -2], [0, 1, 2], [-2, 1, 2]], dtype=np.float64)
TRIANGLES = np.array([[0, 2, 1], [0, 3, 2], [4, 6, 5], [4, 7, 6]])
POINTS = np.array([[1.5, 0, 0], [-1.5, 0, 0], [1, 0, 1], [0, 0, -1]])
NORMALS = np.array([[0, 1, 0], [0, 2, 0], [0.25, 1, 0], [0, 1, 0.5]])
DIRECTIONS = np.array([[0, 1, 0], [1, 1, 0], [-1, 2, 0], [0, 0.5, 1]])

SCENE = shadowcache.load_set(VERTICES, TRIANGLES)
CACHE = shadowcache.bake(SCENE, spacing=0.5, level=2)
SKY = shadowcache.Environment.constant((1, 2, 3))
BLACK = shadowcache.Environment.constant(0)
SAMPLER = CACHE.sampler(SKY)
CAMERA = shadowcache.Camera(eye=(3, 2, 4), look_at=(0, 0.3, 0))


def numbers(result):
    """All numbers of what a call returns, one row of them for each array."""
    if isinstance(result, dict):
        return [np.asarray(part) for part in result.values()]
    return [np.asarray(part) for part in (result if isinstance(result, tuple) else (result,))]


def of_scene(scene):
    return np.append(scene.bounds, scene.triangles)


def lit(lamps):
    """A picture by lamps."""
    return shadowcache.render(SCENE.with_lamps(lamps), None, BLACK, CAMERA, size=(4, 4), spp=4, bounces=0)["color"]


# A call, the name of its argument, and plain values of it.
CALLS = {
    "visibility points": (lambda a: CACHE.visibility(a, NORMALS, DIRECTIONS), "points", POINTS),
    "visibility normals": (lambda a: CACHE.visibility(POINTS, a, DIRECTIONS), "normals", NORMALS),
    "visibility directions": (lambda a: CACHE.visibility(POINTS, NORMALS, a), "directions", DIRECTIONS),
    "irradiance points": (lambda a: CACHE.irradiance(a, NORMALS, SKY), "points", POINTS),
    "irradiance normals": (lambda a: CACHE.irradiance(POINTS, a, SKY), "normals", NORMALS),
    "operator points": (lambda a: CACHE.operator(a, NORMALS, level=1), "points", POINTS),
    "operator normals": (lambda a: CACHE.operator(POINTS, a, level=1), "normals", NORMALS),
    "sample points": (lambda a: SAMPLER.sample(a, NORMALS, count=2), "points", POINTS),
    "sample normals": (lambda a: SAMPLER.sample(POINTS, a, count=2), "normals", NORMALS),
    "look_up points": (lambda a: SAMPLER.look_up(a, NORMALS, DIRECTIONS), "points", POINTS),
    "look_up normals": (lambda a: SAMPLER.look_up(POINTS, a, DIRECTIONS), "normals", NORMALS),
    "look_up directions": (lambda a: SAMPLER.look_up(POINTS, NORMALS, a), "directions", DIRECTIONS),
    "sky look_up": (lambda a: SKY.look_up(a), "directions", DIRECTIONS),
    "from_array": (lambda a: shadowcache.Environment.from_array(a).integrate(), "texels",
                   np.arange(24.0).reshape(2, 4, 3)),
    "constant": (lambda a: shadowcache.Environment.constant(a).integrate(), "radiance", np.array([1.0, 2, 4])),
    "vertices": (lambda a: of_scene(shadowcache.load_set(a, TRIANGLES)), "vertices", VERTICES),
    "colors": (lambda a: of_scene(shadowcache.load_set(VERTICES, TRIANGLES, colors=a)), "colors", VERTICES * 0 + 0.5),
    "normals": (lambda a: of_scene(shadowcache.load_set(VERTICES, TRIANGLES, normals=a)), "normals", VERTICES * 0 + UP),
    "eye": (lambda a: shadowcache.Camera(a, (0, 0, 0)).origin, "eye", np.array([3.0, 2, 4])),
    "look_at": (lambda a: shadowcache.Camera((3, 2, 4), a).forward, "look_at", np.array([0.0, 0.25, 0])),
    "albedo": (lambda a: shadowcache.render(SCENE, None, SKY, CAMERA, size=(4, 4), spp=1, bounces=1, albedo=a)["color"],
               "albedo", np.array([0.25, 0.5, 0.75])),
    "lamp positions": (lambda a: lit(shadowcache.Lamps.points(a, 2)), "positions", POINTS + (0, 2.5, 0)),
    "lamp intensity": (lambda a: lit(shadowcache.Lamps.points((0, 3, 1), a)), "intensity", np.array([1.0, 2, 4])),
    "lamp along": (lambda a: lit(shadowcache.Lamps.suns(a, 1)), "directions", DIRECTIONS * (1, -1, 1)),
}


# Calls that take a tenth of a second each, whatever they are given. They share the forms out among them; the others,
# whose arguments are read by the same functions, take all.
DEAR = ("operator points", "operator normals", "from_array", "constant")


def dealt(forms, among=DEAR):
    """Pairs of a call and of a form of its argument: a call of `among` gets its share, any other all."""
    return [(name, form) for name in CALLS for i, form in enumerate(forms)
            if name not in among or i % len(among) == among.index(name)]


def misaligned(a):
    odd = np.zeros(a.nbytes + 1, dtype=np.uint8)[1:].view(a.dtype).reshape(a.shape)
    odd[...] = a
    return odd


def read_only(a):
    copy = a.copy()
    copy.flags.writeable = False
    return copy


def of_records(a):
    """A field of a structured array: strides that are no multiple of a number."""
    records = np.zeros(a.shape, dtype=[("tag", "i1"), ("value", "f8")])
    records["value"] = a
    return records["value"]


class Subclass(np.ndarray):
    pass


SAME = {
    "list": lambda a: a.tolist(), "tuple": lambda a: tuple(map(tuple, a)) if a.ndim == 2 else a.tolist(),
    "float32": lambda a: a.astype(np.float32), "float16": lambda a: a.astype(np.float16),
    "longdouble": lambda a: a.astype(np.longdouble), "other byte order": lambda a: a.astype(a.dtype.newbyteorder()),
    "float32 of the other order": lambda a: a.astype(">f4"), "columns first": np.asfortranarray,
    "backwards": lambda a: a[::-1].copy()[::-1], "each second": lambda a: np.repeat(a, 2, axis=0)[::2],
    "each second number": lambda a: np.repeat(a, 2, axis=-1)[..., ::2], "transposed": lambda a: a.T.copy().T,
    "misaligned": misaligned, "read-only": read_only, "field": of_records, "subclass": lambda a: a.view(Subclass),
    "masked without a mask": np.ma.masked_array, "memoryview": memoryview,
    "interface": lambda a: type("Holder", (), {"__array_interface__": a.__array_interface__, "kept": a})(),
}
REFUSED = {
    "complex": lambda a: a.astype(complex), "bool": lambda a: a > 0, "text": lambda a: a.astype(str),
    "bytes": lambda a: a.astype("S8"), "object": lambda a: a.astype(object), "dates": lambda a: a.astype("M8[s]"),
    "spans": lambda a: a.astype("m8[s]"), "records": lambda a: np.zeros(a.shape, dtype="f8,f8"),
    "nothing": lambda a: None, "word": lambda a: "word", "dict": lambda a: {}, "masked": lambda a: np.ma.masked_equal(a, a.flat[0]),
    "two columns": lambda a: a[..., :2], "four columns": lambda a: np.repeat(a, 2, axis=-1)[..., :4],
    "no columns": lambda a: a[..., :0],
}


@functools.cache
def expected_of(name):
    call, _, plain = CALLS[name]
    return numbers(call(plain))


def whole_of(name):
    """Plain values that integers without a sign can hold."""
    plain = CALLS[name][2]
    if name in ("irradiance points", "operator points", "visibility points"):
        return np.abs(np.round(plain))  # on the floor
    whole = np.round(plain - min(0, plain.min()))
    if name in ("eye", "look_at"):
        whole += (1, 0, 0)
    return np.minimum(whole, 1) if name.endswith("normals") or name in ("albedo", "colors") else whole


@functools.cache
def expected_of_whole(name):
    return numbers(CALLS[name][0](whole_of(name)))


# A file, and arguments that may be left out.
ALLOWED = {("vertices", "word"), ("colors", "nothing"), ("normals", "nothing"), ("albedo", "nothing")}


@pytest.mark.parametrize("name, form", dealt(SAME))
def test_forms_of_the_same_values(name, form):
    call, _, plain = CALLS[name]
    found, expected = numbers(call(SAME[form](plain))), expected_of(name)
    assert len(found) == len(expected)
    assert all(np.array_equal(a, b, equal_nan=True) for a, b in zip(found, expected))
    assert np.isfinite(np.concatenate([part.ravel() for part in expected])).any()


@pytest.mark.parametrize("name, dtype", dealt(["i1", "i2", "i4", "i8", "u1", "u2", "u4", "u8", ">i2", ">u4", "e", "f", "d", "g"]))
def test_real_types(name, dtype):
    call, _, _ = CALLS[name]
    whole = whole_of(name)
    found, expected = numbers(call(whole.astype(dtype))), expected_of_whole(name)
    assert all(np.array_equal(a, b, equal_nan=True) for a, b in zip(found, expected))


@pytest.mark.parametrize("form", REFUSED)
@pytest.mark.parametrize("name", CALLS)
def test_refused_forms(name, form):
    call, argument, plain = CALLS[name]
    if (name, form) in ALLOWED:
        pytest.skip("means something else")
    with pytest.raises((TypeError, ValueError), match=argument):
        call(REFUSED[form](plain))


@pytest.mark.parametrize("name, value", dealt([np.nan, np.inf, -np.inf, 1e308, -1e308, 5e-324, -0.0], DEAR[:2]))
def test_extreme_values(name, value):
    """One number of an argument is extreme: a result or a named refusal, and the other places keep theirs."""
    call, argument, plain = CALLS[name]
    odd = plain.copy()
    odd.flat[0] = value
    try:
        found = numbers(call(odd))
    except (ValueError, shadowcache.Error) as error:
        assert str(error).strip()
        return
    if name.split()[-1] in ("points", "normals", "directions") and plain.shape == POINTS.shape and " " in name:
        for a, b in zip(found, expected_of(name)):
            assert np.array_equal(a[1:], b[1:], equal_nan=True)


@pytest.mark.parametrize("name", CALLS)
def test_empty_and_deep(name):
    call, argument, plain = CALLS[name]
    shapes = ((0, 3), (2, 0, 3), (0, 0, 3), (1,) * 30 + (3,), (0,), ())
    for shape in shapes[DEAR.index(name)::2] if name in DEAR[:2] else shapes:
        try:
            found = numbers(call(np.ones(shape)))
        except (TypeError, ValueError, shadowcache.Error) as error:
            assert argument in str(error) or "broadcast" in str(error), (shape, error)
            continue
        assert all(part.size == 0 for part in found) or 0 not in shape or name.startswith("lamp ")  # no lamp


# Sizes.

def repeated(*shape):
    return np.broadcast_to(np.array(UP), (*shape, 3))


def peak():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3  # MB


@pytest.mark.parametrize("call", [
    lambda: CACHE.visibility(repeated(1 << 20, 1), UP, repeated(1 << 20)),
    lambda: CACHE.irradiance(repeated(1 << 40), UP, SKY),
    lambda: CACHE.irradiance(repeated(1 << 60), UP, SKY),
    lambda: CACHE.visibility(repeated(1 << 60), UP, UP),
    lambda: SAMPLER.sample(repeated(1 << 30), UP, count=1 << 20),
    lambda: SAMPLER.sample(UP, UP, count=(1 << 32) - 1),
    lambda: SAMPLER.look_up(repeated(1 << 20, 1), UP, repeated(1 << 20)),
    lambda: SKY.look_up(repeated(1 << 40)),
    lambda: shadowcache.Environment.from_array(repeated(1, 1 << 32)),
    lambda: shadowcache.Environment.from_array(repeated(1 << 32, 1)),
    lambda: shadowcache.Environment.from_array(repeated(1 << 31, 1 << 29)),
    lambda: shadowcache.load_set(repeated(1 << 40), TRIANGLES),
    lambda: shadowcache.load_set(VERTICES, np.broadcast_to(TRIANGLES[0], (1 << 40, 3))),
])
def test_too_large(call):
    before = peak()
    limit = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (8 << 30, limit[1]))  # what a machine of 8 GB can give
    try:
        with pytest.raises((MemoryError, ValueError)):
            call()
    finally:
        resource.setrlimit(resource.RLIMIT_AS, limit)
    gc.collect()
    assert peak() - before < 500


def test_no_broadcast_is_materialised():
    """Three million pairs take 4 bytes each and a part's buffers, where three arrays of vectors would take 216 MB."""
    small = CACHE.visibility(POINTS[:, None], UP, DIRECTIONS)
    before = peak()
    found = CACHE.visibility(np.broadcast_to(POINTS[0], (1500, 1, 3)), UP, np.broadcast_to(DIRECTIONS[1], (2000, 3)))
    assert found.shape == (1500, 2000) and (found == small[0, 1]).all()
    assert peak() - before < 150


def test_parts_have_the_values_of_the_whole():
    """More vectors than one part has: the same values as of each alone, and sequences of their own."""
    count = (1 << 20) + 9
    points = np.full((count, 3), np.nan)
    points[:9] = points[-9:] = POINTS[2]
    drawn = SAMPLER.sample(points, UP, count=1)["direction"]
    assert np.array_equal(drawn[:9], SAMPLER.sample(points[:9], UP, count=1)["direction"])
    assert len(np.unique(np.concatenate([drawn[:9], drawn[-9:]]).reshape(-1, 3), axis=0)) == 18
    found = CACHE.visibility(points, UP, DIRECTIONS[1])
    assert np.isfinite(found).sum() == 18 and np.nanmin(found) == np.nanmax(found)
