"""Materials of a glTF document from Blender's: Principled, Diffuse and Emission, and the viewport's where a material
has no nodes.

Opacity counts as in Cycles, whatever a material's blend mode is; Alpha Clip makes a mask of it. The shader is read as
the depsgraph evaluated it: drivers and keys have their values of the frame.
"""

from dataclasses import dataclass, field, replace

from . import node_values, versions
from .node_values import Value, colour_of, number_of, placement, source
from .pictures import ONE

WRAPS = {"REPEAT": 10497, "EXTEND": 33071, "CLIP": 33071}
# Inputs of Principled that glTF's renderer here has nothing for, and the value that has no effect.
WITHOUT = ("Subsurface", "Sheen", "Clearcoat", "Transmission")


@dataclass
class Look:
    """What meshes need to know of a material."""
    number: object = None                      # in the document; None: none
    maps: list = field(default_factory=list)   # names of texture coordinates by TEXCOORD, "" for the active ones
    colours: object = None                     # name of the colours, "" for the active ones; None: none


class Materials:
    """Writes each material once."""

    def __init__(self, file, pictures, report):
        self.file = file
        self.pictures = pictures
        self.report = report
        self.known = {}

    def find(self, material):
        if material is None:
            return Look()
        if material.name_full not in self.known:
            self.known[material.name_full] = MaterialWriter(self.file, self.pictures, self.report, material).write()
        return self.known[material.name_full]


