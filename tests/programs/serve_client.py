"""Talks to shadowcache-render --serve as it works: serve_client.py SOURCE BUILD WORK small|big

small: the example of docs/serve.md runs and writes its picture. A render stops within a tile. An input that ends, and a
client that is killed, end the process and leave no file of pixels. Memory stays flat over 30 pictures.
big: requests stop wherever they are, loading and a map of 4096 x 2048 texels within 0.3 s, and report their progress;
Ctrl-C of the command line does as much.
"""
import json
import os
import random
import shutil
import signal
import struct
import subprocess
import sys
import time
import zlib
from pathlib import Path

SOURCE, BUILD, WORK = (Path(word) for word in sys.argv[1:4])
PART = sys.argv[4]
SET = "set.glb" if PART == "big" else "set.obj"
RENDER = str(BUILD / "render/shadowcache-render")
MOST_SECONDS = 1.0  # of a stop, with room for a machine that does other things
MOST_OF_LOADING = 0.3  # of a set or a map
MAP = "big.exr"
WIDTH, HEIGHT, BLOCK = 4096, 2048, 16  # of the map; lines that are compressed as one
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
    run(sys.executable, SOURCE / "docs/examples/serve_client.py", SET, "set.vdb", SOURCE / "scenes/maps/courtyard.exr",
        "picture.ppm", "--size", "48x27", "--program", RENDER)
    picture = (WORK / "picture.ppm").read_bytes()
    assert picture.startswith(b"P6 48 27 255\n") and len(set(picture[13:])) > 50, "the example's picture is empty"


def stops(server):
    """Asks for the end at moments all over a request."""
    requests = [("load", {"set": [SET], "cache": "set.vdb"}, MOST_OF_LOADING),
                ("environment", {"map": MAP}, MOST_OF_LOADING), ("render", {"pixels": "pixels"}, MOST_SECONDS)]
    for request, fields, most in requests:
        worst, stopped = 0, 0
        start = time.monotonic()
        server.ask("options", spp=1, bounces=0)
        server.ask(request, **fields)
        whole = min(time.monotonic() - start, 2)
        server.ask("options", spp=65536, bounces=4)
        for step in range(10):
            if request == "environment":
                server.ask(request, radiance=1)
            number = server.send(request, **fields)
            time.sleep(step / 12 * whole)
            asked = time.monotonic()
            server.send("stop")
            kind = server.wait(number)["reply"]
            worst = max(worst, time.monotonic() - asked)
            stopped += kind == "stopped"
        print("%s takes %.2f s; %d of 10 stopped, within %.3f s" % (request, whole, stopped, worst))
        assert worst < most, "%s: stopped after %.2f s" % (request, worst)
        assert stopped >= 5, "%s: stopped %d times of 10" % (request, stopped)
        server.ask("options", spp=1, bounces=0)
        server.ask(request, **fields)


def ctrl_c():
    """Ends the command line while a map that was read is turned into tables."""
    command = [RENDER, SET, "--env", MAP, "--camera", "camera.json", "--size", "16x9", "--bounces", "0",
               "--spp", "65536", "--progress", "json", "-o", "never.exr"]
    for delay in (0, 0.05, 0.1):
        process = subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True)
        while json.loads(process.stderr.readline())["task"] != "read":
            pass
        time.sleep(delay)
        asked = time.monotonic()
        process.send_signal(signal.SIGINT)
        said = process.stderr.read()
        assert process.wait(10) == 75 and "interrupted" in said, (process.returncode, said)
        seconds = time.monotonic() - asked
        print("Ctrl-C after %.2f s of tables: %.3f s" % (delay, seconds))
        assert seconds < MOST_OF_LOADING, "Ctrl-C: %.2f s" % seconds
        assert "frame 1" not in said, "the map was ready before"
    assert not (WORK / "never.exr").exists()


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
        server.ask("environment", map=str(SOURCE / "scenes/maps/sunrise.exr"), rotate=i)
        server.ask("render", pixels="pixels")
    grown = memory_of(server.process) - before
    assert grown < 30000, "20 pictures take %d kB more" % grown


def tasks(server, request, **fields):
    """The tasks that a request shows progress of, each of which must end."""
    number = server.send(request, **fields)
    shown = {}
    while True:
        reply = server.wait(number, ("progress", "done", "error", "stopped"))
        if reply["reply"] != "progress":
            assert reply["reply"] == "done", reply
            break
        assert shown.get(reply["task"], 0) < reply["done"] <= reply["total"], reply
        shown[reply["task"]] = reply["done"]
        ended = reply["done"] == reply["total"]
    assert ended, shown
    return list(shown)


def progress(server):
    server.ask("environment", radiance=1)
    assert tasks(server, "environment", map=MAP) == ["read", "map tables"]
    server.ask("options", spp=1, bounces=2)
    assert tasks(server, "render", pixels="pixels") == ["predict light", "frame 1"]
    server.ask("environment", map=MAP, rotate=10)
    assert tasks(server, "render", pixels="pixels") == ["predict light", "frame 1"]
    assert tasks(server, "render", pixels="pixels") == ["frame 1"]


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


def small_server():
    server = Server()
    server.ask("load", set=[SET], cache="set.vdb")
    server.ask("environment", radiance=1)
    server.ask("camera", name="camera.json")
    server.ask("size", width=96, height=54)
    server.ask("options", spp=1, bounces=0)
    return server


def wait_for(file):
    deadline = time.monotonic() + 10
    while not file.exists():
        assert time.monotonic() < deadline, "%s is not there" % file
        time.sleep(0.01)


