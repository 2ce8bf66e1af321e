"""The help and the stub name everything, and the options are those of the programs, at both ends of their ranges."""
import ast
import json
import re
import subprocess

import pytest

import shadowcache
from small_set import BUILD


def test_everything_has_help():
    for name, thing in vars(shadowcache).items():
        if name.startswith("_"):
            continue
        assert thing.__doc__, name
        for member, value in vars(thing).items() if isinstance(thing, type) else ():
            if not member.startswith("_"):
                assert value.__doc__, f"{name}.{member}"
    assert "load_set" in shadowcache.__doc__


def test_help_has_all_aovs(scene, white, camera):
    with pytest.raises(shadowcache.Error) as error:
        shadowcache.render(scene, None, white, camera, aovs=["nothing"])
    names = str(error.value).split("expected one of ")[1].split(", ")
    assert len(names) > 20 and set(names) <= set(re.findall(r"\w+", shadowcache.render.__doc__))


def test_repr(scene, cache, white, camera):
    assert repr(scene) == "<shadowcache.Scene: 4 triangles, 4 x 1 x 4 m>"
    assert re.fullmatch(r"<shadowcache.Cache: \d+ items, spacing 0.25 m, in memory>", repr(cache))
    assert repr(white) == "<shadowcache.Environment: constant, 1 x 1, rotated by 0 degrees>"
    assert repr(camera).startswith("<shadowcache.Camera: at (3, 2, 4), along (-0.")
    assert cache.path is None and cache.nbytes > 0 and cache.header["level"] == 3


def test_stub_names_everything():
    stub = ast.parse((BUILD / "python/shadowcache.pyi").read_text(encoding="utf-8"))

    def names(body):
        return {node.name for node in body if isinstance(node, (ast.FunctionDef, ast.ClassDef))
                and not node.name.startswith("_")}

    def public(thing):
        return {name for name in vars(thing) if not name.startswith("_")}

    assert names(stub.body) == public(shadowcache)
    for node in stub.body:
        if isinstance(node, ast.ClassDef) and node.name != "Error":
            assert names(node.body) == public(getattr(shadowcache, node.name)), node.name


def table(program):
    """Options of a program as it prints them, by their names in Python."""
    rows = json.loads(subprocess.run([BUILD / program, "--options"], capture_output=True, check=True).stdout)
    return {row["python"]: row for row in rows if "python" in row}


def keywords_of(name):
    """Keyword arguments of a function of the stub."""
    stub = ast.parse((BUILD / "python/shadowcache.pyi").read_text(encoding="utf-8"))
    found = next(node for node in stub.body if isinstance(node, ast.FunctionDef) and node.name == name)
    return {argument.arg for argument in found.args.kwonlyargs} - {"frame", "progress", "threads"}


def test_options_are_those_of_the_table(scene, cache, white, camera):
    """The stub names options of the table, the help of the call tells them, and no other is taken."""
    for call, program in (("render", "render/shadowcache-render"), ("load_set", "render/shadowcache-render"),
                          ("bake", "bake/shadowcache-bake")):
        names = keywords_of(call) - {"colors", "normals", "cameras"}
        assert names <= set(table(program)), names
        for name in names:
            assert "\n%s: " % name in getattr(shadowcache, call).__doc__, name
    with pytest.raises(TypeError, match="unexpected keyword argument 'sampels', did you mean samples"):
        shadowcache.render(scene, cache, white, camera, sampels=1)


def test_ends_of_ranges(scene, cache, white, camera):
    """Each number of render() is taken at both ends of its range; what is beyond is refused under its name."""
    rows = table("render/shadowcache-render")
    walked = 0
    for name in sorted(keywords_of("render")):
        row = rows[name]
        if "range" not in row or row["range"][1] is None or name == "seed":
            continue
        least, most = row["range"]
        whole = row["form"] == "whole"
        for value in (least, most):
            # Refused, but for the threads: that is found out last.
            with pytest.raises(shadowcache.Error, match="^threads -1"):
                shadowcache.render(scene, cache, white, camera, threads=-1, **{name: int(value) if whole else value})
        for value in (least - 1, most + max(1, most * 0.01)):
            with pytest.raises(shadowcache.Error, match="^%s .*expected" % name):
                shadowcache.render(scene, cache, white, camera, **{name: int(value) if whole else value})
        with pytest.raises(TypeError, match="^%s: expected a (whole )?number" % name):
            shadowcache.render(scene, cache, white, camera, **{name: [1, 2]})
        walked += 1
    assert walked >= 7
