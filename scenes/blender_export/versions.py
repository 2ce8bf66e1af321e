"""What Blender 4.0 to 4.2 name otherwise than 3.4. The names of 3.4 are asked for; what is there tells them apart."""

import numpy

from .triangles import read

# Inputs of Principled, by their names in 3.4. [Release notes of 4.0]
PRINCIPLED = {"Specular": "Specular IOR Level", "Emission": "Emission Color", "Subsurface": "Subsurface Weight",
              "Sheen": "Sheen Weight", "Clearcoat": "Coat Weight", "Transmission": "Transmission Weight"}
STANDARD_INDEX = 1.5


def principled_input(shader, name):
    return shader.inputs[name if name in shader.inputs else PRINCIPLED[name]]


def has_own_index(shader):
    """Whether the index of refraction changes what Principled reflects: from 4.0 on."""
    return PRINCIPLED["Specular"] in shader.inputs


def specular_scale(shader):
    """What the index of refraction makes of Principled's Specular: a factor of it, 1 at 1.5."""
    if not has_own_index(shader):
        return 1.0
    def amplitude(index):
        return (index - 1) / (index + 1)

    return (amplitude(shader.inputs["IOR"].default_value) / amplitude(STANDARD_INDEX)) ** 2


def splits_normals(mesh):
    """Whether a mesh may have other normals in its corners than in its vertices or faces."""
    return mesh.use_auto_smooth if hasattr(mesh, "use_auto_smooth") else mesh.normals_domain == "CORNER"


def smooth_angle(mesh):
    """Up to which normals are smooth, where a mesh has such an angle: until 4.0."""
    return getattr(mesh, "auto_smooth_angle", 0)


def corner_normals(mesh):
    """Of the loops, where Blender splits normals or the file sets them; else None."""
    if not splits_normals(mesh):
        return None
    if hasattr(mesh, "corner_normals"):  # from 4.1 on
        return read(mesh.corner_normals, "vector", 3, numpy.float32)
    mesh.calc_normals_split()
    return read(mesh.loops, "normal", 3, numpy.float32)


def setting_of(material, name):
    """A setting that 4.2 has in the material, and 3.4 in what Cycles adds to it; None without that add-on."""
    owner = material if hasattr(material, name) else getattr(material, "cycles", None)
    return getattr(owner, name, None)


def add_socket(tree, kind, name, is_output=False):
    """A socket of a node group."""
    if hasattr(tree, "interface"):  # from 4.0 on
        return tree.interface.new_socket(name, in_out="OUTPUT" if is_output else "INPUT", socket_type=kind)
    return (tree.outputs if is_output else tree.inputs).new(kind, name)


def falloff_of_spots(blender):
    """Up to 3.6 a spot is a flat disc, which gives less to the side. blender: its version."""
    return "smoothstep times cosine" if tuple(blender) < (4, 0) else "smoothstep"