def pixels_that_are_removed():
    """A picture that nobody can find is none; a server removes what it has made, and nothing of another one."""
    first, second = small_server(), small_server()
    first.ask("options", spp=256, bounces=0)
    number = first.send("render", pixels="shared")
    wait_for(WORK / "shared")
    (WORK / "shared").unlink()
    reply = first.wait(number)
    assert reply["reply"] == "error" and "shared: was removed or replaced" in reply["error"], reply
    first.ask("options", spp=1, bounces=0)
    first.ask("render", pixels="shared")
    second.ask("render", pixels="shared")
    second.ask("render", pixels="own")
    for server, left in ((second, {"shared"}), (first, set())):
        server.process.stdin.close()
        assert server.process.wait(10) == 0
        assert {name for name in ("shared", "own") if (WORK / name).exists()} == left


def begins_with_a_byte_order_mark():
    lines = b'\xef\xbb\xbf{"id": 1, "request": "size", "width": 8, "height": 8}\n{"id": 2, "request": "quit"}\n'
    told = subprocess.run([RENDER, "--serve"], input=lines, capture_output=True, timeout=60, check=True)
    assert json.loads(told.stdout.splitlines()[0]) == {"id": 1, "reply": "done"}, told.stdout


def ends_with_its_client():
    lines = [{"request": "load", "set": [SET]}, {"request": "environment", "radiance": 1},
             {"request": "camera", "name": "camera.json"}, {"request": "options", "spp": 65536},
             {"request": "render", "pixels": "orphan"}]
    (WORK / "endless.jsonl").write_text("".join(json.dumps({"id": i, **line}) + "\n" for i, line in enumerate(lines)))
    client = subprocess.Popen([sys.executable, "-c", CLIENT, RENDER], stdout=subprocess.PIPE, cwd=WORK, text=True)
    server = int(client.stdout.readline())
    wait_for(WORK / "orphan")
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
    """A map that takes a while: half floats, compressed by ZIP; all blocks of lines are alike."""
    def attribute(name, kind, value):
        return b"%s\0%s\0%s%s" % (name, kind, struct.pack("<i", len(value)), value)

    box = struct.pack("<4i", 0, 0, WIDTH - 1, HEIGHT - 1)
    channels = b"".join(name + struct.pack("<x4i", 1, 0, 1, 1) for name in (b"B", b"G", b"R"))
    head = b"\x76\x2f\x31\x01" + struct.pack("<i", 2) + b"".join((
        attribute(b"channels", b"chlist", channels + b"\0"), attribute(b"compression", b"compression", b"\3"),
        attribute(b"dataWindow", b"box2i", box), attribute(b"displayWindow", b"box2i", box),
        attribute(b"lineOrder", b"lineOrder", b"\0"), attribute(b"pixelAspectRatio", b"float", struct.pack("<f", 1)),
        attribute(b"screenWindowCenter", b"v2f", struct.pack("<2f", 0, 0)),
        attribute(b"screenWindowWidth", b"float", struct.pack("<f", 1)))) + b"\0"
    numbers = random.Random(1)
    line = struct.pack("<%de" % (3 * WIDTH), *(numbers.uniform(0.1, 4) for _ in range(3 * WIDTH)))
    plain = BLOCK * line
    split = plain[::2] + plain[1::2]
    packed = zlib.compress(bytes([split[0], *((b - a + 128) & 255 for a, b in zip(split, split[1:]))]), 4)
    first, size = len(head) + 8 * (HEIGHT // BLOCK), 8 + len(packed)
    with open(WORK / MAP, "wb") as out:
        out.write(head)
        out.write(struct.pack("<%dQ" % (HEIGHT // BLOCK), *(first + i * size for i in range(HEIGHT // BLOCK))))
        for y in range(0, HEIGHT, BLOCK):
            out.write(struct.pack("<2i", y, len(packed)) + packed)


def prepare(big):
    """The bundled set and a big map, which take a while; else a small set, and no map."""
    shutil.rmtree(WORK, ignore_errors=True)
    WORK.mkdir(parents=True)
    os.chdir(WORK)
    if big:
        run(BUILD / "scenes/shadowcache-make-set", "courtyard", "-o", SET, "--camera", "camera.json")
        write_big_map()
    else:
        Path(SET).write_text("v -2 0 -2\nv 2 0 -2\nv 2 0 2\nv -2 0 2\nv -2 1 -2\nv 0 1 -2\nv 0 1 2\nf 1 4 3 2\nf 5 7 6\n")
        Path("camera.json").write_text(json.dumps({"cam": {"yfov": 0.8, "fps": 24, "frames": [
            {"origin": [3, 2.5, 4], "forward": [-3, -2.2, -4], "up": [0, 1, 0]}]}}))
    run(BUILD / "bake/shadowcache-bake", SET, "-o", "set.vdb", "--spacing", "3" if big else "0.5", "--level", "2", "--rays", "4",
        "--progress", "none")


def main():
    big = PART == "big"
    prepare(big)
    if big:
        ctrl_c()
    else:
        example()
    server = Server()
    server.ask("size", width=192, height=108)
    server.ask("camera", name="camera.json")
    if big:
        stops(server)
        progress(server)
        server.ask("quit")
        assert server.process.wait(10) == 0
        return
    server.ask("load", set=[SET], cache="set.vdb")
    server.ask("environment", radiance=1)
    stops_within_a_tile(server)
    flat_memory(server)
    passes(server)
    ends_with_its_input(server)
    pixels_that_are_removed()
    begins_with_a_byte_order_mark()
    ends_with_its_client()


main()
