"""Makes the wheel of the Python module with CMake: `pip install . --no-build-isolation` (docs/python.md).

`--config-settings build=DIR` packs the module that stands in the build folder DIR, and compiles nothing.
Without it the module is built in build/python, as the release preset builds it.
"""
import base64
import hashlib
import re
import subprocess
import sys
import sysconfig
import tempfile
import zipfile
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
# pybind11 knows NumPy 2 from its version 2.12 on; Debian 12 has an older one.
REQUIRES = {"Requires-Python": ">=3.9", "Requires-Dist": "numpy>=1.20,<2"}


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """As PEP 517 has it: writes a wheel into the folder and returns its name."""
    build = (config_settings or {}).get("build")
    build = Path(build).absolute() if build else compile_module()
    with tempfile.TemporaryDirectory() as folder:
        run("cmake", "--install", build, "--component", "python", "--prefix", folder)
        files = {path.relative_to(folder).as_posix(): path.read_bytes()
                 for path in sorted(Path(folder).rglob("*")) if path.is_file()}
    module = "shadowcache" + sysconfig.get_config_var("EXT_SUFFIX")
    if module not in files:
        sys.exit(f"{build}: holds {', '.join(files)}, expected {module}, the module for {sys.executable}")
    name = f"shadowcache-{version()}-{tag()}.whl"
    write_wheel(Path(wheel_directory) / name, files)
    return name


def compile_module():
    """Builds the module for this Python, and returns the build folder."""
    build = SOURCE / "build/python"
    run("cmake", "--preset", "release", "-B", build, "-D", "SHADOWCACHE_PYTHON=ON",
        "-D", "SHADOWCACHE_TESTS=OFF", "-D", f"Python_EXECUTABLE={sys.executable}")
    run("cmake", "--build", build, "--target", "shadowcache_python")
    return build


def write_wheel(path, files):
    info = f"shadowcache-{version()}.dist-info"
    metadata = {"Metadata-Version": "2.1", "Name": "shadowcache", "Version": version(), **REQUIRES}
    wheel = {"Wheel-Version": "1.0", "Root-Is-Purelib": "false", "Tag": tag()}
    files = {**files, f"{info}/METADATA": fields(metadata), f"{info}/WHEEL": fields(wheel)}
    for name in ("LICENSE", "NOTICE"):
        files[f"{info}/{name}"] = (SOURCE / name).read_bytes()
    record = "".join(f"{name},sha256={digest(data)},{len(data)}\n" for name, data in files.items())
    files[f"{info}/RECORD"] = f"{record}{info}/RECORD,,\n".encode()
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            archive.writestr(name, data)


def version():
    text = (SOURCE / "CMakeLists.txt").read_text(encoding="utf-8")
    return re.search(r"project\(shadowcache VERSION ([\d.]+)", text)[1]


def tag():
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    return f"{python}-{python}-{re.sub('[-.]', '_', sysconfig.get_platform())}"


def fields(table):
    return "".join(f"{name}: {value}\n" for name, value in table.items()).encode()


def digest(data):
    return base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()


def run(*command):
    subprocess.run([str(word) for word in command], cwd=SOURCE, check=True)
