"""Lamps of arrays beside a set, and what shines in it: closed forms, what the renderer finds, refusals by name."""
import numpy as np
import pytest

import shadowcache
from shadowcache import Lamps

UP = np.array((0.0, 1, 0))
BLACK = shadowcache.Environment.constant(0)
# A floor of 8 m, and a board of 1 m, 1 m above its middle.
VERTICES = np.array([[-4, 0, -4], [4, 0, -4], [4, 0, 4], [-4, 0, 4],
                     [-.5, 1, -.5], [.5, 1, -.5], [.5, 1, .5], [-.5, 1, .5]], dtype=float)
TRIANGLES = np.array([[0, 2, 1], [0, 3, 2], [4, 6, 5], [4, 7, 6]])
PLACES = np.array([(1.6, 0, 0.3), (-2.2, 0, 1.1), (0.2, 0, -2.5), (2.5, 0, 2.5)])
IN_THE_AIR = PLACES[::2] + 0.7 * UP  # fewer: what each sees is found by rays
ALL_PLACES = np.concatenate([PLACES, IN_THE_AIR])
ON_THE_FLOOR, ABOVE_IT = slice(len(PLACES)), slice(len(PLACES), None)


@pytest.fixture(scope="module")
def floor():
    return shadowcache.load_set(VERTICES, TRIANGLES, colors=np.full((8, 3), 0.5))


def lit_and_baked(scene, lamps, **options):
    lit = scene.with_lamps(lamps)
    return lit, shadowcache.bake(lit, **{"spacing": 0.4, "level": 2, "rays": 4, **options})


def at(places, lamp):
    """Distances to a lamp, and cosines of the angles under which it is seen from places that look up."""
    way = np.asarray(lamp) - places
    distance = np.linalg.norm(way, axis=-1)
    return distance, way[..., 1] / distance


def rectangle(places, centre, width, height, side=64, spread=180):
    """Irradiance by a rectangle of radiance 1 that shines down, by a lattice of its points; slats leave `spread` degrees."""
    u = (np.arange(side) + 0.5) / side - 0.5
    points = np.asarray(centre) + u[:, None, None] * np.asarray(width) + u[:, None] * np.asarray(height)
    way = points.reshape(-1, 3) - places[:, None]
    distance = np.linalg.norm(way, axis=-1)
    area = np.linalg.norm(np.cross(width, height))
    cosine = way[..., 1] / distance
    tangent = np.sqrt(1 - cosine ** 2) / cosine
    left = np.maximum(0, 1 - tangent / np.tan(np.radians(spread / 2)))
    return (left * cosine ** 2 / distance ** 2).mean(axis=1) * area


COLOR = np.array((3.0, 2, 1))


def test_closed_forms(floor):
    places = ALL_PLACES
    distance, cosine = at(places, (0.5, 3, 2))
    sun = np.array((0.5, -1.0, 0.2))
    wide, deep = np.array((1.0, 0, 0)), np.array((0, 0, 0.5))
    axis = np.array((0, -1.0, 0))
    to_place = places - (0.5, 3, 2)
    off = np.degrees(np.arccos(to_place @ axis / np.linalg.norm(to_place, axis=-1)))
    spot = np.where(off < 20, 1, np.where(off > 60, 0, np.nan))
    for lamps, truth in (
            (Lamps.points((0.5, 3, 2), COLOR), cosine / distance ** 2),
            (Lamps.points((0.5, 3, 2), COLOR, radius=0.05), cosine / distance ** 2),
            (Lamps.suns(sun, COLOR), np.full(len(places), 1 / np.linalg.norm(sun))),
            (Lamps.suns(sun, COLOR, angle=1), np.full(len(places), 1 / np.linalg.norm(sun))),
            (Lamps.spots((0.5, 3, 2), axis, COLOR, inner=20, outer=60), spot * cosine / distance ** 2),
            (Lamps.areas((0.5, 3, 2), wide, deep, COLOR), rectangle(places, (0.5, 3, 2), wide, deep)),
            (Lamps.areas((0.5, 3, 2), wide, deep, COLOR, spread=[120]),
             rectangle(places, (0.5, 3, 2), wide, deep, spread=120)),
            (Lamps.areas((0.5, 3, 2), 0.2 * wide, 0.4 * deep, COLOR, shape="ellipse"),
             np.pi / 4 * rectangle(places, (0.5, 3, 2), 0.2 * wide, 0.4 * deep)),
            (Lamps.areas((0.5, 3, 2), deep, wide, COLOR), np.zeros(len(places)))):  # it shines up
        lit, cache = lit_and_baked(floor, lamps)
        assert lit.lamps == 1 and floor.lamps == 0
        found = cache.irradiance(places, UP, BLACK, scene=lit)
        for part in (ON_THE_FLOOR, ABOVE_IT):
            known = np.isfinite(truth[part])
            wanted = truth[part][known, None] * COLOR
            assert np.allclose(found[part][known], wanted, rtol=0.03, atol=1e-6), (found, wanted)
            # The control: 8 per cent more.
            assert not wanted.any() or not np.allclose(1.08 * found[part][known], wanted, rtol=0.03, atol=1e-6)


