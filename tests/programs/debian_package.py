"""`cpack -G DEB` packs what a build holds, and that works elsewhere: debian_package.py SOURCE BUILD WORK

The package names what it needs, and holds programs with their pages, libraries, and the module if it was built. Taken
apart in another folder, a program bakes, and Python imports the module from there and opens that cache. A build whose
program is missing is refused, as the control.
"""
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

SOURCE, BUILD, WORK = (Path(word).absolute() for word in sys.argv[1:4])
PROGRAMS = ("shadowcache-bake", "shadowcache-render", "shadowcache-info", "shadowcache-merge", "shadowcache-farm")
SET = "v -2 0 -2\nv 2 0 -2\nv 2 0 2\nv -2 0 2\nf 1 4 3 2\n"
SCRIPT = """
import shadowcache, shadowcache_trade
cache = shadowcache.Cache.open("floor.vdb")
sky = shadowcache.Environment.constant(1)
print(shadowcache.__file__, shadowcache_trade.__file__, cache.irradiance((0, 0, 0), (0, 1, 0), sky)[0])
"""


def run(*command, **options):
    return subprocess.run([str(word) for word in command], check=True, stdout=subprocess.PIPE, text=True, **options).stdout


def pack(config, folder, **options):
    """The package that cpack makes."""
    folder.mkdir()
    # Uncompressed: packing takes the time otherwise.
    run("cpack", "-G", "DEB", "--config", config, "-B", folder, "-D", "CPACK_DEBIAN_COMPRESSION_TYPE=none", cwd=folder,
        **options)
    found = list(folder.glob("*.deb"))
    assert len(found) == 1, found
    return found[0]


def check_control(package, version, module):
    fields = dict(re.findall(r"^ ([A-Z][\w-]*): (.*)$", run("dpkg-deb", "-I", package), re.MULTILINE))
    assert (fields["Package"], fields["Version"]) == ("shadowcache", version), fields
    for needed in ("libopenvdb10.0", "libembree3-3", "libtbb12", "libc6") + (("python3-numpy",) if module else ()):
        assert re.search(rf"\b{re.escape(needed)}\b", fields["Depends"]), (needed, fields["Depends"])
    assert "libgtest" not in fields["Depends"]
    assert "@" in fields["Maintainer"] and "Python module" in run("dpkg-deb", "-f", package, "Description")


def check_content(package, module):
    files = {line.split(maxsplit=5)[5].removeprefix("./") for line in run("dpkg-deb", "-c", package).splitlines()}
    wanted = {f"usr/bin/{name}" for name in PROGRAMS} | {f"usr/share/man/man1/{name}.1" for name in PROGRAMS}
    wanted |= {"usr/share/doc/shadowcache/LICENSE", "usr/share/shadowcache/shadowcache-blender.zip",
               "usr/include/shadowcache/common/cache/shadow_cache.h"}
    wanted |= {f"usr/lib/python3/dist-packages/{name}" for name in ("shadowcache-stubs/__init__.pyi", "shadowcache_trade/__main__.py")
               if module}
    assert wanted <= files, wanted - files
    assert any(name.endswith("libshadowcache.a") for name in files)
    assert any(name.endswith("shadowcacheConfig.cmake") for name in files)
    strange = [name for name in files if name and not name.startswith("usr/")]
    assert not strange, strange


def check_use(package, module):
    root = WORK / "elsewhere"
    run("dpkg-deb", "-x", package, root)
    environment = {"PATH": f"{root / 'usr/bin'}:{os.environ['PATH']}", "LANG": "C.UTF-8"}
    (WORK / "floor.obj").write_text(SET, encoding="utf-8")
    run("shadowcache-bake", "floor.obj", "-o", "floor.vdb", "--spacing", "0.5", "--level", "2", "--progress", "none",
        cwd=WORK, env=environment)
    if module:
        environment.update(PYTHONPATH=str(root / "usr/lib/python3/dist-packages"), PYTHONDONTWRITEBYTECODE="1")
        module_file, trade_file, irradiance = run("/usr/bin/python3", "-c", SCRIPT, cwd=WORK, env=environment).split()
        assert Path(module_file).is_relative_to(root) and Path(trade_file).is_relative_to(root)
        assert abs(float(irradiance) - 3.1416) < 0.04, irradiance
    # What runs is what was packed: no library of the build is looked for.
    for program in PROGRAMS:
        assert str(BUILD) not in run("readelf", "-d", root / "usr/bin" / program), program


def check_missing_program(config):
    """The control: an install that fails makes no package."""
    text = config.read_text(encoding="utf-8").replace(f"{BUILD};shadowcache;ALL;/", f"{WORK / 'nothing'};shadowcache;ALL;/")
    broken = WORK / "broken.cmake"
    broken.write_text(text, encoding="utf-8")
    try:
        pack(broken, WORK / "broken", stderr=subprocess.DEVNULL)
    except subprocess.CalledProcessError:
        return
    sys.exit("a build that is not there was packed")


def main():
    for program in ("dpkg-deb", "dpkg-shlibdeps", "cpack", "file"):
        if not shutil.which(program):
            print(f"needs {program} (Debian packages: dpkg-dev, file)")
            sys.exit(1 if os.environ.get("SHADOWCACHE_NO_SKIP") else 77)
    shutil.rmtree(WORK, ignore_errors=True)
    WORK.mkdir(parents=True)
    config = BUILD / "CPackConfig.cmake"
    version = re.search(r"project\(shadowcache VERSION ([\d.]+)", (SOURCE / "CMakeLists.txt").read_text(encoding="utf-8"))[1]
    module = any((BUILD / "python").glob("shadowcache*.so"))
    package = pack(config, WORK / "package")
    check_control(package, version, module)
    check_content(package, module)
    check_use(package, module)
    check_missing_program(config)
    print(f"{package.name}: {package.stat().st_size / 1e6:.0f} MB, as it should be")
    shutil.rmtree(WORK)


main()
