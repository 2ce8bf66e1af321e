"""Places in the air, and the operator of places by patches of the sky: against rays, and against each other."""
import functools
import time

import numpy as np
import pytest

import shadowcache

UP = np.array((0.0, 1, 0))
SENSORS = np.array([(0.3, 0.75, 0.2), (-0.6, 0.75, 0.5), (0.0, 1.5, -0.4), (0.7, 0.4, -0.7)])
COLOR = (0.7, 0.6, 0.3)


def room():
    """A room of 2 m, open above, with a board in the air over half of it, all of one colour."""
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (0, 2) for z in (-1, 1)] +
                       [(-1, 1.6, -1), (0, 1.6, -1), (0, 1.6, 1), (-1, 1.6, 1)], dtype=float)
    quads = [(0, 4, 5, 1), (0, 1, 3, 2), (4, 6, 7, 5), (0, 2, 6, 4), (1, 5, 7, 3), (8, 9, 10, 11)]
    triangles = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])
    return shadowcache.load_set(corners, triangles, colors=np.broadcast_to(COLOR, corners.shape))


@pytest.fixture(scope="module")
def scene():
    return room()


@pytest.fixture(scope="module")
def cache(scene):
    return shadowcache.bake(scene, spacing=0.2, level=3, rays=4)


@pytest.fixture(scope="module")
def smooth():
    """A sky of 64 by 32 texels without a sun."""
    theta = (np.arange(32) + 0.5) * np.pi / 32
    phi = np.arange(64) * 2 * np.pi / 64
    bright = 1 + 0.8 * np.sin(theta)[:, None] * np.cos(phi) + 0.5 * np.cos(theta)[:, None]
    return shadowcache.Environment.from_array(bright[..., None] * (0.6, 0.8, 1.2))


@pytest.fixture(scope="module")
def truth(scene, smooth):
    """Irradiance of the sensors by paths of cosine rays, without a cache: one row for each number of bounces, 0 to 4."""
    rng, strata = np.random.default_rng(5), 72
    rays = strata ** 2
    start, normal = np.repeat(SENSORS, rays, axis=0), np.broadcast_to(UP, (len(SENSORS) * rays, 3))
    found, weight, alive = np.zeros_like(start), np.ones_like(start), np.arange(len(start))
    # The first rays are spread evenly: less noise of as few.
    u, v = ((np.indices((strata, strata)).reshape(2, 1, rays) + rng.random((2, len(SENSORS), rays))) / strata).reshape(2, -1)
    way = np.stack([np.sqrt(u) * np.cos(2 * np.pi * v), np.sqrt(1 - u), np.sqrt(u) * np.sin(2 * np.pi * v)], axis=-1)
    rows = []
    for _ in range(5):
        met = scene.intersect(start, way)
        free = np.isinf(met["distance"])
        found[alive[free]] = weight[free] * smooth.look_up(way[free])[0] * np.pi
        alive, weight = alive[~free], weight[~free] * met["albedo"][~free]
        start, normal = met["start"][~free], met["normal"][~free].astype(float)
        way = rng.normal(size=start.shape)
        way = normal + way / np.linalg.norm(way, axis=1, keepdims=True)
        rows.append(found.reshape(len(SENSORS), rays, 3).mean(axis=1))
    return rows


@pytest.fixture(scope="module")
def operators(scene, cache):
    """Of the sensors, and of the places below them, by the number of bounces; and these places."""
    places = np.concatenate([SENSORS, scene.intersect(SENSORS, -UP)["position"]])
    return places, functools.lru_cache(maxsize=None)(lambda bounces: cache.operator(places, UP, scene=scene, bounces=bounces))


def test_albedo_of_what_rays_meet(scene):
    met = scene.intersect([(0, 3, 0.5), (0, 3, 0)], [(0, -1, 0), (0, 1, 0)])
    assert met["albedo"][0] == pytest.approx(COLOR, rel=1e-5) and np.isnan(met["albedo"][1]).all()


@pytest.mark.parametrize("bounces", [0, 1, 4])
def test_places_in_the_air(scene, cache, smooth, truth, bounces):
    found = cache.irradiance(SENSORS, UP, smooth, scene=scene, bounces=bounces)
    assert np.allclose(found, truth[bounces], rtol=0.03)
    assert not np.allclose(1.08 * found, truth[bounces], rtol=0.03)  # the control: 8 per cent more
    # Among places on surfaces, whose values stay.
    floor = np.array([(0.5, 0, 0.5), (-0.5, 0, 0.5)])
    both = cache.irradiance(np.concatenate([floor, SENSORS]), UP, smooth, scene=scene, bounces=bounces)
    assert np.array_equal(both[2:], found)
    assert np.array_equal(both[:2], cache.irradiance(floor, UP, smooth, scene=scene, bounces=bounces))


def test_a_place_in_the_air_without_a_scene_is_refused_by_name(cache, smooth):
    for call in (lambda: cache.irradiance(SENSORS, UP, smooth), lambda: cache.operator(SENSORS, UP)):
        with pytest.raises(shadowcache.Error, match=r"points: \(0.3, 0.75, 0.2\) is at no surface .* scene="):
            call()
    # What is no number is none, and refuses nothing.
    assert np.isnan(cache.irradiance((np.nan, 0, 0), UP, smooth)).all()
    assert np.isnan(cache.operator((np.nan, 0, 0), UP, level=1)).all()


