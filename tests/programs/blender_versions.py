"""What of Blender 4.2 can be tested without it: blender_versions.py SOURCE BUILD

The packed sources use nothing that Blender dropped from 3.4 to 4.2, but for one file that asks what is there; that file reads
stand-ins with the names of both. The manifest has the fields that Blender documents for extensions. Exit status 77 without
numpy, unless SHADOWCACHE_NO_SKIP is set.
"""
import ast
import importlib
import os
import re
import sys
import tempfile
import types
import zipfile
from pathlib import Path

SOURCE, BUILD = (Path(word) for word in sys.argv[1:3])
ASKS = "shadowcache/blender_export/versions.py"
# Of the release notes of 4.0, 4.1 and 4.2.
ATTRIBUTES = {"use_auto_smooth", "auto_smooth_angle", "calc_normals", "calc_normals_split", "create_normals_split",
              "free_normals_split", "shadow_method", "face_maps", "bevel_weight", "crease", "edge_creases",
              "vertex_creases", "bone_groups"}
OF_CYCLES = {"use_transparent_shadow", "displacement_method"}  # are in the material
MODULES = {"bgl"}
SHADERS = re.compile("[23]D_(UNIFORM|FLAT|SMOOTH|IMAGE|POLYLINE)")
SOCKETS = {"Specular", "Emission", "Subsurface", "Sheen", "Clearcoat", "Transmission"}
# Of a manifest. [Blender's manual: How to Create Extensions]
REQUIRED = {"schema_version", "id", "version", "name", "tagline", "maintainer", "type", "blender_version_min", "license"}
OPTIONAL = {"blender_version_max", "website", "copyright", "tags", "platforms", "wheels", "permissions", "build"}
PERMISSIONS = {"files", "network", "clipboard", "camera", "microphone"}
MOST_LETTERS = 64


def dropped(text):
    """What a source uses that 4.2 does not have."""
    found = set()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Attribute):
            if node.attr in ATTRIBUTES:
                found.add(node.attr)
            if node.attr in OF_CYCLES and isinstance(node.value, ast.Attribute) and node.value.attr == "cycles":
                found.add(node.attr)
            if node.attr == "new" and isinstance(node.value, ast.Attribute) and node.value.attr in ("inputs", "outputs"):
                found.add(node.value.attr + ".new")
        elif isinstance(node, (ast.Import, ast.ImportFrom)):
            names = [node.module] if isinstance(node, ast.ImportFrom) else [a.name for a in node.names]
            found |= MODULES.intersection(names)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and SHADERS.match(node.value):
            found.add(node.value)
        elif isinstance(node, ast.Subscript) and isinstance(node.slice, ast.Constant) and node.slice.value in SOCKETS:
            if getattr(node.value, "attr", getattr(node.value, "id", "")) == "inputs":
                found.add(node.slice.value)
    return found


def absolute(text):
    """Imports that name the add-on itself: an extension has another name."""
    return [node.lineno for node in ast.walk(ast.parse(text))
            if isinstance(node, ast.ImportFrom) and node.level == 0 and (node.module or "").startswith("shadowcache")
            or isinstance(node, ast.Import) and any(a.name.startswith("shadowcache") for a in node.names)]


def sources(archive):
    for name, text in archive.items():
        if name.endswith(".py"):
            assert not absolute(text), "%s: names the add-on in an import" % name
            if name != ASKS:
                assert not dropped(text), "%s: %s are not in Blender 4.2" % (name, sorted(dropped(text)))
    for text, wanted in (("mesh.calc_normals_split()", "calc_normals_split"), ("import bgl", "bgl"),
                         ("tree.inputs.new('a', 'b')", "inputs.new"), ("shader.inputs['Emission']", "Emission"),
                         ("material.cycles.use_transparent_shadow", "use_transparent_shadow"),
                         ("gpu.shader.from_builtin('2D_UNIFORM_COLOR')", "2D_UNIFORM_COLOR")):
        assert dropped(text) == {wanted}, "control: %s" % text
    assert absolute("from shadowcache.exr import write") and not absolute("from .exr import write"), "control"


class Items(list):
    """A collection of Blender's, read as numpy has it."""

    def foreach_get(self, name, values):
        values[:] = [number for item in self for number in item[name]]


class Sockets(dict):
    def new(self, kind, name):
        self[name] = types.SimpleNamespace(kind=kind)
        return self[name]


def shader(**inputs):
    values = {name.replace("_", " "): types.SimpleNamespace(default_value=value) for name, value in inputs.items()}
    return types.SimpleNamespace(inputs=values)


