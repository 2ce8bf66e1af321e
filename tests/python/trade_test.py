"""shadowcache_trade: errors as the renderer measures them, the knee, a whole run on a tiny set, refusals, Ctrl-C.

Needs SHADOWCACHE_BUILD, the folder of a build, and SHADOWCACHE_SOURCE, that of the sources.
"""
import io
import json
import os
import shlex
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import shadowcache
from shadowcache_trade import __main__ as program
from shadowcache_trade import cycles
from shadowcache_trade.cycles import SAMPLES, Rival, obstacle, rival_of
from shadowcache_trade.cycles import render as render_in_cycles
from shadowcache_trade.ladder import Choice, Error, Frame, Point, choose, combine, ladder, price
from shadowcache_trade.pictures import Disagreement, agreement, noise_of_mean, relative_error
from shadowcache_trade.progress import Progress
from shadowcache_trade.report import render_line, rival_text

BUILD = Path(os.environ["SHADOWCACHE_BUILD"])
SOURCE = Path(os.environ["SHADOWCACHE_SOURCE"])
MAP = SOURCE / "scenes/maps/sunrise.exr"
BAKE, RENDER = BUILD / "bake/shadowcache-bake", BUILD / "render/shadowcache-render"

# A floor of 4 m, a wall, and a roof over a half.
SET = """v -2 0 -2\nv 2 0 -2\nv 2 0 2\nv -2 0 2\nv -2 1 -2\nv 0 1 -2\nv 0 1 2\nv -2 1 2\nv -2 2 -2\nv 2 2 -2
f 1 4 3 2\nf 5 8 7 6\nf 1 2 10 9\n"""
TRACK = {"cam": {"yfov": 0.8, "fps": 24, "frames": [{"origin": [3, 2.5, 4], "forward": [-3, -2.2, -4], "up": [0, 1, 0]}] * 3}}
SMALL = ["--size", "64x36", "--delivered", "64x36", "--seeds", "2", "--reference-rays", "64", "--spacings", "4",
         "--levels", "1", "--rays", "2"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("trade")
    (folder / "set.obj").write_text(SET, encoding="utf-8")
    (folder / "camera.json").write_text(json.dumps(TRACK), encoding="utf-8")
    return folder


def command(*arguments, output="trade"):
    return [sys.executable, "-m", "shadowcache_trade", "set.obj", "--env", str(MAP), "--camera", "camera.json", "--bake-program",
            str(BAKE), "-o", output, *SMALL, *arguments]


def run(folder, *arguments, **options):
    return subprocess.run(command(*arguments, **options), cwd=folder, capture_output=True, text=True, check=False)


@pytest.fixture(scope="module")
def baked(folder):
    """The set, with its cache and its light."""
    scene = shadowcache.load_set(folder / "set.obj")
    return scene, shadowcache.bake(scene, spacing=0.1, level=3), shadowcache.Environment.load(MAP)


@pytest.fixture(scope="module")
def done(folder):
    ended = run(folder, "--frames", "1-3", "--env-rotate", "130")
    assert ended.returncode == 0, ended.stderr
    return ended


def render(folder, baked, seed, rays, cache=False):
    scene, held, sky = baked
    return shadowcache.render(scene, held if cache else None, sky, shadowcache.Camera.load(folder / "camera.json"),
                              size=(64, 36), camera_rays=rays, samples=4, bounces=0, seed=seed,
                              estimator="cache" if cache else "mis")["color"]


# Errors and what they decide.

def test_error_is_that_of_the_renderer(folder, tmp_path):
    flags = [folder / "set.obj", "--env", MAP, "--camera", folder / "camera.json", "--size", "64x36", "--camera-rays", "4",
             "--samples", "4", "--bounces", "0", "--estimator", "mis"]
    for seed, more in ((1, []), (2, ["--reference", tmp_path / "1.exr", "--stats", tmp_path / "stats.json"])):
        subprocess.run([str(word) for word in [RENDER, *flags, "--seed", seed, "-o", tmp_path / f"{seed}.exr", *more]],
                       check=True, capture_output=True)
    first, second = (shadowcache.read_exr(tmp_path / f"{seed}.exr")["color"] for seed in (1, 2))
    stats = json.dumps(json.loads((tmp_path / "stats.json").read_text(encoding="utf-8")))
    ours = relative_error(second, first)
    assert any(abs(float(number) / ours[0] - 1) < 1e-4 for number in numbers_of(stats)), (ours, stats)
    assert any(abs(float(number) / ours[1] - 1) < 1e-4 for number in numbers_of(stats)), (ours, stats)


def numbers_of(text):
    import re
    return re.findall(r"-?\d+\.\d+(?:e[-+]\d+)?|\d+e[-+]\d+", text)


def test_black_pixels_have_no_error():
    black = np.zeros((4, 4, 3))
    assert relative_error(black, black) == (0, 0)


def test_pictures_agree_and_the_control_does_not(folder, baked):
    reference = (render(folder, baked, 101, 64, cache=True) + render(folder, baked, 102, 64, cache=True)) / 2
    pictures = [render(folder, baked, seed, 64) for seed in range(1, 4)]
    difference, deviation = agreement(pictures, reference)
    assert abs(difference) < 4 * deviation < 0.03
    with pytest.raises(Disagreement, match="is not noise"):
        agreement(pictures, 1.03 * reference)
    # The noise of a mean of two, from the two alone, is that of the mean of two others against the reference.
    assert noise_of_mean(*pictures[:2]) == pytest.approx(
        relative_error((pictures[1] + pictures[2]) / 2, reference)[0], rel=0.4)


def point(p99, bake, size, noise=0.0, seconds=1.0, **options):
    return Point(Choice(**options), 0.1, bake, size, Frame(Error(p99, 0), Error(p99, noise), seconds), 0.5)


def test_the_knee():
    points = [point(0.1, 10, 100), point(0.1, 4, 40, spacing=2, series="spacing"),
              point(0.4, 1, 10, spacing=8, series="spacing"), point(0.098, 40, 400, rays=64, series="rays")]
    price(points, frames=10, pixels=2)
    assert [round(p.whole, 3) for p in points] == [30, 24, 81, 59.6]
    assert choose(points) is points[1]
    # With many frames the bake is for nothing: of equal costs, the smallest cache, and not the worst picture's.
    price(points, frames=100000, pixels=2)
    assert choose(points) is points[1]
    # A cost that noise alone makes higher is equal; one that noise does not is not.
    noisy = [point(0.1, 0, 100, noise=0.01), point(0.115, 0, 10, level=3, series="level")]
    price(noisy, 10, 1)
    assert choose(noisy) is noisy[1]
    exact = [point(0.1, 0, 100, noise=0.001), point(0.115, 0, 10, level=3, series="level")]
    price(exact, 10, 1)
    assert choose(exact) is exact[0]


def test_the_ladder_and_its_combination():
    choices = ladder([2.0, 1.0], [3], [16, 4])
    assert [choice.options for choice in choices] == [(1, 5, 16), (2, 5, 16), (1, 3, 16), (1, 5, 4)]
    points = [point(0.1, 10, 100), point(0.1, 4, 40, spacing=2.0, series="spacing"),
              point(0.4, 9, 50, level=3, series="level"), point(0.1, 5, 60, rays=4, series="rays")]
    price(points, 1, 1)
    assert combine(points).options == (2, 5, 4)
    assert combine(points + [point(0.1, 2, 20, spacing=2.0, rays=4, series="combined")]) is None
    assert combine(points[:1]) is None


def test_time_left():
    text = io.StringIO()
    progress = Progress([("bake", 1.0), ("render", 1.0), ("bake", 3.0)], text)
    progress.run("first", lambda report: (report("", 1, 2), time.sleep(0.2)))
    assert "[1/3] first: 0.2 s, over 1 s left" in text.getvalue()
    progress.run("second", lambda report: None)
    progress.run("third", lambda report: None)
    assert text.getvalue().splitlines()[-1] == "[3/3] third: 0.0 s"


# Cycles.

def shot_of(folder, work, *options):
    words = [str(folder / "set.obj"), "--env", str(MAP), "--camera", str(folder / "camera.json"), "--bake-program", str(BAKE),
             *SMALL]
    return program.shot_of(program.parser().parse_args([*words, *options]), str(work))


def tile_difference(first, second):
    """Root mean square over tiles of 4 x 4 pixels, relative to the mean of all light."""
    tiles = [picture.mean(axis=2).reshape(9, 4, 16, 4).mean(axis=(1, 3)) for picture in (first, second)]
    return np.sqrt(np.mean((tiles[0] - tiles[1]) ** 2)) / tiles[1].mean()


@pytest.fixture(scope="module")
def by_cycles(folder, tmp_path_factory):
    """A shot, and what one run of Blender renders of it: what rival_of() asks for, and a picture of 4 samples."""
    shot = shot_of(folder, tmp_path_factory.mktemp("cycles"), "--env-rotate", "40")
    asked = [(16, 1), (16, 2), (64, 1), (64, 2), (256, cycles.REFERENCE_SEED)]
    return shot, asked, render_in_cycles(shot, [*asked, (4, 1)])


@pytest.mark.skipif(not shutil.which("blender"), reason="Blender is not installed")
def test_cycles_renders_the_same_picture_and_the_control_does_not(folder, by_cycles, tmp_path, monkeypatch):
    shot, asked, (rendered, seconds, load) = by_cycles
    theirs = rendered[len(asked) - 1]
    ours, turned = (shadowcache.render(shot.scene, None, sky, shot.camera, size=shot.size, camera_rays=64, samples=rays, bounces=0,
                                       estimator="mis")["color"] for sky, rays in ((shot.sky, 8), (shot.sky.rotate(5), 2)))
    assert abs(theirs.mean() / ours.mean() - 1) < 0.01 and seconds[0] > 0 and load > 0
    same, control = tile_difference(theirs, ours), tile_difference(theirs, turned)
    print(f"tiles differ by {same:.4f}, under a map turned by 5 degrees by {control:.4f}")
    assert same < 0.015 < 0.03 < control

    def again(_, renders):
        assert renders == asked
        return rendered[:len(asked)], seconds[:len(asked)], load

    plain = cycles.render
    monkeypatch.setattr(cycles, "render", again)  # what Blender has rendered; test_run has it do so for each
    assert rival_of(shot, ours).reason == ""
    # Another light is another picture, and has no row.
    other = rival_of(shot, 1.03 * theirs)
    assert other.difference == pytest.approx(-0.029, abs=0.005) and "differs by -" in other.reason and not other.frames
    # So has one with another number of bounces.
    monkeypatch.setattr(cycles, "render", plain)
    monkeypatch.setattr(cycles, "SAMPLES", (1,))
    more = shot_of(folder, tmp_path, "--env-rotate", "40", "--bounces", "4", "--reference-rays", "16")
    assert "differs by +" in rival_of(more, ours).reason


@pytest.mark.skipif(not shutil.which("blender"), reason="Blender is not installed")
def test_cycles_gets_an_upright_camera_from_a_pose_of_any_length_and_angle(by_cycles, monkeypatch):
    shot, _, (rendered, _, _) = by_cycles
    plain = cycles.request_of

    def raw(*arguments):
        request = plain(*arguments)
        request["camera"].update(TRACK["cam"]["frames"][0])
        return request

    monkeypatch.setattr(cycles, "request_of", raw)
    (found,), _, _ = render_in_cycles(shot, [(4, 1)])
    assert np.isclose(found, rendered[-1], rtol=1e-3, atol=1e-3).mean() > 0.99
    assert np.isclose(found, rendered[0], rtol=1e-3, atol=1e-3).mean() < 0.9  # the control: of more samples


def test_what_cycles_cannot_render_is_named(folder, tmp_path):
    shot = shot_of(folder, tmp_path, "--no-cycles")
    assert shot.cycles is None and obstacle(shot) == ""
    shot.camera = shadowcache.Camera((3, 2.5, 4), (0, 0, 0), lens_radius=0.1)
    assert "lens" in obstacle(shot)
    shot.camera, shot.files = shadowcache.Camera((3, 2.5, 4), (0, 0, 0)), ["set.off"]
    assert "importers" in obstacle(shot)
    shot.files, shot.cycles = [str(folder / "set.obj")], "/bin/false"
    assert rival_of(shot, np.ones((36, 64, 3))).reason == "/bin/false ended with status 1"
    assert rival_text(SimpleNamespace(rival=Rival(reason="no")), shot) == "Cycles is left out: no."


def test_the_printed_command_has_the_measured_bounces(folder, tmp_path):
    shot = shot_of(folder, tmp_path, "--bounces", "2")
    result = SimpleNamespace(cache=[((16, 4), Frame(Error(0.1, 0), Error(0.1, 0), 1.0))])
    assert "--bounces 2" in render_line(result, shot, "set.vdb")
    shot.bounces = 4
    assert "--bounces" not in render_line(result, shot, "set.vdb")


# Whole runs.

def test_run(done, folder):
    record = json.loads((folder / "trade.json").read_text(encoding="utf-8"))
    points = record["points"]
    assert [p["choice"]["series"] for p in points[:4]] == ["default", "spacing", "level", "rays"]
    assert record["frames"] == 3 and 0 <= record["knee"] < len(points)
    assert all(p["bake_seconds"] > 0 and p["bytes"] > 1000 and p["whole"] > p["bake_seconds"] for p in points)
    assert points[1]["spacing"] == pytest.approx(4 * points[0]["spacing"])
    assert points[1]["bytes"] < points[0]["bytes"] and all(p["preview"] > 0 for p in points)
    for kind in ("cache", "mis"):
        errors = {tuple(split): frame["p99"]["mean"] for split, frame in record[kind]}
        assert errors[64, 1] < errors[16, 1] < errors[4, 1]
    assert record["reference_relmse"] < record["mis"][0][1]["relmse"]["mean"]
    if shutil.which("blender"):
        rival = record["cycles"]
        assert rival["reason"] == "" and abs(rival["difference"]) < 0.01 and rival["load_seconds"] > 0
        assert [samples for samples, _ in rival["frames"]] == list(SAMPLES)
        few, many = (frame for _, frame in rival["frames"])
        assert many["relmse"]["mean"] < few["relmse"]["mean"] and 0 < few["seconds"] < many["seconds"]
        assert "| Cycles, samples |" in done.stdout
    assert done.stdout.count("**knee**") == 1 and "frames that share a bake" in done.stdout
    assert "left" in done.stderr
    assert (folder / "trade.png").read_bytes().startswith(b"\x89PNG")
    assert b"</svg>" in (folder / "trade.svg").read_bytes()
    assert not list(folder.glob(".part*"))


def test_the_printed_commands_render_what_was_measured(done, folder):
    """As they are printed: the light, the camera, the size and the samples of the module's calls."""
    lines = [line.strip() for line in done.stdout.splitlines() if line.startswith("    shadowcache-")]
    assert len(lines) == 2 and "--bounces 0" in lines[1]  # as measured
    programs = {"shadowcache-bake": BAKE, "shadowcache-render": RENDER}
    for line in lines:
        program, *words = shlex.split(line)
        ended = subprocess.run([programs[program], *words], cwd=folder, capture_output=True, text=True, check=False)
        assert ended.returncode == 0, (line, ended.stderr)
    words = shlex.split(lines[1])
    rays, samples = (int(words[words.index(option) + 1]) for option in ("--camera-rays", "--samples"))
    assert (folder / "set.0001.exr").exists() and (folder / "set.0003.exr").exists()

    def measured(turn):
        return shadowcache.render(shadowcache.load_set(folder / "set.obj"), shadowcache.Cache.open(folder / "set.vdb"),
                                  shadowcache.Environment.load(MAP, rotate=turn),
                                  shadowcache.Camera.load(folder / "camera.json", frame=2), size=(64, 36), frame=2,
                                  camera_rays=rays, samples=samples, bounces=0)["color"]

    printed = shadowcache.read_exr(folder / "set.0002.exr")["color"]
    assert np.array_equal(printed, measured(130))
    assert not np.allclose(printed, measured(0), rtol=0.05)  # the control


@pytest.mark.parametrize("arguments, message", [
    (["--size", "64"], "--size 64: expected WxH"),
    (["--frames", "3-1"], "--frames 3-1: expected A or A-B"),
    (["--frames", "9"], "camera.json"),
    (["--spacings", "2,none"], "--spacings 2,none: expected numbers from 0.1 to 20"),
    (["--levels", "6"], "--levels 6: expected numbers from 0 to 5"),
    (["--seeds", "1"], "--seeds 1: expected 2 to 1000"),
    (["--env", "none.exr"], "none.exr"),
    (["--cycles", "no-such-blender"], "--cycles no-such-blender: no such program"),
    (["--bake-program", "no-such-program"], "no-such-program: no such program"),
    (["-o", "none/trade"], "none: no folder"),
    (["--threads", "-1"], "threads")])
def test_refusals(folder, monkeypatch, capfd, arguments, message):
    monkeypatch.chdir(folder)
    monkeypatch.setattr(sys, "argv", ["shadowcache_trade", *command(*arguments)[3:]])
    kept = signal.getsignal(signal.SIGTERM)
    try:
        status = program.main()
    finally:
        signal.signal(signal.SIGTERM, kept)
    out, error = capfd.readouterr()
    assert status == 1 and out == ""
    assert error.startswith("shadowcache_trade: ") and message in error, error
    assert error.count("\n") == 1  # nothing was measured


def test_options_have_one_name(folder):
    ended = run(folder, "--spacing", "0.02")  # no short form of --spacings
    assert ended.returncode == 2 and "unrecognized arguments: --spacing 0.02" in ended.stderr


def test_a_bake_that_fails_says_why(folder):
    script = folder / "bake"
    script.write_text("#!/bin/sh\necho 'shadowcache-bake: the disk is full' >&2\nexit 1\n", encoding="utf-8")
    script.chmod(0o755)
    ended = run(folder, "--bake-program", str(script), output="failed")
    assert ended.returncode == 1 and "shadowcache_trade: shadowcache-bake: the disk is full" in ended.stderr
    assert not list(folder.glob("failed*"))


@pytest.mark.parametrize("sent", [signal.SIGINT, signal.SIGTERM])
def test_interrupted(folder, tmp_path, sent):
    environment = {**os.environ, "TMPDIR": str(tmp_path)}
    process = subprocess.Popen(command("--size", "640x360", "--reference-rays", "512", output="interrupted"), cwd=folder, env=environment,
                               stderr=subprocess.PIPE, text=True)
    line = process.stderr.readline()  # the first bake has ended, the reference is rendered
    assert line.startswith("[1/"), line
    assert list(tmp_path.iterdir())
    time.sleep(0.3)
    process.send_signal(sent)
    begin = time.monotonic()
    rest = process.communicate(timeout=60)[1]
    assert time.monotonic() - begin < 5
    assert process.returncode == 75 and rest.endswith("shadowcache_trade: interrupted\n"), rest
    assert not list(folder.glob("interrupted*")) and not list(tmp_path.iterdir())