# Patches.

@pytest.mark.parametrize("level", [1, 3, 5])
def test_patches_are_the_light_of_a_sky(smooth, white, sunrise, level):
    count = 20 * 4 ** level
    directions = shadowcache.patch_directions(level)
    light, angles = smooth.patches(level), white.patches(level)
    assert directions.shape == light.shape == angles.shape == (count, 3)
    assert np.allclose(np.linalg.norm(directions, axis=1), 1)
    assert light.sum(axis=0) == pytest.approx(smooth.integrate(), rel=1e-5)
    assert angles.sum(axis=0) == pytest.approx([4 * np.pi] * 3, rel=1e-5)
    if level >= 3:
        seen = smooth.look_up(directions)[0] * angles
        assert np.abs(light - seen).sum() < 0.02 * light.sum()
        assert np.abs(light - seen[::-1]).sum() > 0.02 * light.sum()  # the control: another order
    brightest = directions[np.argmax(sunrise.patches(level).sum(axis=1))]
    texels = sunrise.sample(256)[0].mean(axis=0)
    assert brightest @ texels > 0.5


@pytest.fixture(scope="module")
def even(white, sunrise):
    """The light of the patches of a sky, spread over them: a map that has it by nearest patches."""
    light = sunrise.patches() / white.patches()
    theta = (np.arange(64) + 0.5) * np.pi / 64
    phi = np.pi - (np.arange(128) + 0.5) * 2 * np.pi / 128  # row 0 is +Y, the middle looks to +Z
    ways = np.stack(np.broadcast_arrays(np.sin(theta)[:, None] * np.sin(phi), np.cos(theta)[:, None],
                                        np.sin(theta)[:, None] * np.cos(phi)), axis=-1)
    nearest = np.argmax(ways.reshape(-1, 3) @ shadowcache.patch_directions().T, axis=1)
    return shadowcache.Environment.from_array(light[nearest].reshape(64, 128, 3))


@pytest.mark.parametrize("bounces", [0, 4, "unlimited"])
def test_operator_is_the_irradiance(scene, cache, smooth, even, operators, bounces):
    places, operator = operators[0], operators[1](bounces)
    assert operator.shape == (8, 1280, 3) and operator.dtype == np.float32 and operator.min() >= 0
    for sky in (smooth, even):
        product = (operator * sky.patches()).sum(axis=-2)
        wanted = cache.irradiance(places, UP, sky, scene=scene, bounces=bounces)
        assert np.allclose(product, wanted, rtol=0.03, atol=0.01 * wanted.max())
        # The control: the light of another sky.
        other = (operator * sky.rotate(90).patches()).sum(axis=-2)
        assert not np.allclose(other, wanted, rtol=0.03, atol=0.01 * wanted.max())


def test_operator_against_paths(smooth, truth, operators):
    found, direct = ((operators[1](bounces)[:len(SENSORS)] * smooth.patches()).sum(axis=-2) for bounces in (4, 0))
    assert np.allclose(found, truth[4], rtol=0.03)
    assert not np.allclose(direct, truth[4], rtol=0.1)  # the control: bounces matter


def test_operator_of_an_open_floor(white):
    """Closed form: the cosine to each patch, and nothing from below."""
    floor = shadowcache.load_set([(-9, 0, -9), (9, 0, -9), (9, 0, 9), (-9, 0, 9)], [[0, 2, 1], [0, 3, 2]])
    baked = shadowcache.bake(floor, spacing=1, level=3, rays=4)
    for place in ((0.3, 0, 0.2), (0.3, 2, 0.2)):
        operator = baked.operator(place, UP, scene=floor)[:, 0]
        height = shadowcache.patch_directions()[:, 1]
        clear = np.abs(height) > 0.1
        assert np.allclose(operator[clear], np.maximum(0, height[clear]), atol=0.01)
        assert (operator * white.patches()[:, 0]).sum() == pytest.approx(np.pi, rel=0.01)


def test_operator_refuses(cache, scene):
    for level in (0, 6):
        with pytest.raises(ValueError, match="level: expected 1 to 5"):
            cache.operator(SENSORS, UP, level=level, scene=scene)
        with pytest.raises(ValueError, match="level: expected 1 to 5"):
            shadowcache.patch_directions(level)
    with pytest.raises(ValueError, match="bounces"):
        cache.operator(SENSORS, UP, bounces=-1, scene=scene)


def test_operator_has_the_same_bits_for_any_threads_and_any_company(cache, scene):
    def make(places, threads):
        return cache.operator(places, UP, level=2, bounces=2, scene=scene, threads=threads)

    one, two = make(SENSORS, 1), make(SENSORS, 2)
    assert np.array_equal(one, two)
    assert np.array_equal(make(SENSORS[1], 2), one[1])


def test_many_places_in_the_air_are_quick(cache, scene, smooth):
    places = np.random.default_rng(1).uniform((-0.9, 0.3, -0.9), (0.9, 1.3, 0.9), (100, 3))
    begin = time.process_time()
    assert np.isfinite(cache.irradiance(places, UP, smooth, scene=scene)).all()
    spent = time.process_time() - begin
    print(f"{spent:.2f} processor seconds for 100 places")
    assert spent < 10
