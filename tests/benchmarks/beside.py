"""Writes two EXR pictures of one size beside each other as PNG, the first at the left.

Usage: blender -b --factory-startup --python-exit-code 1 --python beside.py -- LEFT.exr RIGHT.exr OUT.png
"""
import sys

import bpy
import numpy

GAP = 4  # pixels


def srgb_pixels(path):
    image = bpy.data.images.load(path)
    width, height = image.size
    linear = numpy.array(image.pixels[:]).reshape(height, width, 4).clip(0, 1)
    encoded = numpy.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    encoded[..., 3] = 1
    return encoded


def main():
    left, right, out = sys.argv[sys.argv.index("--") + 1 :]
    a, b = srgb_pixels(left), srgb_pixels(right)
    both = numpy.concatenate([a, numpy.ones((len(a), GAP, 4)), b], axis=1)
    image = bpy.data.images.new("both", both.shape[1], both.shape[0])
    image.pixels = both.ravel()
    image.filepath_raw, image.file_format = out, "PNG"
    image.save()


main()