def test_a_sky_and_lamps_add_up(floor):
    lamps = Lamps.points([(0.5, 3, 2), (-1, 2, 0)], 2)
    lit, cache = lit_and_baked(floor, lamps)
    sky = shadowcache.Environment.constant((1, 2, 3))
    places = ALL_PLACES
    for bounces in (0, 3):
        both = cache.irradiance(places, UP, sky, scene=lit, bounces=bounces)
        own = cache.irradiance(places, UP, BLACK, scene=lit, bounces=bounces)
        alone = cache.irradiance(places, UP, sky, scene=lit.with_lamps(Lamps.points(np.empty((0, 3)), 1)), bounces=bounces)
        assert np.allclose(alone, both, rtol=1e-5)  # the control: no lamp more
        operator = cache.operator(places, UP, level=2, scene=lit, bounces=bounces)
        product = (operator * sky.patches(2)).sum(axis=-2)
        for part in (ON_THE_FLOOR, ABOVE_IT):
            assert np.allclose((product + own)[part], both[part], rtol=0.03)
            assert not np.allclose(product[part], both[part], rtol=0.03)  # the control: without the set's own light


@pytest.fixture(scope="module")
def room():
    """A room of 2 m whose ceiling is open, all of one colour, what lights it, and its cache."""
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (0, 2) for z in (-1, 1)], dtype=float)
    quads = [(0, 4, 5, 1), (0, 1, 3, 2), (4, 6, 7, 5), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])
    lamps = Lamps.points((0.4, 1.2, 0.3), (2, 1, 0.5)) + Lamps.areas((-0.3, 1.5, 0), (0.4, 0, 0), (0, 0, 0.4), 3)
    lit = shadowcache.load_set(corners, triangles, colors=np.full((8, 3), 0.6)).with_lamps(lamps)
    return lit, shadowcache.bake(lit, spacing=0.1, level=3)


def rendered(scene, place, bounces):
    """Irradiance at a place by the renderer, without a cache."""
    camera = shadowcache.Camera(place + 0.05 * UP + (1e-4, 0, 0), place, fov=2)
    return shadowcache.render(scene, None, BLACK, camera, size=(8, 8), camera_rays=32, samples=16, bounces=bounces,
                              aovs=["irradiance"])["irradiance"].mean(axis=(0, 1))


@pytest.mark.parametrize("bounces", [0, 1, "unlimited"])
def test_lamps_in_a_room_beside_the_renderer(room, bounces):
    lit, cache = room
    place = np.array((0.3, 0, -0.2))
    found = cache.irradiance(place, UP, BLACK, scene=lit, bounces=bounces)
    truth = rendered(lit, place, bounces)
    assert np.allclose(found, truth, rtol=0.05), (found, truth)
    assert not np.allclose(1.15 * found, truth, rtol=0.05)  # the control


