"""Each option that the tables have for Python is taken by a call, and does what the programs' option does."""
import ast
import json

import numpy as np
import pytest

import shadowcache
from small_set import BUILD, MAP, run


def rows_of(program):
    """Options of a program that Python has, by their names there."""
    return {row["python"]: row for row in json.loads(run(program, "--options")) if "python" in row}


# What takes an option that load_set(), render() and bake() do not. A tuple has no value to be refused.
ELSEWHERE = {
    "set": None, "cache": None,  # positional
    "memory": lambda given, c: shadowcache.Cache.open(c.folder / "none.vdb", memory=given),
    "rotate": lambda given, c: shadowcache.Environment.load(MAP, rotate=given),
    "gain": lambda given, c: shadowcache.Environment.load(MAP, gain=given),
    "name": lambda given, c: c.scene.camera(name=given),
    "shutter": lambda given, c: shadowcache.Camera.load(c.camera, shutter=given),
    "eye": lambda given, c: shadowcache.Camera(eye=given, look_at=(0, 0, 0)),
    "look_at": lambda given, c: shadowcache.Camera(eye=(0, 0, 0), look_at=given),
    "fov": lambda given, c: shadowcache.Camera((0, 0, 1), (0, 0, 0), fov=given),
    "fps": lambda given, c: c.scene.camera("1", fps=given),
}


def keywords_of_stub():
    """Keyword arguments of each call of the stub."""
    stub = ast.parse((BUILD / "python/shadowcache.pyi").read_text(encoding="utf-8"))
    return {node.name: {argument.arg for argument in node.args.args + node.args.kwonlyargs}
            for node in ast.walk(stub) if isinstance(node, ast.FunctionDef)}


@pytest.mark.parametrize("program", ["render", "bake"])
def test_every_option_of_the_table_is_taken_by_a_call(small, white, program):
    """A thing that is no value is refused by the option's name, and not as an argument that is not known."""
    thing, camera = object(), shadowcache.Camera.load(small.camera)
    cache = shadowcache.Cache.open(small.cache)
    calls = {
        "load_set": lambda **given: shadowcache.load_set(small.file, **given),
        "render": lambda **given: shadowcache.render(small.scene, cache, white, camera, **given),
        "bake": lambda **given: shadowcache.bake(small.scene, cameras=[camera], **given),
    }
    stub, rows, walked = keywords_of_stub(), rows_of(program), 0
    assert len(rows) > (30 if program == "render" else 8)
    for name in rows:
        taken = 0
        for call, use in calls.items():
            try:
                use(**{name: thing})
            except (TypeError, ValueError, shadowcache.Error) as error:
                if "unexpected keyword" in str(error):
                    continue
                assert name in str(error), (call, name, error)
                assert name in stub[call], f"{call}({name}=) is not in the stub"
                taken += 1
        if ELSEWHERE.get(name):
            with pytest.raises((TypeError, ValueError, shadowcache.Error)):
                ELSEWHERE[name](thing, small)
            assert any(name in arguments for arguments in stub.values()), f"{name} is not in the stub"
            taken += 1
        assert taken or name in ELSEWHERE, f"no call takes {name}"
        walked += 1
    with pytest.raises(TypeError, match="unexpected keyword"):  # the control
        calls["render"](nothing=thing)
    print(f"{walked} options of {program}")


# The light.

AXES = (20.0, 100, -30)
MIRROR = np.array([[0.0, 0, -1], [0, 1, 0], [1, 0, 0]]) * (1, 1, -1)


@pytest.mark.parametrize("rotate, gain", [(40, 1), (AXES, 0.5), (MIRROR, (0.2, 1, 3))])
def test_turn_and_gain_have_the_bits_of_the_program(small, sunrise, tmp_path, rotate, gain):
    sky = shadowcache.Environment.load(MAP, rotate=rotate, gain=gain)
    camera = shadowcache.Camera.load(small.camera, frame=9)
    mine = shadowcache.render(small.scene, None, sky, camera, frame=9, size=(32, 18), spp=2, bounces=1)["color"]
    run("render", small.file, "--env", MAP, "--env-rotate", ",".join(map(str, np.ravel(rotate))), "--env-gain", ",".join(map(str, np.ravel(gain))),
        "--camera", small.camera, "--frames", 9, "--size", "32x18", "--spp", 2, "--bounces", 1, "-o", tmp_path / "a.exr")
    assert np.array_equal(mine, shadowcache.read_exr(tmp_path / "a.exr")["color"])
    other = shadowcache.render(small.scene, None, sunrise, camera, frame=9, size=(32, 18), spp=2, bounces=1)["color"]
    assert not np.array_equal(mine, other)  # the control: as the file has it


