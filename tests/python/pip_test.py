"""`pip install .` without a network puts the module into a venv, where it works from any folder.

Needs SHADOWCACHE_BUILD, the folder of a build that holds the module, and SHADOWCACHE_SOURCE, that of the sources.
"""
import os
import subprocess
import venv
from pathlib import Path

import pytest

BUILD = Path(os.environ["SHADOWCACHE_BUILD"])
SOURCE = Path(os.environ["SHADOWCACHE_SOURCE"])

# A floor under the open sky, of radiance 1: pi everywhere.
PROGRAM = """
import shadowcache
print(shadowcache.__file__)
floor = shadowcache.load_set([[-2, 0, -2], [2, 0, -2], [2, 0, 2], [-2, 0, 2]], [[0, 2, 1], [0, 3, 2]])
cache = shadowcache.bake(floor, spacing=0.5, level=2)
print(*cache.irradiance((0, 0, 0), (0, 1, 0), shadowcache.Environment.constant(1)))
"""


def run(*command, cwd):
    # No network, and no module of the build, whatever the caller's environment has.
    environment = {"PATH": os.environ["PATH"], "PIP_NO_INDEX": "1", "PIP_DISABLE_PIP_VERSION_CHECK": "1"}
    return subprocess.run([str(word) for word in command], cwd=cwd, env=environment,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)


@pytest.fixture(scope="module")
def environment(tmp_path_factory):
    folder = tmp_path_factory.mktemp("venv")
    venv.create(folder, system_site_packages=True, with_pip=True)
    return folder


def test_installed_module_works_in_another_folder(environment, tmp_path):
    pip = run(environment / "bin/pip", "install", "--no-build-isolation", "--config-settings", f"build={BUILD}",
              SOURCE, cwd=tmp_path)
    assert pip.returncode == 0, pip.stdout
    python = run(environment / "bin/python", "-c", PROGRAM, cwd=tmp_path)
    assert python.returncode == 0, python.stdout
    file, irradiance = python.stdout.splitlines()
    assert Path(file).is_relative_to(environment)
    assert [float(number) for number in irradiance.split()] == pytest.approx([3.1416] * 3, rel=0.01)

    shown = run(environment / "bin/pip", "show", "--files", "shadowcache", cwd=tmp_path).stdout
    assert "Requires: numpy" in shown
    metadata = next(environment.glob("lib/*/site-packages/shadowcache-*.dist-info/METADATA")).read_text(encoding="utf-8")
    assert "Requires-Dist: numpy>=1.20,<2\n" in metadata
    assert "shadowcache-stubs/__init__.pyi" in shown and "shadowcache_trade/__main__.py" in shown
    # Type checkers find the hints. [PEP 561]
    (tmp_path / "right.py").write_text("import shadowcache\nshadowcache.Environment.constant(1).rotate(30)\n", encoding="utf-8")
    (tmp_path / "wrong.py").write_text("import shadowcache\nshadowcache.Camera(eye=(0, 0, 1), look_at=(0, 0, 0), fov='wide')\n",
                                       encoding="utf-8")
    # NumPy's are left out, which take the longest: those of the module are what is looked for.
    (tmp_path / "mypy.ini").write_text("[mypy]\n[mypy-numpy.*]\nfollow_imports = skip\nfollow_imports_for_stubs = True\n",
                                       encoding="utf-8")
    found = run(environment / "bin/python", "-m", "mypy", "--strict", "--cache-dir", tmp_path / "cache", "right.py", "wrong.py",
                cwd=tmp_path)
    errors = [line for line in found.stdout.splitlines() if "error:" in line]
    assert found.returncode == 1 and len(errors) == 1, found.stdout
    assert errors[0].startswith("wrong.py:2: ") and 'incompatible type "str"' in errors[0], found.stdout

    removed = run(environment / "bin/pip", "uninstall", "--yes", "shadowcache", cwd=tmp_path)
    assert removed.returncode == 0, removed.stdout
    assert not Path(file).exists()


def test_module_of_another_python_is_refused(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(SOURCE / "render/python")
    import build_backend
    monkeypatch.setattr(build_backend.sysconfig, "get_config_var", lambda name: ".cpython-399.so")
    with pytest.raises(SystemExit, match="expected shadowcache.cpython-399.so"):
        build_backend.build_wheel(tmp_path, {"build": str(BUILD)})
    assert not list(tmp_path.iterdir())
