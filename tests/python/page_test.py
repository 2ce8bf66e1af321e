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
    """mypy accepts the stub, and by it the examples of docs/python.md, one after the other; not a wrong use beside them."""
    (tmp_path / "page.py").write_text("\n".join(examples_of_page()), encoding="utf-8")
    (tmp_path / "wrong.py").write_text("import shadowcache\nshadowcache.Camera(eye=(0, 0, 1), look_at=(0, 0, 0), fov='wide')\n",
                                       encoding="utf-8")
    checked = subprocess.run([sys.executable, "-m", "mypy", "--strict", "--ignore-missing-imports", "page.py", "wrong.py",
                              BUILD / "python/shadowcache.pyi"], cwd=tmp_path, capture_output=True, text=True)
    text = checked.stdout + checked.stderr
    errors = [line for line in text.splitlines() if "error:" in line]
    assert checked.returncode == 1 and len(errors) == 1 and errors[0].startswith("wrong.py:2: "), text


# Text of the examples, and what costs less and shows as much.
CHEAPER = {"spacing=3.0, level=2": "spacing=6.0, level=2", "spacing=3, level=2": "spacing=6, level=2", "> 0.9][:200]": "> 0.9][:20]"}


def cheaper(examples):
    text = "\0".join(examples)
    for dear, cheap in CHEAPER.items():
        assert text.count(dear) == 1, dear
        text = text.replace(dear, cheap)
    return text.split("\0")


def test_page(courtyard, tmp_path, monkeypatch):
    """The examples of docs/python.md, one after the other in one folder."""
    for name, file in (("courtyard.glb", courtyard.file), ("camera.json", courtyard.camera), ("sky.exr", MAP)):
        (tmp_path / name).symlink_to(file)
    monkeypatch.chdir(tmp_path)
    names = {}
    for number, example in enumerate(cheaper(examples_of_page())):
        exec(compile(example, f"docs/python.md, example {number + 1}", "exec"), names)
    assert names["year"].shape == (8760, 20, 3) and np.isfinite(names["year"]).all() and names["year"].max() > 0
    assert names["by_angle"].shape == (24, 3) and np.isfinite(names["by_angle"]).all()