def stand_ins(versions):
    """The same by the names of 3.4 and by those of 4.2."""
    old = shader(Specular=0.3, Emission=(1, 0, 0, 1), IOR=1.45)
    new = shader(Specular_IOR_Level=0.3, Emission_Color=(1, 0, 0, 1), IOR=1.8)
    for name in ("Specular", "Emission"):
        assert versions.principled_input(old, name).default_value == versions.principled_input(new, name).default_value
    assert versions.specular_scale(old) == 1 == versions.specular_scale(shader(Specular_IOR_Level=0.3, IOR=1.5))
    # The reflectance of glass of that index is (0.8 / 2.8)^2, of 1.5 it is 0.04.
    assert abs(versions.specular_scale(new) - (0.8 / 2.8) ** 2 / 0.04) < 1e-9

    corners = [{"normal": (0, 0, 1), "vector": (0, 0, 1)}, {"normal": (0, 1, 0), "vector": (0, 1, 0)}]
    calls = []
    split = types.SimpleNamespace(use_auto_smooth=True, auto_smooth_angle=0.5, loops=Items(corners),
                                  calc_normals_split=lambda: calls.append(1))
    domain = types.SimpleNamespace(normals_domain="CORNER", corner_normals=Items(corners))
    assert versions.corner_normals(split).tolist() == versions.corner_normals(domain).tolist() == [[0, 0, 1], [0, 1, 0]]
    assert calls and (versions.smooth_angle(split), versions.smooth_angle(domain)) == (0.5, 0)
    split.use_auto_smooth, domain.normals_domain = False, "POINT"
    assert versions.corner_normals(split) is None and versions.corner_normals(domain) is None

    cycles = types.SimpleNamespace(use_transparent_shadow=False)
    for material in (types.SimpleNamespace(cycles=cycles), types.SimpleNamespace(use_transparent_shadow=False, cycles=None)):
        assert versions.setting_of(material, "use_transparent_shadow") is False
    assert versions.setting_of(types.SimpleNamespace(), "use_transparent_shadow") is None

    assert versions.falloff_of_spots((3, 6, 5)) != versions.falloff_of_spots((4, 0, 0))

    sockets = Sockets()
    versions.add_socket(types.SimpleNamespace(inputs=Sockets(), outputs=sockets), "NodeSocketColor", "Image", is_output=True)
    made = []
    interface = types.SimpleNamespace(new_socket=lambda name, **how: made.append((name, how)))
    versions.add_socket(types.SimpleNamespace(interface=interface), "NodeSocketColor", "Image", is_output=True)
    assert list(sockets) == ["Image"] and made == [("Image", {"in_out": "OUTPUT", "socket_type": "NodeSocketColor"})]


def faults(manifest):
    """What Blender's documentation does not allow of a manifest."""
    found = ["%s is missing" % key for key in REQUIRED - set(manifest)]
    found += ["%s is unknown" % key for key in set(manifest) - REQUIRED - OPTIONAL]
    checks = {"schema_version": r"1\.0\.0", "id": "[a-z][a-z0-9_]*", "version": r"\d+\.\d+\.\d+([-+].+)?", "type": "add-on|theme",
              "blender_version_min": r"(4\.[2-9]|[5-9]\.\d+)\.\d+", "tagline": ".{1,%d}" % MOST_LETTERS}
    found += ["%s is %s" % (key, manifest[key]) for key, words in checks.items()
              if key in manifest and not re.fullmatch(words, manifest[key])]
    texts = {"tagline": manifest.get("tagline", "a"), **manifest.get("permissions", {})}
    for key, text in texts.items():
        if not text or len(text) > MOST_LETTERS or not (text[-1].isalnum() or text[-1] in ")]}"):
            found.append("%s: %d letters, or ends in punctuation" % (key, len(text)))
    found += ["permission %s" % key for key in set(manifest.get("permissions", {})) - PERMISSIONS]
    found += ["license %s" % text for text in manifest.get("license", [""]) if not re.fullmatch("SPDX:[A-Za-z0-9.+-]+", text)]
    return found


def manifests(archive):
    import tomllib
    text = archive["shadowcache/blender_manifest.toml"]
    manifest = tomllib.loads(text)
    assert not faults(manifest), faults(manifest)
    version = re.search(r'"version": \((\d+), (\d+), (\d+)\)', archive["shadowcache/__init__.py"])
    assert manifest["version"] == ".".join(version.groups()), "bl_info has another version"
    assert manifest["license"] == ["SPDX:GPL-3.0-or-later"]
    assert "shadowcache/LICENSE" in archive
    for change in ({"tagline": "It ends so."}, {"tagline": 65 * "a"}, {"id": "Shadow Cache"}, {"license": ["GPL"]},
                   {"permissions": {"disk": "All"}}, {"colour": "red"}, {"blender_version_min": "3.4.0"}):
        assert faults({**manifest, **change}), "control: %s" % change
    assert faults({key: value for key, value in manifest.items() if key != "license"}), "control: no license"


def main():
    try:
        import numpy  # noqa: F401
    except ImportError:
        print("needs numpy (Debian package: python3-numpy)")
        sys.exit(1 if os.environ.get("SHADOWCACHE_NO_SKIP") else 77)
    with zipfile.ZipFile(BUILD / "shadowcache-blender.zip") as packed:
        archive = {name: packed.read(name).decode() for name in packed.namelist()}
    sources(archive)
    with tempfile.TemporaryDirectory() as folder:
        package = Path(folder) / "exporter"
        package.mkdir()
        (package / "__init__.py").write_text("")
        for name in ("versions", "triangles"):
            (package / (name + ".py")).write_text(archive["shadowcache/blender_export/%s.py" % name])
        sys.path.insert(0, folder)
        sys.dont_write_bytecode = True
        stand_ins(importlib.import_module("exporter.versions"))
    manifests(archive)


main()
