"""Blender's matrices as glTF's nodes have them."""

import math

import numpy

# Blender's +Z up to glTF's +Y up.
TURN = numpy.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]], float)


def of_mesh(matrices):
    """World matrices (n, 4, 4) of meshes that are turned themselves."""
    return TURN @ matrices @ TURN.T


def of_camera(matrices):
    """World matrices of cameras, which look along -Z in both worlds; a camera has no scale."""
    turned = TURN @ matrices
    turned[..., :3, :3] /= numpy.maximum(numpy.linalg.norm(turned[..., :3, :3], axis=-2, keepdims=True), 1e-30)
    return turned


def of_lamp(matrices):
    """World matrices of lamps, which shine along -Z in both worlds."""
    return TURN @ matrices


def quaternion(m):
    """x, y, z, w of a rotation matrix."""
    w = numpy.array([1 + m[0, 0] + m[1, 1] + m[2, 2], 1 + m[0, 0] - m[1, 1] - m[2, 2],
                     1 - m[0, 0] + m[1, 1] - m[2, 2], 1 - m[0, 0] - m[1, 1] + m[2, 2]])
    k = int(w.argmax())
    s = 2 * math.sqrt(max(w[k], 1e-30))
    parts = {0: (m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1], s * s / 4),
             1: (s * s / 4, m[0, 1] + m[1, 0], m[0, 2] + m[2, 0], m[2, 1] - m[1, 2]),
             2: (m[0, 1] + m[1, 0], s * s / 4, m[1, 2] + m[2, 1], m[0, 2] - m[2, 0]),
             3: (m[0, 2] + m[2, 0], m[1, 2] + m[2, 1], s * s / 4, m[1, 0] - m[0, 1])}[k]
    return [p / s for p in parts]


def has_shear(matrix):
    """Whether the axes of a matrix are not at right angles, by more than rounding in single precision."""
    axes = matrix[:3, :3] / numpy.maximum(numpy.linalg.norm(matrix[:3, :3], axis=0), 1e-30)
    product = axes.T @ axes
    return bool(numpy.abs(product - numpy.diag(numpy.diag(product))).max() > 1e-5)


def parts(matrix):
    """Translation, rotation (x, y, z, w) and scale of a matrix without shear; a mirror is a negative x."""
    scale = numpy.linalg.norm(matrix[:3, :3], axis=0)
    axes = matrix[:3, :3] / numpy.maximum(scale, 1e-30)
    for k in numpy.flatnonzero(scale == 0):
        axes[:, k] = numpy.cross(axes[:, k - 2], axes[:, k - 1])
    if numpy.linalg.det(axes) < 0:
        scale[0], axes[:, 0] = -scale[0], -axes[:, 0]
    return matrix[:3, 3].tolist(), quaternion(axes), scale.tolist()


def sheared_parts(matrix):
    """Parts of an outer node, and the rotation of a node in it, that make a matrix with shear: U S V^T."""
    u, s, vt = numpy.linalg.svd(matrix[:3, :3])
    for rotation in (u, vt):
        if numpy.linalg.det(rotation) < 0:
            rotation *= -1
            s = -s
    return (matrix[:3, 3].tolist(), quaternion(u), s.tolist()), quaternion(vt)
