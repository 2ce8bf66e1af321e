"""A year of hourly irradiance on sensors 0.75 m above the ground, with bounces, beside brute force in a few of the hours.

Usage: year_of_sensors.py SET CACHE OUT.npz [SENSORS [LEVEL]]

The sky is blue and brightest about the sun, over 48 degrees of latitude; north is -Z.
"""
import sys
import time

import numpy as np

import shadowcache

BOUNCES, UP = 4, np.array((0.0, 1, 0))
BLUE, SUNLIGHT = np.array((0.5, 0.7, 1.0)), np.array((20.0, 18, 15))  # radiance; irradiance at right angles to the sun


def sun_directions(hours, latitude=np.radians(48)):
    """Unit vectors to the sun, by the day's declination and the hour's angle."""
    declination = np.radians(-23.44) * np.cos(2 * np.pi * (hours / 24 + 10) / 365)
    angle = np.radians(15 * (hours % 24 - 12))
    south = np.sin(latitude) * np.cos(declination) * np.cos(angle) - np.cos(latitude) * np.sin(declination)
    up = np.sin(latitude) * np.sin(declination) + np.cos(latitude) * np.cos(declination) * np.cos(angle)
    return np.stack([-np.cos(declination) * np.sin(angle), up, south], axis=-1)


def sky_radiance(directions, sun):
    """Of the sky alone, for each sun and each direction, without its colour; none below the horizon."""
    glow = 0.3 + np.clip(np.sum(directions * sun, axis=-1), 0, 1) ** 8
    return glow * np.clip(sun[..., 1], 0, None) * (directions[..., 1] > 0)


def year(scene, cache, sensors, sun, level):
    """Irradiance of each hour on each sensor: the sky by one product, the sun by a ray."""
    direct, light = (cache.operator(sensors, UP, level=level, bounces=b, scene=scene) for b in (0, BOUNCES))
    patches = shadowcache.patch_directions(level)
    solid_angles = shadowcache.Environment.constant(1).patches(level)[:, 0]
    sky = (sky_radiance(patches, sun[:, None]) * solid_angles).astype(np.float32)
    irradiance = np.stack([sky @ light[..., k].T * BLUE[k] for k in range(3)], axis=-1)
    day = np.flatnonzero(sun[:, 1] > 0)
    lit = ~scene.occluded(sensors, sun[day, None]) * sun[day, None, 1]
    nearest = np.argmax(sun[day] @ patches.T, axis=1)
    irradiance[day] += (lit[..., None] + np.swapaxes(light - direct, 0, 1)[nearest]) * SUNLIGHT
    return irradiance


def brute_force(scene, sensors, sun, rays):
    """The same of one hour by paths of rays, without a cache: slow and noisy, and true."""
    rng = np.random.default_rng(1)
    start, normal = np.repeat(sensors, rays, axis=0), np.broadcast_to(UP, (len(sensors) * rays, 3))
    weight, found = np.ones_like(start), np.zeros_like(start)
    alive = np.arange(len(start))
    for _ in range(BOUNCES + 1):
        cosine = np.clip(normal @ sun, 0, None) * ~scene.occluded(start, sun)
        found[alive] += weight * cosine[:, None] * SUNLIGHT
        direction = rng.normal(size=start.shape)
        direction = normal + direction / np.linalg.norm(direction, axis=1, keepdims=True)
        direction /= np.linalg.norm(direction, axis=1, keepdims=True)
        met = scene.intersect(start, direction)
        sky = np.isinf(met["distance"])
        found[alive[sky]] += weight[sky] * sky_radiance(direction[sky], sun)[:, None] * BLUE * np.pi
        alive, weight = alive[~sky], weight[~sky] * met["albedo"][~sky]
        start, normal = met["start"][~sky], met["normal"][~sky].astype(float)
    return found.reshape(len(sensors), rays, 3).mean(axis=1)


if __name__ == "__main__":
    set_file, cache_file, out, *more = sys.argv[1:]
    count, level = int(more[0]) if more else 200, int(more[1]) if len(more) > 1 else 3
    scene, cache = shadowcache.load_set(set_file), shadowcache.Cache.open(cache_file)
    low, high = scene.bounds
    above = np.random.default_rng(2).uniform(low, high, (20 * count, 3)) * (1, 0, 1) + (0, high[1] + 1, 0)
    ground = scene.intersect(above, -UP)
    sensors = ground["position"][ground["normal"][:, 1] > 0.9][:count] + 0.75 * UP
    hours = np.arange(8760) + 0.5
    sun = sun_directions(hours)

    begin, spent = time.time(), time.process_time()
    irradiance = year(scene, cache, sensors, sun, level)
    print(f"{len(hours)} hours on {len(sensors)} sensors: {time.time() - begin:.1f} s ({time.process_time() - spent:.1f} of processors)")
    begin, spent = time.time(), time.process_time()
    some = np.flatnonzero(sun[:, 1] > 0.2)[:: len(hours) // 8]
    truth = np.array([brute_force(scene, sensors, sun[hour], rays=2000) for hour in some])
    print(f"{len(some)} hours by brute force: {time.time() - begin:.1f} s ({time.process_time() - spent:.1f} of processors)")
    error = np.abs(irradiance[some] - truth).mean(axis=(1, 2)) / truth.mean(axis=(1, 2))
    print("deviation of the sensors, and of their mean:")
    for hour, each, mean in zip(hours[some], error, irradiance[some].mean(axis=(1, 2)) / truth.mean(axis=(1, 2)) - 1):
        print(f"  hour {hour:6.1f}: {each:6.2%} {mean:+7.2%}")
    np.savez(out, sensors=sensors, hours=hours, irradiance=irradiance.astype(np.float32), checked=some, truth=truth)