class MaterialWriter:
    """One material on its way into the document."""

    def __init__(self, file, pictures, report, material):
        self.file = file
        self.pictures = pictures
        self.report = report
        self.material = material
        self.look = Look()
        self.entry = {"name": material.name, "doubleSided": not material.use_backface_culling}

    def write(self):
        shader = self._shader()
        if shader is None:
            self._write_plain(self.material.diffuse_color)
        elif shader.type == "BSDF_PRINCIPLED":
            self._write_principled(shader)
        elif shader.type == "BSDF_DIFFUSE":
            self._write_base(colour_of(shader.inputs["Color"]), Value((1,)))
            self._write_gloss(Value((0,)), Value((1,)))
            self._write_specular(Value((0,)))
            self._write_normal(shader)
        else:
            self._write_plain((0, 0, 0))
            self._write_emission(shader.inputs["Color"], shader.inputs["Strength"])
        self.look.number = self.file.add("materials", self.entry)
        return self.look

    def leave_out(self, what):
        self.report.add("material %s: %s" % (self.material.name, what))

    def _shader(self):
        """The node that is written; None for the colour of the viewport."""
        if not self.material.use_nodes:
            return None
        socket, output = node_values.surface_of(self.material)
        for name in ("Volume", "Displacement"):
            if output and source(output.inputs[name]):
                self.leave_out(name)
        if socket and socket.node.type in ("BSDF_PRINCIPLED", "BSDF_DIFFUSE", "EMISSION"):
            return socket.node
        self.leave_out((socket.node.bl_label if socket else "no surface") + "; the viewport's colour is in its place")
        return None

    def _write_plain(self, colour):
        """A Lambertian surface."""
        self.entry["pbrMetallicRoughness"] = {"baseColorFactor": [*unit(colour[:3]), 1], "metallicFactor": 0}
        self._write_specular(Value((0,)))

    def _write_principled(self, shader):
        inputs = shader.inputs
        base = colour_of(inputs["Base Color"])
        self._write_base(base, number_of(inputs["Alpha"]))
        self._write_gloss(number_of(inputs["Metallic"]), number_of(inputs["Roughness"]))
        self._write_specular(self._specular_of(shader), self._tint_of(shader, base))
        self._write_emission(versions.principled_input(shader, "Emission"), inputs["Emission Strength"])
        self._write_normal(shader)
        for name in WITHOUT:
            socket = versions.principled_input(shader, name)
            if source(socket) or socket.default_value:
                self.leave_out(name)
        if inputs["Anisotropic"].default_value or source(inputs["Anisotropic"]):
            self.leave_out("Anisotropic")

    def _specular_of(self, shader):
        value = number_of(versions.principled_input(shader, "Specular"))
        if versions.has_own_index(shader) and source(shader.inputs["IOR"]):
            self.leave_out("IOR: node %s" % source(shader.inputs["IOR"]).node.bl_label)
        scale = versions.specular_scale(shader)
        return value if scale == 1 else replace(value, factor=(value.factor[0] * scale,))

    def _known(self, value, socket):
        if value.unknown:
            self.leave_out("%s: node %s" % (socket, value.unknown))
        return value

    def _texture(self, channels, colour, node):
        """A textureInfo of channels (see Pictures) at an image node's place; None if it cannot be had."""
        if node.projection != "FLAT":
            self.leave_out("image %s: %s projection" % (node.image.name, node.projection.lower()))
        if node.extension == "CLIP":
            self.leave_out("image %s: clipped outside of it" % node.image.name)
        picture = self.pictures.write(channels, colour)
        if picture is None:
            return None
        name, transform, unknown = placement(node)
        if unknown:
            self.leave_out("image %s: placed by %s" % (node.image.name, unknown))
        if name not in self.look.maps:
            self.look.maps.append(name)
        nearest = node.interpolation == "Closest"
        wrap = WRAPS.get(node.extension, 10497)
        sampler = self.file.add("samplers", {"magFilter": 9728 if nearest else 9729,
                                             "minFilter": 9728 if nearest else 9987, "wrapS": wrap, "wrapT": wrap})
        info = {"index": self.file.add("textures", {"source": picture, "sampler": sampler}),
                "texCoord": self.look.maps.index(name)}
        if transform:
            self.file.use("KHR_texture_transform")
            info["extensions"] = {"KHR_texture_transform": transform}
        return info

    def _beside(self, value, other, socket):
        """Whether the images of two values can be channels of one texture."""
        if not (value.image and other.image) or value.image == other.image:
            return True
        if placement(value.image) == placement(other.image) and value.image.extension == other.image.extension:
            return True
        self.leave_out("%s: its image is placed otherwise" % socket)
        return False

    def _write_base(self, colour, alpha):
        self._known(colour, "Base Color")
        self._known(alpha, "Alpha")
        if not self._beside(colour, alpha, "Alpha"):
            alpha = Value(alpha.factor)
        solid = alpha.image is None and alpha.colours is None and alpha.factor[0] >= 1
        for value in (colour, alpha):
            if value.colours is not None:
                self.look.colours = value.colours
        pbr = self.entry["pbrMetallicRoughness"] = {
            "baseColorFactor": [*unit(colour.factor), 1 if solid else unit(alpha.factor)[0]]}
        if not solid:
            if versions.setting_of(self.material, "use_transparent_shadow") is False:
                self.leave_out("Alpha: Transparent Shadows is off; here shadows have its holes")
            mask = self.material.blend_method == "CLIP"
            self.entry["alphaMode"] = "MASK" if mask else "BLEND"
            if mask:
                self.entry["alphaCutoff"] = self.material.alpha_threshold
        if colour.image or alpha.image:
            image = colour.image and colour.image.image
            rgb = [(image, k) for k in range(3)] if image else [ONE] * 3
            opacity = (alpha.image.image, alpha.channel) if alpha.image else (None if solid else ONE)
            info = self._texture((*rgb, opacity), True, colour.image or alpha.image)
            if info:
                pbr["baseColorTexture"] = info

    def _write_gloss(self, metallic, roughness):
        self._known(metallic, "Metallic")
        self._known(roughness, "Roughness")
        if not self._beside(roughness, metallic, "Metallic"):
            metallic = Value(metallic.factor)
        pbr = self.entry["pbrMetallicRoughness"]
        pbr["metallicFactor"], pbr["roughnessFactor"] = unit(metallic.factor)[0], unit(roughness.factor)[0]

        def channel(value):
            if value.image:
                return value.image.image, value.channel
            return ONE if value.factor[0] else None

        if metallic.image or roughness.image:
            info = self._texture((None, channel(roughness), channel(metallic), None), False,
                                 roughness.image or metallic.image)
            if info:
                pbr["metallicRoughnessTexture"] = info

    def _tint_of(self, shader, base):
        """Factors of Principled's reflectance: a share of the base's hue; from 4.0 on a colour."""
        socket, none = shader.inputs["Specular Tint"], (1, 1, 1)
        if versions.has_own_index(shader):
            tint = colour_of(socket)
            if tint.image or tint.colours is not None or tint.unknown:
                self.leave_out("Specular Tint")
                return none
            return tuple(tint.factor)
        tint = socket.default_value
        if not tint:
            return none
        if base.image or base.colours is not None:
            self.leave_out("Specular Tint")
            return none
        light = 0.2126 * base.factor[0] + 0.7152 * base.factor[1] + 0.0722 * base.factor[2]
        return tuple(1 - tint + tint * (c / light if light else 1) for c in base.factor)

    def _write_specular(self, specular, tint=(1, 1, 1)):
        """Principled's reflectance at normal incidence is 0.08 times Specular; glTF's is 0.04 times a colour."""
        self._known(specular, "Specular")
        strength = 2 * specular.factor[0]
        colour = [strength * factor for factor in tint]
        if colour == [1, 1, 1] and not specular.image:
            return
        extension = {"specularFactor": 0} if strength == 0 else {"specularColorFactor": colour}
        if specular.image:
            info = self._texture((*[(specular.image.image, specular.channel)] * 3, None), True, specular.image)
            if info:
                extension["specularColorTexture"] = info
        self.file.use("KHR_materials_specular")
        self.entry.setdefault("extensions", {})["KHR_materials_specular"] = extension

    def _write_emission(self, colour_socket, strength_socket):
        colour, strength = colour_of(colour_socket), number_of(strength_socket)
        if strength.image or strength.colours is not None or strength.unknown or colour.colours is not None:
            self.leave_out("Emission that varies over the surface otherwise than by one image")
        self._known(colour, "Emission")
        light = [c * strength.factor[0] for c in colour.factor]
        most = max(light)
        if most <= 0:
            return
        if most > 1:
            light = [c / most for c in light]
            self.file.use("KHR_materials_emissive_strength")
            self.entry.setdefault("extensions", {})["KHR_materials_emissive_strength"] = {"emissiveStrength": most}
        self.entry["emissiveFactor"] = light
        if colour.image:
            info = self._texture((*((colour.image.image, k) for k in range(3)), None), True, colour.image)
            if info:
                self.entry["emissiveTexture"] = info

    def _write_normal(self, shader):
        feeding = source(shader.inputs["Normal"])
        if feeding is None:
            return
        node = feeding.node
        map_of = colour_of(node.inputs["Color"]) if node.type == "NORMAL_MAP" else None
        if map_of is None or node.space != "TANGENT" or not map_of.image or map_of.factor != (1, 1, 1):
            self.leave_out("Normal: node %s" % node.bl_label)
            return
        if node.uv_map and placement(map_of.image)[0] != node.uv_map:
            self.leave_out("Normal: tangents of another UV map than its image's")
        info = self._texture((*((map_of.image.image, k) for k in range(3)), None), False, map_of.image)
        if info:
            info["scale"] = node.inputs["Strength"].default_value
            self.entry["normalTexture"] = info


def unit(values):
    return [min(max(v, 0), 1) for v in values]