def test_forms_of_a_turn_and_a_gain(sunrise):
    """Nine numbers in a row are three rows of three; a gain and a turn that are given are those of rotate() and tint()."""
    row = sunrise.rotate(MIRROR.ravel().tolist())
    assert np.array_equal(row.turn, sunrise.rotate(MIRROR).turn) and np.allclose(row.turn, MIRROR)
    both = shadowcache.Environment.load(MAP, rotate=MIRROR.ravel().tolist(), gain=(0.2, 1, 3))
    assert np.array_equal(both.turn, row.turn) and np.array_equal(both.integrate(), row.tint((0.2, 1, 3)).integrate())
    assert not np.array_equal(both.integrate(), row.integrate())  # the control: without the gain


def test_turns_are_turned_further(white):
    texels = np.random.default_rng(3).random((8, 16, 3))
    sky = shadowcache.Environment.from_array(texels, rotate=AXES)
    ways = np.random.default_rng(4).normal(size=(50, 3))
    plain = shadowcache.Environment.from_array(texels)
    assert np.allclose(sky.turn @ sky.turn.T, np.eye(3)) and sky.rotation == 0
    assert np.array_equal(sky.look_up(ways @ sky.turn.T)[0], plain.look_up(ways)[0])
    further = sky.rotate(30).rotate(MIRROR)
    wanted = MIRROR @ white.rotate(30).turn @ sky.turn
    assert np.allclose(further.turn, wanted) and np.linalg.det(further.turn) == pytest.approx(np.linalg.det(MIRROR))
    assert np.array_equal(further.look_up(ways @ further.turn.T)[0], plain.look_up(ways)[0])
    assert not np.array_equal(further.look_up(ways)[0], plain.look_up(ways)[0])  # the control
    dim = sky.tint((0.5, 1, 2)).tint(2)
    assert np.allclose(dim.integrate(), sky.integrate() * (1, 2, 4)) and np.array_equal(dim.turn, sky.turn)


def test_turned_and_dimmed_maps_are_pickled():
    import pickle
    sky = shadowcache.Environment.load(MAP, rotate=AXES, gain=(1, 0.5, 2)).rotate(10)
    again = pickle.loads(pickle.dumps(sky))
    assert np.array_equal(again.turn, sky.turn) and np.array_equal(again.integrate(), sky.integrate())
    assert np.array_equal(again.look_up((0.3, 1, 0.2))[0], sky.look_up((0.3, 1, 0.2))[0])


@pytest.mark.parametrize("call, kind, text", [
    (lambda sky: sky.rotate((1, 2)), TypeError, "^rotate: expected 1 or 3 or 9 numbers"),
    (lambda sky: sky.rotate(np.eye(3) * 2), shadowcache.Error, "^rotate .*: row 1 has the length 2, expected"),
    (lambda sky: sky.rotate(np.nan), ValueError, "^rotate: expected finite"),
    (lambda sky: sky.tint(-1), shadowcache.Error, "^gain"), (lambda sky: sky.tint((1, 2)), TypeError, "^gain: expected"),
    (lambda sky: sky.tint(2e6), shadowcache.Error, "^gain"), (lambda sky: sky.tint("bright"), TypeError, "^gain: dtype"),
])
def test_refused_light(white, call, kind, text):
    with pytest.raises(kind, match=text):
        call(white)


# The camera.