def test_emissive_surfaces_beside_the_renderer(tmp_path):
    """A panel of a file that shines: on the floor and in the air, with bounces, as many as are asked for."""
    panel = """v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv -.5 1.5 -.5\nv .5 1.5 -.5\nv .5 1.5 .5\nv -.5 1.5 .5
usemtl floor\nf 1 4 3 2\nusemtl panel\nf 5 6 7 8\n"""
    (tmp_path / "set.obj").write_text("mtllib set.mtl\n" + panel, encoding="utf-8")
    (tmp_path / "set.mtl").write_text("newmtl floor\nKd .7 .7 .7\nnewmtl panel\nKd .5 .5 .5\nKe 4 2 1\n", encoding="utf-8")
    scene = shadowcache.load_set(tmp_path / "set.obj")
    cache = shadowcache.bake(scene, spacing=0.1, level=3)
    place = np.array((0.3, 0, -0.2))
    for bounces in (0, 2):
        truth = rendered(scene, place, bounces)
        found = cache.irradiance(place, UP, BLACK, scene=scene, bounces=bounces)
        assert np.allclose(found, truth, rtol=0.05) and not np.allclose(1.15 * found, truth, rtol=0.05), (found, truth)
        # By the rays of a place in the air a hair above the reach of the cache's surface: nearly the same.
        air = cache.irradiance(place + 0.011 * UP, UP, BLACK, scene=scene, bounces=bounces)
        assert np.allclose(air, truth, rtol=0.05), (air, truth)
    assert np.array_equal(cache.irradiance(place, UP, BLACK), np.zeros(3))  # without the scene nothing shines
    dimmed = shadowcache.load_set(tmp_path / "set.obj", lamp=["*=1", "panel=0.5"])
    assert np.allclose(2 * cache.irradiance(place, UP, BLACK, scene=dimmed), cache.irradiance(place, UP, BLACK, scene=scene))
    with pytest.raises(shadowcache.Error, match="^lamp nobody"):
        shadowcache.load_set(tmp_path / "set.obj", lamp=["nobody=1"])


def test_one_cache_for_any_strength(floor):
    lit, cache = lit_and_baked(floor, Lamps.points([(0.5, 3, 2), (-1, 2, 0)], [(1, 1, 1), (2, 2, 2)]))
    other = floor.with_lamps(Lamps.points([(0.5, 3, 2), (-1, 2, 0)], [(3, 3, 3), (6, 6, 6)]))
    found = cache.irradiance(PLACES, UP, BLACK, scene=lit)
    assert np.allclose(3 * found, cache.irradiance(PLACES, UP, BLACK, scene=other), rtol=1e-5)
    moved = floor.with_lamps(Lamps.points([(0.6, 3, 2), (-1, 2, 0)], 1))
    unknown = shadowcache.bake(floor, spacing=0.4, level=2, rays=4)
    without = shadowcache.bake(lit, spacing=0.4, level=2, rays=4, lamps=False)
    for baked, scene, what in ((cache, moved, "does not count 'points' where it is: it was moved, reshaped or added since"),
                               (unknown, lit, "counts no emitters: it was baked with lamps=False, before the set had any"),
                               (without, lit, "counts no emitters: it was baked with lamps=False")):
        with pytest.raises(shadowcache.Error, match=f"^cache: {what}.*: bake the scene as it is"):
            baked.irradiance(PLACES, UP, BLACK, scene=scene)
        camera = shadowcache.Camera((0, 2.5, 3), (0, 0, 0))
        with pytest.warns(UserWarning, match=f"^lamps: the cache {what}"):
            shadowcache.render(scene, baked, BLACK, camera, size=(4, 4), spp=1)


def test_lamps_light_pictures(floor):
    camera = shadowcache.Camera((0.3, 2.9, 2), (0.3, 0, 2.1), fov=2)
    lit = floor.with_lamps(Lamps.points((0.5, 3, 2), 6))
    picture = shadowcache.render(lit, None, BLACK, camera, size=(8, 8), spp=16, bounces=0)["color"]
    assert picture.mean() == pytest.approx(6 / 9 * 0.5 / np.pi, rel=0.03)
    assert not shadowcache.render(floor, None, BLACK, camera, size=(8, 8), spp=16, bounces=0)["color"].any()


