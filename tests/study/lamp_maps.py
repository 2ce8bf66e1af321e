"""Maps of lamps for the study: rectangles of light all over the upper half of the sky, as in a shop
full of tubes. Written as Radiance pictures."""

import numpy

WIDTH, HEIGHT = 1600, 800
DULL, LIGHT = 0.2, 8.0  # radiance of the walls; sum of radiance times solid angle of the lamps


def directions():
    polar = numpy.pi * (numpy.arange(HEIGHT) + 0.5) / HEIGHT
    longitude = numpy.pi - 2 * numpy.pi * (numpy.arange(WIDTH) + 0.5) / WIDTH
    sine = numpy.sin(polar)[:, None]
    return numpy.stack([sine * numpy.sin(longitude),
                        numpy.broadcast_to(numpy.cos(polar)[:, None], (HEIGHT, WIDTH)),
                        sine * numpy.cos(longitude)], -1)


def add_lamp(light, ways, axis, side, degrees, power):
    """A rectangle between great circles, `degrees` = (width, height), turned by `side`."""
    axis = axis / numpy.linalg.norm(axis)
    side = numpy.cross(axis, side)
    side /= numpy.linalg.norm(side)
    width, height = numpy.radians(degrees)
    x = ways @ axis
    inside = (x > 0) & (abs(ways @ side) < numpy.tan(width / 2) * x) & (
        abs(ways @ numpy.cross(axis, side)) < numpy.tan(height / 2) * x)
    light[inside] += power / (width * height)


def upwards(random):
    axis = random.normal(size=3)
    return numpy.array([axis[0], abs(axis[1]), axis[2]])


def turned_lamps(count, degrees, seed):
    """`count` squares `degrees` wide, anywhere and at any angle."""
    random = numpy.random.default_rng(seed)
    ways, light = directions(), numpy.full((HEIGHT, WIDTH), DULL)
    for _ in range(count):
        add_lamp(light, ways, upwards(random), random.normal(size=3), (degrees, degrees),
                 LIGHT / count)
    return light


def shop(seed):
    """60 lamps of 2 to 6 degrees, and two of half a degree that have half of the lamps' light: the
    paper's video store has "two very bright and small lights", and tubes."""
    random = numpy.random.default_rng(seed)
    ways, light = directions(), numpy.full((HEIGHT, WIDTH), DULL)
    for _ in range(60):
        add_lamp(light, ways, upwards(random), random.normal(size=3), random.uniform(2, 6, 2),
                 LIGHT / 120)
    for axis in ((0.5, 0.7, 0.6), (-0.6, 0.6, 0.3)):
        add_lamp(light, ways, numpy.array(axis), random.normal(size=3), (0.5, 0.5), LIGHT / 4)
    return light


def aligned_lamps(count, columns, rows, seed):
    """Lamps that fill `count` rectangles of a grid of columns x rows exactly."""
    random = numpy.random.default_rng(seed)
    light = numpy.zeros((HEIGHT, WIDTH))
    w, h = WIDTH // columns, HEIGHT // rows
    for _ in range(count):
        x = random.integers(columns)
        # Uniform over the sphere, down to the horizon.
        y = int(numpy.arccos(random.uniform()) / numpy.pi * rows)
        area = 2 * numpy.pi / columns * (numpy.cos(numpy.pi * y / rows) -
                                         numpy.cos(numpy.pi * (y + 1) / rows))
        light[y * h:(y + 1) * h, x * w:(x + 1) * w] = LIGHT / (count * area)
    return DULL + light


def reduced(picture, width, height):
    """Means over blocks of texels, by solid angle."""
    weight = numpy.sin(numpy.pi * (numpy.arange(HEIGHT) + 0.5) / HEIGHT)[:, None]
    blocks = lambda p: p.reshape(height, HEIGHT // height, width, WIDTH // width).sum((1, 3))
    return blocks(picture * weight) / blocks(numpy.broadcast_to(weight, picture.shape))


def write(path, picture):
    """Grey, as an uncompressed Radiance picture: eight bits and a power of two for each texel."""
    mantissa, exponent = numpy.frexp(picture)
    texels = numpy.empty((*picture.shape, 4), numpy.uint8)
    texels[..., :3] = (mantissa * 256).astype(numpy.uint8)[..., None]
    texels[..., 3] = exponent + 128
    with open(path, "wb") as file:
        file.write(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n")
        file.write(b"-Y %d +X %d\n" % picture.shape)
        file.write(texels.tobytes())
