"""Errors of pictures, as shadowcache-render measures them, and whether two ways to render agree."""
import numpy as np

LUMINANCE = (0.2126, 0.7152, 0.0722)
# Standard errors by which means may differ; 1 in 16,000 correct pairs differs by more.
MOST_DEVIATIONS = 4.0
TILE_ROWS = 10


class Disagreement(RuntimeError):
    """Two ways to render the same picture have different light."""


def relative_error(picture, reference):
    """(relMSE, p99): mean over the pixels, and 99th percentile, of (x - r)^2 / (r^2 + 0.01 mean(r)^2)."""
    picture, reference = np.asarray(picture, np.float64), np.asarray(reference, np.float64)
    scale = reference ** 2 + 0.01 * reference.mean() ** 2
    errors = np.zeros_like(reference)
    np.divide((picture - reference) ** 2, scale, out=errors, where=scale > 0)
    errors = np.sort(errors.mean(axis=2).ravel())
    return errors.mean(), errors[min(errors.size - 1, int(0.99 * errors.size))]


def noise_of_mean(first, second):
    """relMSE that the mean of two independent renders has left: half their difference has its variance."""
    return relative_error(first, (np.asarray(first, np.float64) + second) / 2)[0]


def tile_means(picture, side):
    rows, columns = picture.shape[0] // side, picture.shape[1] // side
    cut = (np.asarray(picture, np.float64) @ LUMINANCE)[:rows * side, :columns * side]
    return cut.reshape(rows, side, columns, side).mean(axis=(1, 3)).ravel()


def agreement(pictures, reference):
    """Mean radiance of independent pictures over that of the reference: (difference, standard error), relative.

    The error is that of tiles, whose noise is independent. Raises Disagreement where the difference is not noise.
    """
    side = max(1, reference.shape[0] // TILE_ROWS)
    light = tile_means(reference, side)
    tiles = (tile_means(np.mean(pictures, axis=0), side) - light) / light.mean()
    difference, deviation = tiles.mean(), tiles.std(ddof=1) / np.sqrt(tiles.size)
    if abs(difference) > MOST_DEVIATIONS * deviation:
        raise Disagreement(f"pictures with and without a cache differ by {100 * difference:.2g} +- "
                           f"{100 * deviation:.1g} % of their radiance, which is not noise: their errors mean nothing")
    return difference, deviation