def test_cameras_see_lamps_that_say_so(floor):
    up = shadowcache.Camera((0.3, 1.5, 2), (0.3, 3, 2.001), fov=2)

    def seen(lamps):
        return shadowcache.render(floor.with_lamps(lamps), None, BLACK, up, size=(4, 4), spp=1, bounces=0)["color"]

    for camera in (True, False):
        for lamps, radiance in (
                (Lamps.areas((0.3, 3, 2), (1, 0, 0), (0, 0, 1), COLOR, camera=camera), COLOR),
                (Lamps.areas((0.3, 3, 2), (0, 0, 1), (1, 0, 0), COLOR, camera=camera), 0 * COLOR),  # it shines up
                (Lamps.points((0.3, 3, 2), COLOR, radius=0.5, camera=camera), COLOR / (np.pi * 0.25)),
                (Lamps.spots((0.3, 3, 2), (0, -1, 0), COLOR, inner=20, radius=0.5, camera=camera), COLOR / (np.pi * 0.25)),
                (Lamps.suns((0, -1, 0), COLOR, angle=20, camera=camera), COLOR / (np.pi * np.sin(np.radians(10)) ** 2))):
            assert np.allclose(seen(lamps), radiance if camera else 0, rtol=1e-4), (camera, radiance)


def test_light_groups_by_name(floor):
    """Each name is a group: its light is the picture of its lamps alone, and gains go by name."""
    camera = shadowcache.Camera((0, 2.5, 3), (0, 0, 0))
    desk = Lamps.points([(0.5, 3, 2), (-1, 2, 0)], 2, name="desk")
    panel = Lamps.areas((0, 2.5, 0), (1, 0, 0), (0, 0, 0.5), COLOR)
    nameless = Lamps.spots((1, 3, 0), (0, -1, 0), 3, name="")

    def rendered_with(lamps, **options):
        return shadowcache.render(floor.with_lamps(lamps), None, BLACK, camera, size=(16, 9), spp=16, bounces=0, **options)

    pictures = rendered_with(desk + panel + nameless, light_groups=["*"])
    groups = {name[6:]: light for name, light in pictures.items() if name.startswith("light:")}
    assert list(groups) == ["sky", "desk", "areas", "rest"]
    assert np.allclose(sum(groups.values()), pictures["color"], atol=1e-5)
    for name, lamps in (("desk", desk), ("areas", panel), ("rest", nameless)):
        alone = rendered_with(lamps)["color"].mean(axis=(0, 1))
        assert np.allclose(groups[name].mean(axis=(0, 1)), alone, rtol=0.1), (name, alone)
        assert not np.allclose(1.5 * groups[name].mean(axis=(0, 1)), alone, rtol=0.1)  # the control
    both = rendered_with(desk + panel, light_groups=["on=desk", "on=are*"])
    assert not both["light:rest"].any() and np.allclose(both["light:on"], both["color"], atol=1e-5)
    with pytest.raises(shadowcache.Error, match="^light_groups dusk: .*desk"):
        rendered_with(desk, light_groups=["dusk"])
    with pytest.raises(TypeError):
        Lamps.points((0, 1, 0), 1, name=1)


def test_lamps_are_broadcast(floor):
    lamps = Lamps.points(np.zeros((2, 3, 3)) + (0, 2, 0), 1, radius=[0.1, 0.2, 0.3])
    assert len(lamps) == 6 and repr(lamps) == "<shadowcache.Lamps: 6>"
    both = lamps + Lamps.suns([(0, -1, 0), (0, -1, 1)], (1, 2, 3), angle=[0, 1])
    assert len(both) == 8 and floor.with_lamps(both).with_lamps(lamps).lamps == 14


