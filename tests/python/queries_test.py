"""What the module tells of places, rays and environments, as arrays that NumPy users expect."""
import gc

import numpy as np
import pytest

import shadowcache
from small_set import COVERED, MAP, OPEN, TRIANGLES, UP, VERTICES


# What the cache predicts.

def test_irradiance_of_a_white_sky(cache, white):
    open_, covered = cache.irradiance([OPEN, COVERED], UP, white)
    assert open_ == pytest.approx([np.pi] * 3, rel=0.1)
    assert 0 < covered[0] < 0.8 * open_[0]


def test_two_environments(cache, white, sunrise):
    points = np.random.default_rng(1).uniform((-2, 0, -2), (2, 0, 2), (500, 3))
    turned = cache.irradiance(points, UP, sunrise.rotate(90))
    assert np.array_equal(turned, cache.irradiance(points, UP, shadowcache.Environment.load(MAP, rotate=90)))
    assert not np.allclose(turned, cache.irradiance(points, UP, sunrise), rtol=0.05)
    one, five = (cache.irradiance(points, UP, sky) for sky in (white, shadowcache.Environment.constant(5)))
    assert np.allclose(one * 5, five, rtol=1e-5)


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
        truth = shadowcache.render(room, None, white, camera, size=(8, 8), camera_rays=32, samples=16, bounces=bounces,
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


def test_samples_have_their_densities(sunrise):
    sky = sunrise
    directions, radiances, densities = sky.sample(4096, seed=5)
    assert np.allclose(np.linalg.norm(directions, axis=1), 1, atol=1e-5)
    found, density = sky.look_up(directions)
    assert np.allclose(found, radiances) and np.allclose(density, densities, rtol=1e-4)
    weights = np.array([.2126, .7152, .0722])
    # The density is that of the luminance: each sample alone has the integral.
    assert np.allclose(radiances @ weights / densities, sky.integrate() @ weights, rtol=1e-3)
    assert not np.array_equal(directions, sky.sample(4096, seed=6)[0])


def test_handedness_of_a_map():
    """The formula of from_array's help, texel by texel; a mirrored map is another."""
    assert "a = pi - 2 pi x" in shadowcache.Environment.from_array.__doc__
    texels = np.random.default_rng(8).random((6, 12, 3))
    x, y = np.meshgrid((np.arange(12) + 0.5) / 12, (np.arange(6) + 0.5) / 6)
    a, b = np.pi - 2 * np.pi * x, np.pi / 2 - np.pi * y
    directions = np.stack([np.cos(b) * np.sin(a), np.sin(b), np.cos(b) * np.cos(a)], axis=-1)
    assert np.allclose(shadowcache.Environment.from_array(texels).look_up(directions)[0], texels, rtol=1e-5)
    assert not np.allclose(shadowcache.Environment.from_array(texels[:, ::-1]).look_up(directions)[0], texels, rtol=0.1)


def visible_past_the_roof(points, directions):
    """Whether rays from the floor miss the roof, x in [-2, 0], z in [-2, 2], 1 m above."""
    with np.errstate(divide="ignore", invalid="ignore"):
        at = points + directions / directions[..., 1:2]
    hit = (np.abs(at[..., 0] + 1) < 1) & (np.abs(at[..., 2]) < 2)
    return (directions[..., 1] > 0) & ~hit


@pytest.mark.parametrize("control", [True, False])
def test_samples_make_the_irradiance(cache, sunrise, control):
    points = np.array([OPEN, (0.3, 0, 0.5), COVERED])
    found = cache.sampler(sunrise).sample(points, UP, count=4096, control=control)
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
    by_light, radiance, pdf = sunrise.sample(1 << 17)
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