def test_shutter_has_the_bits_of_the_program(small, white, tmp_path):
    def render(camera):
        return shadowcache.render(small.scene, None, white, camera, frame=9, size=(48, 27),
                                  camera_rays=8, samples=1, bounces=0)["color"]

    mine = render(shadowcache.Camera.load(small.camera, frame=9, shutter=0.8))
    run("render", small.file, "--env", "1,1,1", "--camera", small.camera, "--frames", 9, "--size", "48x27", "--shutter", 0.8,
        "--camera-rays", 8, "--samples", 1, "--bounces", 0, "-o", tmp_path / "a.exr")
    assert np.array_equal(mine, shadowcache.read_exr(tmp_path / "a.exr")["color"])
    assert not np.array_equal(mine, render(shadowcache.Camera.load(small.camera, frame=9)))  # the control: it stands still
    with pytest.raises(shadowcache.Error, match="^shutter 2: expected 0 to 1"):
        shadowcache.Camera.load(small.camera, shutter=2)


def test_a_camera_that_moves():
    first, last = (shadowcache.Camera((x, 1, 4), (x, 1, 0), fov=f) for x, f in ((0, 30), (1, 50)))
    moving = shadowcache.Camera.moving(first, last)
    assert moving.origin.tolist() == [0.5, 1, 4] and moving.fov == pytest.approx(40) and repr(moving).endswith("moving>")
    with pytest.raises(shadowcache.Error, match="orthographic"):
        shadowcache.Camera.moving(first, shadowcache.Camera((0, 1, 4), (0, 1, 0), height=2))


# A bake for pictures.

@pytest.mark.parametrize("options, arguments", [
    ({}, []), ({"spacing": 0.25, "level": 2}, ["--spacing", 0.25, "--level", 2]), ({"quality": "draft"}, ["--quality", "draft"]),
    ({"level": 1, "margin": 2}, ["--level", 1, "--margin", 2])])
def test_bake_for_pictures_has_the_items_of_the_program(small, white, tmp_path, options, arguments):
    cameras = [shadowcache.Camera.load(small.camera, frame=frame) for frame in (2, 9)]
    mine = shadowcache.bake(small.scene, cameras=cameras, size=(24, 14), rays=1, **options)
    run("bake", small.file, "-o", tmp_path / "a.vdb", "--camera", small.camera, "--frames", "2,9", "--size", "24x14",
        "--rays", 1, *arguments)
    theirs = shadowcache.Cache.open(tmp_path / "a.vdb")
    assert mine.spacing == theirs.spacing and np.array_equal(mine.items(), theirs.items())
    whole = shadowcache.bake(small.scene, spacing=mine.spacing, level=mine.header["level"], rays=1)
    assert 0 < len(mine) <= len(whole) and ("spacing" not in options or len(mine) < len(whole))  # the control: all
    # It has what the pictures that it is for look up, and not what others do.
    def misses(camera):
        return np.nanmean(shadowcache.render(small.scene, mine, white, camera, size=(24, 14), spp=1, aovs=["misses"])["misses"])

    back = shadowcache.Camera(cameras[0].origin, cameras[0].origin - cameras[0].forward)
    assert misses(cameras[0]) < 0.05 and ("spacing" not in options or misses(back) > 0.3)
    mine.save(tmp_path / "b.vdb")
    assert np.array_equal(shadowcache.Cache.open(tmp_path / "b.vdb").items(), mine.items())


def test_refused_bakes_for_pictures(small):
    camera = shadowcache.Camera.load(small.camera)
    for kind, text, options in (
            (TypeError, "cameras: expected a list", {"cameras": camera}), (TypeError, "cameras: expected a list", {"cameras": [3]}),
            (ValueError, "cameras: expected one", {"cameras": []}), (TypeError, "size: expected with cameras", {"size": (3, 4)}),
            (TypeError, "margin: expected with cameras", {"margin": 1}),
            (shadowcache.Error, "^margin 65: expected 0 to 64", {"cameras": [camera], "margin": 65}),
            (shadowcache.Error, "^size", {"cameras": [camera], "size": (0, 4)})):
        with pytest.raises(kind, match=text):
            shadowcache.bake(small.scene, **options)


def test_one_form_of_a_name_for_each_row():
    """No two options have one name in Python, whatever the program."""
    for program in ("render", "bake"):
        names = [row["python"] for row in json.loads(run(program, "--options")) if "python" in row]
        assert len(names) == len(set(names)), names
