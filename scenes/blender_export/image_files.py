"""Files of images, and what of them Cycles reads otherwise than Blender, by their headers."""

import os
import re
import struct

import bpy

PNG, PALETTE = b"\x89PNG\r\n\x1a\n", 3
# Beginnings of files of which Cycles and Blender read the same; TGA has none.
KINDS = "PNG, JPEG, BMP, TGA, TIFF, WebP, EXR and Radiance"
READ_ALIKE = (PNG, b"\xff\xd8\xff", b"BM", b"II*\0", b"MM\0*", b"RIFF", b"\x76\x2f\x31\x01", b"#?")
TGA_ORDER = 17  # place of the byte with the order of texels
MOST_HEADER = 1 << 16  # bytes, of a Radiance file


def path_of(image):
    """Of the file that Cycles reads itself, whether it is there or not; empty for another image."""
    if image.source != "FILE" or image.packed_file:
        return ""
    return bpy.path.abspath(image.filepath, library=image.library)


def unlike_blender(image):
    """In words, what Cycles reads otherwise; empty if nothing is known."""
    path = path_of(image)
    if not os.path.isfile(path):
        return ""
    with open(path, "rb") as file:
        magic = file.read(len(PNG))
        if not magic.startswith(READ_ALIKE):
            if not path.lower().endswith(".tga"):
                return "a file of another kind than %s" % KINDS
            if is_from_right(file):
                return "columns from the right"
        if magic == PNG and has_transparent_colour(file):
            return "a transparent colour (tRNS)"
        if magic.startswith(b"#?") and has_turned_rows(file):
            return "rows in another order than from above"
    return ""


def has_transparent_colour(file):
    """Of a PNG behind its magic number; what a palette has is read alike."""
    while True:
        chunk = file.read(8)
        size, name = struct.unpack(">I4s", chunk) if len(chunk) == 8 else (0, b"IEND")
        if name in (b"tRNS", b"IDAT", b"IEND"):
            return name == b"tRNS"
        data = file.read(size)
        if name == b"IHDR" and data[9:10] == bytes((PALETTE,)):
            return False
        file.seek(4, os.SEEK_CUR)


def is_from_right(file):
    """Whether the rows of a TGA begin on the right, which Blender does not heed."""
    file.seek(TGA_ORDER)
    return any(byte & 0x10 for byte in file.read(1))


def has_turned_rows(file):
    """Of a Radiance file, of which Cycles takes the first row for the uppermost."""
    found = re.search(rb"\n\r?\n([^\n]*)", file.read(MOST_HEADER))
    return bool(found) and not re.match(rb"-Y \d+ \+X \d+", found.group(1))