@pytest.mark.parametrize("call, text", [
    (lambda: Lamps.points((0, np.nan, 0), 1), r"positions\[0\]: expected finite"),
    (lambda: Lamps.points([(0, 1, 0), (0, 1e13, 0)], 1), r"positions\[1\]"),
    (lambda: Lamps.points((0, 1, 0), -1), r"intensity\[0\]: expected 0 to 1e15"),
    (lambda: Lamps.points((0, 1, 0), np.inf), r"intensity\[0\]"),
    (lambda: Lamps.points((0, 1, 0), (1, 2)), r"intensity: shape \(2,\)"),
    (lambda: Lamps.points((0, 1, 0), 1, radius=-1), r"radius\[0\]: expected metres"),
    (lambda: Lamps.spots((0, 1, 0), (0, 0, 0), 1), r"directions\[0\]: expected a finite vector"),
    (lambda: Lamps.spots((0, 1, 0), (0, -1, 0), 1, inner=50), r"inner\[0\]: .*those of outer"),
    (lambda: Lamps.spots((0, 1, 0), (0, -1, 0), 1, outer=91), r"outer\[0\]: expected degrees, 0 to 90"),
    (lambda: Lamps.suns((0, -1, 0), 1, angle=181), r"angle\[0\]"),
    (lambda: Lamps.areas((0, 1, 0), (1, 0, 0), (2, 0, 0), 1), r"heights\[0\]: expected another direction"),
    (lambda: Lamps.areas((0, 1, 0), (1, 0, 0), (0, 0, 1), 1, shape="disk"), "shape: 'disk', expected 'rectangle' or 'ellipse'"),
    (lambda: Lamps.areas((0, 1, 0), (1, 0, 0), (0, 0, 1), 1, spread=[90, 0.5]), r"spread\[1\]: expected degrees, 0.573 to 180"),
    (lambda: Lamps.areas((0, 1, 0), (1, 0, 0), (0, 0, 1), 1, spread=np.nan), r"spread\[0\]"),
    (lambda: Lamps.points([(0, 1, 0)] * 2, [(1, 1, 1)] * 3), "broadcast"),
])
def test_refusals(call, text):
    with pytest.raises(ValueError, match=text):
        call()


def test_pickles(tmp_path):
    """Lamps are pickled as they are, and so are those of a scene of a file; a scene of arrays is refused."""
    import pickle
    (tmp_path / "set.obj").write_text("v -2 0 -2\nv 2 0 -2\nv 2 0 2\nv -2 0 2\nf 1 4 3 2\n", encoding="utf-8")
    scene = shadowcache.load_set(tmp_path / "set.obj")
    kinds = (Lamps.points((0.5, 1, 0), 1, radius=0.1), Lamps.suns((0, -1, 0.1), COLOR, angle=2, camera=True),
             Lamps.spots((0, 1, 0), (0.1, -1, 0), COLOR, inner=10, outer=30),
             Lamps.areas((0, 1, 0.2), (1, 0, 0), (0, 0, 0.5), 2, shape="ellipse", spread=90),
             Lamps.areas((0, 1, 0.2), (1, 0, 0), (0, 0, 0.5), 2, camera=True))
    camera = shadowcache.Camera((0, 1.5, 1.5), (0, 0, 0))

    def seen(lit):
        return shadowcache.render(lit, None, BLACK, camera, size=(8, 8), spp=4, bounces=0)["color"]

    for lamps, other in zip(kinds, kinds[1:] + kinds[:1]):
        wanted = seen(scene.with_lamps(lamps))
        for again in (scene.with_lamps(pickle.loads(pickle.dumps(lamps))), pickle.loads(pickle.dumps(scene.with_lamps(lamps)))):
            assert np.array_equal(seen(again), wanted) and wanted.any()
        assert not np.array_equal(seen(scene.with_lamps(other)), wanted)  # the control
    assert len(pickle.loads(pickle.dumps(sum(kinds[1:], kinds[0])))) == 5
    with pytest.raises(shadowcache.Error, match=r"^Lamps: pickled as an array of shape \(2, 3\), expected \(n, 23\)"):
        Lamps.__new__(Lamps).__setstate__((np.zeros((2, 3)), ["", ""]))
    with pytest.raises(shadowcache.Error, match="^Lamps: pickled with 1 names, expected 2"):
        Lamps.__new__(Lamps).__setstate__((np.zeros((2, 23)), ["a"]))
    named = Lamps.points([(0, 1, 0), (1, 1, 0)], 1, name="désk") + kinds[1]
    assert pickle.loads(pickle.dumps(named)).names == named.names == ["désk", "désk", "suns"]
    with pytest.raises(shadowcache.Error, match="^Scene: of no file"):
        pickle.dumps(shadowcache.load_set(VERTICES, TRIANGLES).with_lamps(kinds[0]))
