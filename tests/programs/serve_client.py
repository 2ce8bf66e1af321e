"""Talks to shadowcache-render --serve as it works: serve_client.py SOURCE BUILD WORK

The example of docs/serve.md runs and writes its picture. Requests stop within a second wherever they are; an input that
ends, and a client that is killed, end the process and leave no file of pixels. Memory stays flat over 30 pictures.
"""
import json
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

SOURCE, BUILD, WORK = (Path(word) for word in sys.argv[1:4])
RENDER = str(BUILD / "render/shadowcache-render")
MOST_SECONDS = 1.0  # of a stop, with room for a machine that does other things
CLIENT = """
import subprocess, sys, time
p = subprocess.Popen([sys.argv[1], "--serve"], stdin=subprocess.PIPE)
p.stdin.write(open("endless.jsonl", "rb").read())
p.stdin.flush()
print(p.pid, flush=True)
time.sleep(600)
"""


class Server:
    def __init__(self):
        self.process = subprocess.Popen([RENDER, "--serve"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.last = 0

    def send(self, request, **fields):
        self.last += 1
        self.process.stdin.write(json.dumps({"id": self.last, "request": request, **fields}) + "\n")
        self.process.stdin.flush()
        return self.last

    def wait(self, number, kinds=("done", "error", "stopped")):
        for line in self.process.stdout:
            reply = json.loads(line)
            if reply["id"] == number and reply["reply"] in kinds:
                return reply
        raise RuntimeError("the process has ended")

    def ask(self, request, **fields):
        reply = self.wait(self.send(request, **fields))
        assert reply["reply"] == "done", reply
        return reply


def run(*command):
    subprocess.run(command, check=True, cwd=WORK, stdout=subprocess.DEVNULL)


def example():
    run(sys.executable, SOURCE / "docs/examples/serve_client.py", "set.glb", "set.vdb", SOURCE / "scenes/maps/courtyard.exr",
        "picture.ppm", "--size", "48x27", "--program", RENDER)
    picture = (WORK / "picture.ppm").read_bytes()
    assert picture.startswith(b"P6 48 27 255\n") and len(set(picture[13:])) > 50, "the example's picture is empty"


def stops(server):
    """Asks for the end at moments all over a request."""
    requests = [("load", {"set": ["set.glb"], "cache": "set.vdb"}), ("environment", {"map": "big.hdr"}),
                ("render", {"pixels": "pixels"})]
    for request, fields in requests:
        stopped = 0
        start = time.monotonic()
        server.ask("options", spp=1, bounces=0)
        server.ask(request, **fields)
        whole = min(time.monotonic() - start, 2)
        server.ask("options", spp=65536, bounces=4)
        for share in (0, 0.1, 0.3, 0.5, 0.7):
            if request == "environment":
                server.ask(request, radiance=1)
            number = server.send(request, **fields)
            time.sleep(share * whole)
            asked = time.monotonic()
            server.send("stop")
            kind = server.wait(number)["reply"]
            seconds = time.monotonic() - asked
            assert seconds < MOST_SECONDS, "%s: stopped after %.2f s" % (request, seconds)
            stopped += kind == "stopped"
        assert stopped > 0, "%s: never stopped" % request
        server.ask("options", spp=1, bounces=0)
        server.ask(request, **fields)


def stops_within_a_tile(server):
    server.ask("size", width=16, height=16)
    server.ask("options", spp=65536, bounces=0)
    number = server.send("render", pixels="pixels")
    time.sleep(0.5)
    asked = time.monotonic()
    server.send("stop")
    assert server.wait(number)["reply"] == "stopped", "the tile ended by itself"
    seconds = time.monotonic() - asked
    assert seconds < MOST_SECONDS, "a tile stopped after %.2f s" % seconds
    server.ask("size", width=192, height=108)


def memory_of(process):
    lines = Path("/proc/%d/status" % process.pid).read_text().splitlines()
    return int(next(line for line in lines if line.startswith("VmRSS:")).split()[1])


def flat_memory(server):
    server.ask("options", spp=1, bounces=0)
    for i in range(30):
        if i == 10:
            before = memory_of(server.process)
        server.ask("environment", map="big.hdr", rotate=i)
        server.ask("render", pixels="pixels")
    grown = memory_of(server.process) - before
    assert grown < 30000, "20 pictures take %d kB more" % grown


def progress(server):
    server.ask("options", spp=256, bounces=0)
    reply = server.wait(server.send("render", pixels="pixels"), ("progress", "done"))
    assert reply["reply"] == "progress" and 0 < reply["done"] <= reply["total"], reply


def passes(server):
    """The last pass that was shown is what a stop leaves."""
    server.ask("options", spp=65536, bounces=0, **{"pass-rays": 1})
    number = server.send("render", pixels="pixels", progressive=True)
    shown = [server.wait(number, ("picture", "done"))["sequence"] for _ in range(3)]
    assert shown[0] < shown[1] < shown[2], shown
    server.send("stop")
    reply = server.wait(number, ("picture", "done", "stopped"))
    while reply["reply"] == "picture":
        shown.append(reply["sequence"])
        reply = server.wait(number, ("picture", "done", "stopped"))
    assert reply["reply"] == "stopped", reply
    header = (WORK / "pixels").read_bytes()[:64]
    assert int.from_bytes(header[8:16], "little") == shown[-1], shown
    server.ask("options", spp=1, bounces=0)


def ends_with_its_input(server):
    server.ask("render", pixels="pixels")
    assert (WORK / "pixels").exists()
    server.ask("options", spp=65536)
    server.send("render", pixels="pixels")
    time.sleep(0.5)
    start = time.monotonic()
    server.process.stdin.close()
    assert server.process.wait(10) == 0
    assert time.monotonic() - start < MOST_SECONDS
    assert not (WORK / "pixels").exists(), "the file of pixels is left"


def ends_with_its_client():
    lines = [{"request": "load", "set": ["set.glb"]}, {"request": "environment", "radiance": 1},
             {"request": "camera", "name": "camera.json"}, {"request": "options", "spp": 65536},
             {"request": "render", "pixels": "orphan"}]
    (WORK / "endless.jsonl").write_text("".join(json.dumps({"id": i, **line}) + "\n" for i, line in enumerate(lines)))
    client = subprocess.Popen([sys.executable, "-c", CLIENT, RENDER], stdout=subprocess.PIPE, cwd=WORK, text=True)
    server = int(client.stdout.readline())
    time.sleep(2)
    assert Path("/proc/%d" % server).exists(), "the process has ended before its client"
    client.kill()
    client.wait()
    deadline = time.monotonic() + 5
    while is_running(server):
        assert time.monotonic() < deadline, "the process goes on without its client"
        time.sleep(0.05)
    assert not (WORK / "orphan").exists(), "the file of pixels is left"


def is_running(process):
    try:
        return ") Z " not in Path("/proc/%d/stat" % process).read_text()
    except OSError:
        return False


def write_big_map():
    """A map that takes a while: flat pixels of a Radiance file."""
    row = b"".join(bytes((40 + x % 180, 90, 30 + x % 7, 128)) for x in range(4096))
    (WORK / "big.hdr").write_bytes(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2048 +X 4096\n" + row * 2048)


def main():
    shutil.rmtree(WORK, ignore_errors=True)
    WORK.mkdir(parents=True)
    os.chdir(WORK)
    run(BUILD / "scenes/shadowcache-make-set", "courtyard", "-o", "set.glb", "--camera", "camera.json")
    run(BUILD / "bake/shadowcache-bake", "set.glb", "-o", "set.vdb", "--spacing", "3", "--level", "2", "--rays", "4",
        "--progress", "none")
    write_big_map()
    example()
    server = Server()
    server.ask("size", width=192, height=108)
    server.ask("camera", name="camera.json")
    stops(server)
    stops_within_a_tile(server)
    flat_memory(server)
    progress(server)
    passes(server)
    ends_with_its_input(server)
    ends_with_its_client()


main()
