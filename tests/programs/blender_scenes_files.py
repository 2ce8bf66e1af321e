"""More scenes of blender_scenes_cases.py: images whose files Cycles reads otherwise than shadowcache-render or Blender do."""

import os
import struct
import sys
import zlib

import bpy
import numpy
from blender_kit import checks, diffuse, image, names, plane, shows, textured
from blender_scene import WORK
from blender_scenes_found import is_baked, scene

HEIGHT, WIDTH = 4, 8
HDR_SIZE = b"-Y 4 +X 8"


def texels_of_map():
    """Bright below, green on the left."""
    texels = numpy.full((HEIGHT, WIDTH, 3), 0.25, numpy.float32)
    texels[HEIGHT // 2:] = 1
    texels[:, :WIDTH // 2, 1] *= 2
    return texels


def new_path(ending):
    return os.path.join(WORK, "file%d%s" % (len(os.listdir(WORK)), ending))


def write(ending, data):
    path = new_path(ending)
    with open(path, "wb") as out:
        out.write(data)
    return path


def exr(texels, change=lambda data: data):
    """Of floats; change(bytes) makes another file of it."""
    path = new_path(".exr")
    sys.modules["shadowcache.exr"].write(path, texels)
    with open(path, "rb") as file:
        data = file.read()
    return write(".exr", change(data))


def shown_in(box):
    """Puts a display window of other corners into an EXR."""
    def change(data):
        at = data.index(b"displayWindow\0box2i\0") + len(b"displayWindow\0box2i\0") + 4
        return data[:at] + struct.pack("<4i", *box) + data[at + 16:]
    return change


def as_halves(data):
    """An EXR of floats as one of halves."""
    first = data.index(b"screenWindowWidth\0float\0") + len(b"screenWindowWidth\0float\0") + 8 + 1
    lines = numpy.frombuffer(data, [("y", "<i4"), ("size", "<i4"), ("texels", "<f4", (3, WIDTH))], HEIGHT, first + 8 * HEIGHT)
    made = numpy.empty(HEIGHT, [("y", "<i4"), ("size", "<i4"), ("texels", "<f2", (3, WIDTH))])
    made["y"], made["size"], made["texels"] = lines["y"], 6 * WIDTH, lines["texels"]
    offsets = first + 8 * HEIGHT + made.itemsize * numpy.arange(HEIGHT, dtype="<u8")
    return data[:first].replace(b"\0\2\0\0\0", b"\0\1\0\0\0") + offsets.tobytes() + made.tobytes()


def rgbe(texels):
    exponents = numpy.floor(numpy.log2(texels.max(axis=-1))).astype(int) + 1
    mantissas = texels * 256 / 2.0 ** exponents[..., None]
    return numpy.dstack((numpy.clip(mantissas, 0, 255), exponents + 128)).astype(numpy.uint8)


def hdr(head=b"", size=HDR_SIZE, rows=None):
    return write(".hdr", b"#?RADIANCE\n" + head + b"FORMAT=32-bit_rle_rgbe\n\n" + size + b"\n"
                 + (rgbe(texels_of_map()).tobytes() if rows is None else rows))


def in_runs(texels):
    """Rows of a Radiance file, each byte a run of one."""
    return b"".join(bytes((2, 2, 0, WIDTH)) + b"".join(bytes((129, value)) for value in row.T.ravel()) for row in rgbe(texels))


def world_of(path):
    tree = scene().world.node_tree
    node = tree.nodes.new("ShaderNodeTexEnvironment")
    node.image = bpy.data.images.load(path)
    tree.links.new(node.outputs["Color"], tree.nodes["Background"].inputs["Color"])
    return node.image


@shows
def world_of_radiance_file_with_exposure():
    """And with its rows from below, which Cycles takes for rows from above."""
    world_of(hdr(b"EXPOSURE=4\n", b"+Y 4 +X 8"))
    plane(diffuse()[0])


@shows
def world_of_window_with_infinity():
    texels = texels_of_map()
    texels[0, 1] = numpy.inf
    world_of(exr(texels, shown_in((-WIDTH, 0, WIDTH - 1, 2 * HEIGHT - 1))))
    plane(diffuse()[0])


# Textures.

def textured_by(path, space="sRGB", alpha_mode="STRAIGHT"):
    """A plane with the image of a file for its colour."""
    node = textured()[2]
    node.image, node.interpolation = bpy.data.images.load(path), "Closest"
    node.image.colorspace_settings.name, node.image.alpha_mode = space, alpha_mode
    return node.image


def png(most=255, alpha=1.0):
    texels = (numpy.array(checks(alpha)) * (0.6, 0.5, 0.4, 1))[..., :4 if alpha < 1 else 3]
    return sys.modules["shadowcache.blender_export.pictures"].write_png(texels, most)


def saved(ending, file_format):
    """The image with half opacity in a file as Blender saves it."""
    made = bpy.data.images.new("saved", 2, 2, alpha=True, float_buffer=True)
    made.pixels.foreach_set([0.2, 0.3, 0.4, 0.5] * 4)
    made.filepath_raw, made.file_format = new_path(ending), file_format
    made.save()
    return made.filepath_raw


@shows
def sixteen_bits_whose_alpha_is_ignored():
    assert textured_by(write(".png", png(65535, 0.25)), alpha_mode="NONE").is_float


@shows
def encoded_floats_whose_alpha_is_ignored():
    textured_by(exr(texels_of_map() / 2), alpha_mode="NONE")


@names("a transparent colour (tRNS)")
def transparent_colour():
    data, end = png(), 8 + 12 + 13
    chunk = b"tRNS" + bytes(6)
    textured_by(write(".png", data[:end] + struct.pack(">I", 6) + chunk + struct.pack(">I", zlib.crc32(chunk)) + data[end:]))


@names("a file of another kind than PNG")
def another_kind():
    """Of logarithms, which Cycles reads as they are."""
    textured_by(saved(".dpx", "DPX"))


def see_through(alpha_texels=None, **settings):
    """A plane with an image for its colour, and the Alpha of that, or the colour of another one, for its opacity."""
    texels = numpy.random.default_rng(1).random((4, 4, 4))
    _, tree, node = textured(texels, **settings)
    shader = tree.nodes.new("ShaderNodeBsdfPrincipled")
    shader.inputs["Specular"].default_value = 0
    tree.links.new(node.outputs["Color"], shader.inputs["Base Color"])
    tree.links.new(shader.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    if alpha_texels is None:
        tree.links.new(node.outputs["Alpha"], shader.inputs["Alpha"])
        return
    other = tree.nodes.new("ShaderNodeTexImage")
    other.image = image(alpha_texels, "Non-Color")
    tree.links.new(other.outputs["Color"], shader.inputs["Alpha"])


@names("Cycles filters its colours times their opacity")
def colours_between_opacities():
    see_through()


@names("in one texture with others of another size or filter")
def images_of_two_sizes():
    see_through(checks())


@shows
def opacity_that_nothing_uses():
    """Colours are then times it."""
    _, tree, node = textured(checks(alpha=0.25))
    tree.links.new(node.outputs["Alpha"], tree.nodes.new("ShaderNodeMath").inputs[0])


@names("columns from the right")
def columns_from_the_right():
    head = struct.pack("<BBBHHBHHHHBB", 0, 0, 2, 0, 0, 0, 0, 0, 2, 1, 24, 0x10)
    textured_by(write(".tga", head + bytes((0, 0, 255, 0, 128, 0))))


@names("alpha of a WEBP")
def alpha_of_webp():
    textured_by(saved(".webp", "WEBP"))


@names("alpha of a BMP")
def alpha_of_bmp():
    head = struct.pack("<2sIHHIIiiHHIIiiII", b"BM", 62, 0, 0, 54, 40, 2, 1, 1, 32, 0, 8, 0, 0, 0, 0)
    textured_by(write(".bmp", head + bytes((0, 0, 255, 0, 0, 128, 0, 100))))


@names("rows in another order than from above")
def rows_from_below():
    textured_by(hdr(size=b"+Y 4 +X 8"), "Linear")


@names("alpha of floats with colour space sRGB")
def encoded_floats_with_alpha():
    textured_by(saved(".exr", "OPEN_EXR"))


@names("alpha of a TIFF")
def alpha_of_tiff():
    textured_by(saved(".tif", "TIFF"))


@names("premultiplied alpha")
def premultiplied_and_packed():
    textured_by(write(".png", png(alpha=0.25)), alpha_mode="PREMUL").pack()


def map_files():
    """Files that are handed over, as Cycles reads them alike, and those of which it makes a map."""
    plain, infinite, not_numbers = (texels_of_map() for _ in range(3))
    infinite[1, 1], not_numbers[1, 1] = numpy.inf, numpy.nan
    alike = {"exr": exr(plain), "halves": exr(plain, as_halves), "infinite halves": exr(infinite, as_halves),
             "hdr": hdr(), "runs": hdr(rows=in_runs(plain)), "notes": hdr(b"# by hand\nSOFTWARE=none\npfilt -e 2\nEXPOSURE=1.0\n")}
    other = {"window": exr(plain, shown_in((0, 0, WIDTH, HEIGHT - 1))), "infinity": exr(infinite),
             "not a number": exr(not_numbers), "halves, not a number": exr(not_numbers, as_halves),
             "several parts": exr(plain, lambda data: data[:5] + b"\x10" + data[6:]),
             "other channels": exr(plain, lambda data: data.replace(b"R\0\2\0\0\0", b"S\0\2\0\0\0")),
             "exposure": hdr(b"EXPOSURE=4\n"), "correction": hdr(b"COLORCORR=1 2 1\n"), "unknown": hdr(b"THING=1\n"),
             "rows from below": hdr(size=b"+Y 4 +X 8"), "columns": hdr(size=b"+X 8 -Y 4"),
             "old runs": hdr(rows=b"\1\1\1\x80" * 8)}
    for files, baked in ((alike, False), (other, True)):
        for name, path in files.items():
            image = world_of(path)
            for space in ("Linear", "sRGB") if baked else ("Linear",):
                image.colorspace_settings.name = space
                assert is_baked() == baked, "%s, %s" % (name, space)
    for path in (write(".exr", b"\x76\x2f\x31\x01 no map"), write(".hdr", b"no map")):
        world_of(path)
        try:
            is_baked()
        except ValueError as error:
            assert path in str(error), error
        else:
            raise AssertionError("%s is not refused" % path)
