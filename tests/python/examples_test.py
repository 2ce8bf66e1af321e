"""The scripts of docs/examples/python draw what docs/python.md shows.

Needs SHADOWCACHE_BUILD, the folder of a build, and SHADOWCACHE_SOURCE, that of the sources.
"""
import os
import subprocess
import sys
from pathlib import Path

import matplotlib.image
import numpy as np
import pytest

BUILD = Path(os.environ["SHADOWCACHE_BUILD"])
SOURCE = Path(os.environ["SHADOWCACHE_SOURCE"])
EXAMPLES = SOURCE / "docs/examples/python"
MAP = SOURCE / "scenes/maps/sunrise.exr"


def run(*command, cwd):
    done = subprocess.run([str(word) for word in command], cwd=cwd, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The courtyard, baked coarsely."""
    folder = tmp_path_factory.mktemp("examples")
    run(BUILD / "scenes/shadowcache-make-set", "courtyard", "-o", "courtyard.glb", "--camera", "camera.json", cwd=folder)
    run(BUILD / "bake/shadowcache-bake", "courtyard.glb", "-o", "courtyard.vdb", "--spacing", 3, "--level", 2, "--rays", 2,
        "--progress", "none", cwd=folder)
    return folder


def drawn(folder, script, *arguments):
    """What a script prints, and its picture."""
    text = run(sys.executable, EXAMPLES / script, *arguments, "out.png", cwd=folder)
    picture = matplotlib.image.imread(folder / "out.png")[:, :, :3]
    assert len(np.unique(picture.reshape(-1, 3), axis=0)) > 20  # not an empty frame
    return text, picture


def test_sky_over_a_day(folder):
    assert drawn(folder, "sky_over_a_day.py", "courtyard.vdb", MAP, "0,0.1,3.5")[1].shape == (360, 700, 3)


def test_panels_on_a_roof(folder):
    places = np.array([[float(word) for word in line.split()]
                       for line in drawn(folder, "panels_on_a_roof.py", "courtyard.vdb", MAP, 6)[0].splitlines()])
    assert places.shape == (10, 4)
    assert (places[:, 1] >= 6).all() and (np.diff(places[:, 3]) <= 0).all() and places[-1, 3] > 0


def test_synthetic_data(folder):
    text, picture = drawn(folder, "synthetic_data.py", "courtyard.glb", "courtyard.vdb", MAP, "camera.json", 2)
    assert "pictures a second" in text and picture.shape == (108, 192, 3)
    data = np.load(folder / "out.npz")
    assert data["color"].shape == data["normal"].shape == (2, 2, 54, 96, 3) and data["depth"].shape == (2, 2, 54, 96)
    # Skies differ, what a camera sees does not: but for edges, where light decides the number of camera rays.
    color, depth = data["color"], data["depth"]
    assert np.isclose(depth[0], depth[1], rtol=0.01).mean() > 0.8 > 2 * np.isclose(depth[:, 0], depth[:, 1], rtol=0.01).mean()
    assert np.isclose(color[0], color[1], rtol=0.01).mean() < 0.3


def test_year_of_sensors(folder):
    text = run(sys.executable, EXAMPLES / "year_of_sensors.py", "courtyard.glb", "courtyard.vdb", "year.npz", 20, 2, cwd=folder)
    assert "8760 hours on 20 sensors" in text and "by brute force" in text
    data = np.load(folder / "year.npz")
    assert data["irradiance"].shape == (8760, 20, 3)
    found, truth = data["irradiance"][data["checked"]], data["truth"]
    assert len(truth) >= 3 and (truth > 0).all()

    def deviation(values):
        return np.abs(values - truth).mean() / truth.mean()

    assert deviation(found) < 0.1
    # The controls: a quarter less, and the sensors in another order.
    assert deviation(0.75 * found) > 0.1 and deviation(found[:, ::-1]) > 0.1
    night = np.cos(2 * np.pi * (data["hours"] % 24) / 24) > 0.95
    assert data["irradiance"][night].max() == 0


def test_beside_pyopenvdb(folder):
    # Modules that Debian does not have everywhere; both in one process is what is tested.
    if not os.environ.get("SHADOWCACHE_NO_SKIP"):
        pytest.importorskip("pyopenvdb", reason="Debian package: python3-openvdb")
    drawn(folder, "beside_pyopenvdb.py", "courtyard.vdb")


@pytest.mark.parametrize("script, arguments, message", [
    ("sky_over_a_day.py", ["0,90,0"], "nothing faces up within"), ("panels_on_a_roof.py", [90], "nothing faces up above")])
def test_places_that_are_not_there(folder, script, arguments, message):
    done = subprocess.run([sys.executable, str(EXAMPLES / script), "courtyard.vdb", str(MAP), *map(str, arguments), "none.png"],
                          cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 1 and message in done.stderr and not (folder / "none.png").exists()
