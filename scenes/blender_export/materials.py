"""Materials of a glTF document from Blender's: Principled, Diffuse and Emission, sums of these (glow.py), panes of glass
(glass.py), and the viewport's where a material has no nodes.

Opacity counts as in Cycles, whatever a material's blend mode is. The shader is read as the depsgraph evaluated it:
drivers and keys have their values of the frame.
"""

from dataclasses import dataclass, field, replace

import numpy

from . import glass, glow, versions
from .coordinates import coordinates_of
from .differences import differences, node_differences
from .node_values import Reader, Value, link_of, source, surface_of
from .pictures import ONE
from .texels import Lookup, border_matrix

WRAPS = {"REPEAT": 10497, "EXTEND": 33071, "CLIP": 33071}
TRANSMISSION = "KHR_materials_transmission"
NOTHING = (0.8, 0.8, 0.8)  # albedo of Cycles where there is no material
# Of all materials of a kind, in one entry.
LOBES = "Principled BSDF: its lobes are those of glTF; where they are rough, light differs from Cycles by up to a tenth"
NORMALS = ("Normal Map: Cycles darkens what is lit from the side, where the map turns the normal to the light, and bends steep "
           "normals to the view, which makes light brighter or darker")
SHARED = (LOBES, NORMALS, glass.BEHIND)
SHADERS = ("BSDF_PRINCIPLED", "BSDF_DIFFUSE", "EMISSION")
EMITTING = ("BSDF_PRINCIPLED", "EMISSION")
UNEVEN = "Emission that varies over the surface otherwise than by one image"


@dataclass
class Look:
    """What meshes need to know of a material."""
    number: object = None                      # in the document
    maps: list = field(default_factory=list)   # Coordinates by TEXCOORD
    tint: object = None                        # name of the colours of the mesh, "" for the active ones; None: none
    fade: object = None                        # name of those whose alpha is the opacity
    passes: bool = False                       # whether rays go straight on through it, in Cycles, too


class Materials:
    """Writes each material once. panes: whether light passes glass; else glass stops it, and is named."""

    def __init__(self, file, pictures, report, panes=True):
        self.panes = panes
        self.file = file
        self.pictures = pictures
        self.report = report
        self.known = {}
        self.has_glass = False  # that refracts in Cycles

    def find(self, material):
        """The look of a material, or of none."""
        name = material.name_full if material else None
        if name not in self.known:
            writer = MaterialWriter(self.file, self.pictures, self.report, material, self.panes)
            self.known[name] = writer.write() if material else writer.write_nothing()
            self.has_glass |= writer.is_glass
        return self.known[name]


