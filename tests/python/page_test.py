"""The examples of docs/python.md run, and mypy accepts them."""
import re
import subprocess
import sys

import numpy as np

from small_set import BUILD, MAP, SOURCE


def examples_of_page():
    page = (SOURCE / "docs/python.md").read_text(encoding="utf-8")
    examples = re.findall(r"^```python\n(.*?)^```$", page, re.DOTALL | re.MULTILINE)
    assert len(examples) >= 5
    return examples


def test_types(tmp_path):
    """mypy accepts the stub, and by it the examples of docs/python.md, one after the other; not a wrong use."""
    def mypy(name, text):
        (tmp_path / name).write_text(text, encoding="utf-8")
        checked = subprocess.run([sys.executable, "-m", "mypy", "--strict", "--ignore-missing-imports", name,
                                  BUILD / "python/shadowcache.pyi"], cwd=tmp_path, capture_output=True, text=True)
        return checked.returncode, checked.stdout + checked.stderr

    status, text = mypy("page.py", "\n".join(examples_of_page()))
    assert status == 0, text
    status, text = mypy("wrong.py", "import shadowcache\nshadowcache.Camera(eye=(0, 0, 1), look_at=(0, 0, 0), fov='wide')\n")
    assert status == 1 and "wrong.py:2" in text and "shadowcache.pyi" not in text, text


def test_page(courtyard, tmp_path, monkeypatch):
    """The examples of docs/python.md, one after the other in one folder."""
    for name, file in (("courtyard.glb", courtyard.file), ("camera.json", courtyard.camera), ("sky.exr", MAP)):
        (tmp_path / name).symlink_to(file)
    monkeypatch.chdir(tmp_path)
    names = {}
    for number, example in enumerate(examples_of_page()):
        exec(compile(example, f"docs/python.md, example {number + 1}", "exec"), names)
    assert names["by_angle"].shape == (24, 3) and np.isfinite(names["by_angle"]).all()