class MaterialWriter:
    """One material on its way into the document."""

    def __init__(self, file, pictures, report, material, panes):
        self.panes = panes
        self.file = file
        self.pictures = pictures
        self.report = report
        self.material = material
        self.is_glass = False  # that refracts in Cycles
        self.reader = Reader()
        self.look = Look()
        self.entry = {"name": material.name if material else "no material", "doubleSided": True}

    def write(self):
        layers = self._layers()
        shader = layers.shader
        if layers.pane:
            self._write_pane(layers.pane)
        elif shader is None:
            pass  # its plain look is written
        elif shader.type == "BSDF_PRINCIPLED":
            self._write_principled(shader, layers.scale)
        elif shader.type == "BSDF_DIFFUSE":
            self._write_base(scaled(self.reader.value(shader.inputs["Color"]), layers.scale), Value((1,)))
            self._write_gloss(Value((0,)), Value((1,)))
            self._write_specular(Value((0,)))
            self._write_normal(shader)
        else:
            self._write_plain((0, 0, 0))
        if shader:
            self._write_emission(shader, layers)
        if layers.cover < 1:
            self._write_opacity(layers.cover * self.entry["pbrMetallicRoughness"]["baseColorFactor"][3])
        for remark in layers.remarks:
            self.is_glass |= remark == glass.STRAIGHT
            if remark in SHARED:
                self.report.share(remark, self.material.name)
            else:
                self.leave_out(remark)
        for text in differences(self.material):
            self.leave_out(text)
        for node in self.reader.seen.values():
            for text in node_differences(node):
                self.leave_out(text)
        self.look.passes = not self.is_glass and (self.entry.get("alphaMode") == "BLEND" or
                                                  TRANSMISSION in self.entry.get("extensions", ()))
        self.look.number = self.file.add("materials", self.entry)
        return self.look

    def write_nothing(self):
        self._write_plain(NOTHING)
        self.look.number = self.file.add("materials", self.entry)
        return self.look

    def leave_out(self, what):
        self.report.add("material %s: %s" % (self.material.name, what))

    def _layers(self):
        """What is written, as glass.py has it; no shader and no pane if a plain look was written in its place."""
        plain = glass.Layers()
        if not self.material.use_nodes:
            self._write_plain(self.material.diffuse_color)
            self._within(self.material.diffuse_color[:3], "Base Color")
            return plain
        socket, output = surface_of(self.material)
        if output:
            self.reader.see(output)
        if socket is None:
            self._write_plain((0, 0, 0))  # as in Cycles
            if output and link_of(output.inputs["Volume"]):
                self._write_opacity(0)
            return plain
        layers = glass.layers_of(socket.node, self.reader)
        refracts = layers and glass.STRAIGHT in layers.remarks
        if layers and (self.panes or not refracts) and (
                layers.pane or layers.shader.type in SHADERS and glow.fits(layers, self.reader)):
            for node in (*layers.nodes, *filter(None, (layers.shader,))):
                self.reader.see(node)
            return layers
        self.leave_out(socket.node.bl_label + "; the viewport's colour is in its place")
        self._write_plain(self.material.diffuse_color)
        return plain

    def _write_plain(self, colour):
        """A Lambertian surface."""
        self.entry["pbrMetallicRoughness"] = {"baseColorFactor": [*unit(colour[:3]), 1], "metallicFactor": 0}
        self._write_specular(Value((0,)))

    def _write_opacity(self, opacity):
        self.entry["pbrMetallicRoughness"]["baseColorFactor"][3] = opacity
        self.entry["alphaMode"] = "BLEND"

    def _write_principled(self, shader, scale):
        """scale: share of its light, but for what it emits."""
        value, inputs = self.reader.value, shader.inputs
        base = value(inputs["Base Color"])
        self._write_base(scaled(base, scale), value(inputs["Alpha"]))
        self._write_gloss(value(inputs["Metallic"]), value(inputs["Roughness"]))
        self._write_specular(self._specular_of(shader), self._tint_of(shader, base), scale)
        if glass.transmits(shader, self.reader):
            self.leave_out(glass.STRAIGHT)
            self.is_glass = True
            if self.panes:
                self._write_transmission(value(versions.principled_input(shader, "Transmission")))
        self._write_normal(shader)
        self.report.share(LOBES, self.material.name)

    def _write_pane(self, pane):
        self._write_base(pane.colour, Value((1,)))
        self._write_gloss(Value((0,)), pane.roughness)
        self._write_transmission(Value((1,)))
        if pane.constant:
            # A reflectance of 1 at normal incidence, times the share.
            self._extend("KHR_materials_specular", {"specularFactor": pane.constant,
                                                    "specularColorFactor": [1 / glass.STANDARD_REFLECTANCE] * 3})
        elif not pane.specular:
            self._write_specular(Value((0,)))
        elif pane.index is None:
            self.leave_out("IOR: more than a number")
        else:
            self._extend("KHR_materials_ior", {"ior": max(pane.index, 1 / max(pane.index, 1e-3))})

    def _write_transmission(self, value):
        self._known(value, "Transmission")
        if value.colours is not None:
            self.leave_out("Transmission: colours %s" % (value.colours or "of the mesh"))
        extension = {"transmissionFactor": unit(value.factor)[0]}
        if value.image:
            info = self._texture(((value.image, value.channel), None, None, None), False, value.image)
            if info:
                extension["transmissionTexture"] = info
        self._extend(TRANSMISSION, extension)

    def _extend(self, name, extension):
        self.file.use(name)
        self.entry.setdefault("extensions", {})[name] = extension

    def _specular_of(self, shader):
        value = self.reader.value(versions.principled_input(shader, "Specular"))
        self._within(value.factor, "Specular")
        if self.panes and not versions.has_own_index(shader) and glass.transmits(shader, self.reader):
            return self._specular_of_glass(shader, value)
        if versions.has_own_index(shader) and source(shader.inputs["IOR"]):
            self.leave_out("IOR: node %s" % source(shader.inputs["IOR"]).node.bl_label)
        scale = versions.specular_scale(shader)
        return value if scale == 1 else replace(value, factor=(value.factor[0] * scale,))

    def _specular_of_glass(self, shader, opaque):
        """What Principled of 3.4 mirrors: glass by its index of refraction, the rest by Specular."""
        share = unit(self.reader.value(versions.principled_input(shader, "Transmission")).factor)[0]
        index = glass.index_of(shader, self.reader)
        if index is None:
            self.leave_out("IOR: more than a number")
            return opaque
        of_glass = glass.reflectance(index) / (2 * glass.STANDARD_REFLECTANCE)
        if share < 1 and opaque.image:
            self.leave_out("Specular: an image, beside Transmission")
        return Value(((1 - share) * opaque.factor[0] + share * of_glass,))

    def _known(self, value, socket):
        if value.unknown:
            self.leave_out("%s: node %s" % (socket, value.unknown))
        return value

    def _within(self, numbers, socket):
        """Names what glTF clamps."""
        if list(numbers) != unit(numbers):
            self.leave_out("%s below 0 or above 1" % socket)

    def _place(self, node):
        """Coordinates of an image node's texels, and the name of a node that cannot be expressed, or None."""
        where, unknown = coordinates_of(node, self.reader)
        return where.then(border_matrix(node.image, Lookup.of(node))), unknown

    def _texture(self, channels, colour, node, change=None):
        """A textureInfo of channels (see Pictures) at an image node's place; None if it cannot be had."""
        for text in differences(node.image):
            self.report.add("image %s: %s" % (node.image.name, text))
        picture = self.pictures.write(channels, colour, change)
        if picture is None:
            return None
        where, unknown = self._place(node)
        if unknown:
            self.report.add("image %s: placed by %s" % (node.image.name, unknown))
        if where not in self.look.maps:
            self.look.maps.append(where)
        nearest = node.interpolation == "Closest"
        wrap = WRAPS.get(node.extension, 10497)
        sampler = self.file.add("samplers", {"magFilter": 9728 if nearest else 9729,
                                             "minFilter": 9728 if nearest else 9987, "wrapS": wrap, "wrapT": wrap})
        return {"index": self.file.add("textures", {"source": picture, "sampler": sampler}),
                "texCoord": self.look.maps.index(where)}

    def _beside(self, value, other, socket):
        """Whether the images of two values can be channels of one texture."""
        if not (value.image and other.image) or value.image == other.image:
            return True
        if self._place(value.image) == self._place(other.image) and value.image.extension == other.image.extension:
            return True
        self.leave_out("%s: its image is placed otherwise" % socket)
        return False

    def _write_base(self, colour, alpha):
        self._known(colour, "Base Color")
        self._known(alpha, "Alpha")
        if not self._beside(colour, alpha, "Alpha"):
            alpha = Value(alpha.factor)
        solid = alpha.image is None and alpha.colours is None and alpha.factor[0] >= 1
        self.look.tint, self.look.fade = colour.colours, alpha.colours
        self._within(colour.factor, "Base Color")
        pbr = self.entry["pbrMetallicRoughness"] = {"baseColorFactor": [*unit(colour.factor), 1]}
        if not solid:
            self._write_opacity(unit(alpha.factor)[0])
            if versions.setting_of(self.material, "use_transparent_shadow") is False:
                self.leave_out("Alpha: Transparent Shadows is off; here shadows have its holes")
        if colour.image or alpha.image:
            rgb = rgb_of(colour) if colour.image else (ONE,) * 3
            opacity = (alpha.image, alpha.channel) if alpha.image else (None if solid else ONE)
            info = self._texture((*rgb, opacity), True, colour.image or alpha.image)
            if info:
                pbr["baseColorTexture"] = info

    def _write_gloss(self, metallic, roughness):
        self._known(metallic, "Metallic")
        self._known(roughness, "Roughness")
        for value, socket in ((metallic, "Metallic"), (roughness, "Roughness")):
            self._within(value.factor, socket)
            if value.colours is not None:
                self.leave_out("%s: colours %s" % (socket, value.colours or "of the mesh"))
        if not self._beside(roughness, metallic, "Metallic"):
            metallic = Value(metallic.factor)
        pbr = self.entry["pbrMetallicRoughness"]
        pbr["metallicFactor"], pbr["roughnessFactor"] = unit(metallic.factor)[0], unit(roughness.factor)[0]

        def channel(value):
            if value.image:
                return value.image, value.channel
            return ONE if value.factor[0] else None

        if metallic.image or roughness.image:
            info = self._texture((None, channel(roughness), channel(metallic), None), False,
                                 roughness.image or metallic.image)
            if info:
                pbr["metallicRoughnessTexture"] = info

    def _tint_of(self, shader, base):
        """Factors of Principled's reflectance: a share of the base's hue; from 4.0 on a colour."""
        socket, none = shader.inputs["Specular Tint"], (1, 1, 1)
        tint = self.reader.value(socket)
        if tint.image or tint.colours is not None or tint.unknown:
            self.leave_out("Specular Tint")
            return none
        if versions.has_own_index(shader):
            return tuple(tint.factor)
        share = tint.factor[0]
        if not share:
            return none
        if base.image or base.colours is not None:
            self.leave_out("Specular Tint")
            return none
        light = 0.2126 * base.factor[0] + 0.7152 * base.factor[1] + 0.0722 * base.factor[2]
        return tuple(1 - share + share * (c / light if light else 1) for c in base.factor)

    def _write_specular(self, specular, tint=(1, 1, 1), scale=1):
        """Principled's reflectance at normal incidence is 0.08 times Specular; glTF's is 0.04 times a colour. scale: share
        of what is mirrored, from all sides alike."""
        self._known(specular, "Specular")
        if specular.colours is not None:
            self.leave_out("Specular: colours %s" % (specular.colours or "of the mesh"))
        strength = 2 * specular.factor[0]
        colour = [strength * factor for factor in tint]
        if colour == [1, 1, 1] and not specular.image and scale == 1:
            return
        extension = {"specularFactor": 0} if strength == 0 else {"specularColorFactor": colour}
        if strength and scale != 1:
            extension["specularFactor"] = scale
        if specular.image:
            info = self._texture((*[(specular.image, specular.channel)] * 3, None), True, specular.image)
            if info:
                extension["specularColorTexture"] = info
        self._extend("KHR_materials_specular", extension)

    def _emission_of(self, colour_socket, strength_socket, share):
        """A share of an emission: its colour times its strength."""
        colour, strength = self.reader.value(colour_socket), self.reader.value(strength_socket)
        if strength.image or strength.colours is not None or strength.unknown or colour.colours is not None:
            self.leave_out(UNEVEN)
        self._known(colour, "Emission")
        light = scaled(colour, share * strength.factor[0])
        if min(light.factor) < 0:
            self.leave_out("Emission below 0")
            return replace(light, factor=tuple(max(c, 0) for c in light.factor))
        return light

    def _write_emission(self, shader, layers):
        """Of a shader, and of what shines beside it."""
        parts = [(shader, layers.scale)] if shader.type in EMITTING else []
        parts += [(one.node, one.share / layers.cover) for one in layers.glows]
        lights = [self._emission_of(*glow.emission_sockets(node), share) for node, share in parts]
        lights = [light for light in lights if any(light.factor)]
        pictures = [light for light in lights if light.image]
        if pictures and len(lights) > 1:
            self.leave_out(UNEVEN)
            lights = pictures[:1]
        light = [sum(numbers) for numbers in zip((0, 0, 0), *(light.factor for light in lights))]
        most = max(light)
        if most <= 0:
            return
        if most > 1:
            light = [c / most for c in light]
            self._extend("KHR_materials_emissive_strength", {"emissiveStrength": most})
        self.entry["emissiveFactor"] = light
        if pictures:
            info = self._texture((*rgb_of(pictures[0]), None), True, pictures[0].image)
            if info:
                self.entry["emissiveTexture"] = info

    def _write_normal(self, shader):
        feeding = source(shader.inputs["Normal"])
        if feeding is None:
            return
        node = feeding.node
        map_of = self.reader.value(node.inputs["Color"]) if node.type == "NORMAL_MAP" else None
        if map_of is None or node.space != "TANGENT" or map_of.factor != (1, 1, 1) or link_of(node.inputs["Strength"]):
            self.leave_out("Normal: node %s" % node.bl_label)
            return
        if not map_of.image or map_of.channel is not None or map_of.colours is not None:
            self.leave_out("Normal: node %s without an image" % node.bl_label)
            return
        self.reader.see(node)
        where, _ = self._place(map_of.image)
        if where.turns() or node.uv_map and where.name != node.uv_map:
            self.leave_out("Normal: tangents of another map than its image's")
        strength = max(node.inputs["Strength"].default_value, 0)
        change = ("strength %g" % strength, lambda pixels: mixed_normals(pixels, strength)) if strength != 1 else None
        info = self._texture((*rgb_of(map_of), None), False, map_of.image, change)
        if info:
            self.entry["normalTexture"] = info
            self.report.share(NORMALS, self.material.name)


def mixed_normals(pixels, strength):
    """Normals of a map as Cycles mixes them with the surface's; glTF's scale makes another thing of them."""
    normals = 2 * pixels - 1
    normals /= numpy.maximum(numpy.linalg.norm(normals, axis=-1, keepdims=True), 1e-6)
    normals = strength * normals + (1 - strength) * numpy.array((0, 0, 1), numpy.float32)
    normals /= numpy.maximum(numpy.linalg.norm(normals, axis=-1, keepdims=True), 1e-6)
    return normals / 2 + 0.5


def scaled(value, share):
    return value if share == 1 else replace(value, factor=tuple(share * number for number in value.factor))


def rgb_of(value):
    """Channels of a picture with the colour of a value that has an image; greys have one channel thrice."""
    return tuple((value.image, k if value.channel is None else value.channel) for k in range(3))


def unit(values):
    return [min(max(v, 0), 1) for v in values]
