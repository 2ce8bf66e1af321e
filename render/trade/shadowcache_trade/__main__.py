"""Measures what accuracy costs on a set and a shot of one's own, and prints the options to use.

Bakes the set with a ladder of spacings, levels and rays, one changed at a time, and at last with the best of each.
Renders antialiased pictures with each cache, without one (`mis`), and with Cycles where Blender is installed, and measures
their errors against a reference.
Writes OUTPUT.json, OUTPUT.png and OUTPUT.svg: the curves with their knee. Seconds are of the processor, over the threads.
"""
import argparse
import json
import os
import shlex
import shutil
import signal
import sys
import tempfile

INTERRUPTED = 75  # as the programs end


def parser():
    parse = argparse.ArgumentParser(prog="shadowcache_trade", allow_abbrev=False, description=__doc__,
                                    formatter_class=argparse.RawDescriptionHelpFormatter)
    parse.add_argument("set", nargs="+", help="geometry files that make one set")
    parse.add_argument("--env", required=True, help="map: OpenEXR or Radiance HDR")
    parse.add_argument("--env-rotate", type=float, default=0.0, help="degrees about +Y [%(default)s]")
    parse.add_argument("--camera", required=True, help="camera file (JSON), or the name of a camera of a glTF set")
    parse.add_argument("--frames", default="1", help="frames of the shot, A or A-B; the middle one is measured [1]")
    parse.add_argument("--up", choices=["y", "z"], default="y", help="up axis of the files [%(default)s]")
    parse.add_argument("--scale", type=float, default=1.0, help="metres per unit of the files [1]")
    parse.add_argument("--delivered", default="1920x1080", help="size of the shot's pictures [%(default)s]")
    parse.add_argument("--size", default="320x180", help="size of the measured pictures [%(default)s]")
    parse.add_argument("--seeds", type=int, default=3, help="renders to average over [%(default)s]")
    parse.add_argument("--reference-rays", type=int, default=512,
                       help="camera rays of a pixel of the reference, of 4 samples each [%(default)s]")
    parse.add_argument("--spacings", default="2,1.4,0.7", help="over the default spacing [%(default)s]")
    parse.add_argument("--levels", default="2,3,4", help="[%(default)s]")
    parse.add_argument("--rays", default="2,4,8,32", help="[%(default)s]")
    parse.add_argument("--whole-set", action="store_true", help="bake all of the set, for any camera, not for the shot alone")
    parse.add_argument("--bounces", type=int, default=0, help="of the measured pictures [%(default)s]")
    parse.add_argument("--threads", type=int, default=0, help="0: one per core [%(default)s]")
    parse.add_argument("--bake-program", default="shadowcache-bake", help="[%(default)s]")
    parse.add_argument("--cycles", metavar="BLENDER", help="renders the shot with Cycles, too [blender, if installed]")
    parse.add_argument("--no-cycles", action="store_true", help="leave Cycles out")
    parse.add_argument("-o", "--output", default="trade", help="name of the files, without extension [%(default)s]")
    return parse


def size_of(text, option):
    width, cross, height = text.partition("x")
    if not (cross and width.isdigit() and height.isdigit() and int(width) > 0 and int(height) > 0):
        raise RuntimeError(f"{option} {text}: expected WxH, as in 320x180")
    return int(width), int(height)


def frames_of(text):
    first, _, last = text.partition("-")
    last = last or first
    if not (first.isdigit() and last.isdigit() and int(first) <= int(last)):
        raise RuntimeError(f"--frames {text}: expected A or A-B")
    return int(first), int(last)


def numbers_of(text, kind, option, least, most):
    try:
        numbers = [kind(word) for word in text.split(",") if word]
    except ValueError:
        numbers = [None]
    if not all(number is not None and least <= number <= most for number in numbers):
        raise RuntimeError(f"{option} {text}: expected numbers from {least} to {most}, joined by commas")
    return numbers


def require_range(value, option, least, most):
    if not least <= value <= most:
        raise RuntimeError(f"{option} {value}: expected {least} to {most}")


def ladder_of(arguments):
    from .ladder import ladder
    return ladder(numbers_of(arguments.spacings, float, "--spacings", 0.1, 20.0),
                  numbers_of(arguments.levels, int, "--levels", 0, 5),
                  numbers_of(arguments.rays, int, "--rays", 1, 255))


def blender_of(arguments):
    """Path of Blender; None: Cycles is left out."""
    if arguments.no_cycles:
        return None
    found = shutil.which(arguments.cycles or "blender")
    if arguments.cycles and not found:
        raise RuntimeError(f"--cycles {arguments.cycles}: no such program")
    return found


def shot_of(arguments, work):
    """Loads what is measured, after all options were looked at."""
    import shadowcache
    from .measure import Shot
    size, delivered = size_of(arguments.size, "--size"), size_of(arguments.delivered, "--delivered")
    first, last = frames_of(arguments.frames)
    middle = (first + last) // 2
    choices = ladder_of(arguments)
    require_range(arguments.seeds, "--seeds", 2, 1000)
    require_range(arguments.reference_rays, "--reference-rays", 2, 65536)
    program = shutil.which(arguments.bake_program)
    if not program:
        raise RuntimeError(f"{arguments.bake_program}: no such program; --bake-program names it")
    threads = arguments.threads or len(os.sched_getaffinity(0))
    shadowcache.set_threads(threads)
    scene = shadowcache.load_set(arguments.set, up=arguments.up, scale=arguments.scale)
    set_options = [] if arguments.up == "y" else ["--up", arguments.up]
    set_options += [] if arguments.scale == 1 else ["--scale", repr(arguments.scale)]
    return Shot(arguments.set, arguments.env, ["--camera", arguments.camera, "--frames", arguments.frames], set_options,
                program, scene, shadowcache.Environment.load(arguments.env, rotate=arguments.env_rotate),
                scene.camera(arguments.camera, frame=middle), middle, last - first + 1, size, delivered,
                arguments.seeds, arguments.reference_rays, arguments.whole_set, work, arguments.bounces,
                choices=choices, threads=threads, up=arguments.up, scale=arguments.scale, cycles=blender_of(arguments))


def require_output(name):
    """Fails before hours are spent, not after."""
    folder = os.path.dirname(name) or "."
    if not os.path.isdir(folder) or not os.access(folder, os.W_OK):
        raise RuntimeError(f"{folder}: no folder that can be written to")
    try:
        import matplotlib.figure  # noqa: F401
    except ImportError as error:
        raise RuntimeError("the curves need matplotlib (Debian package: python3-matplotlib)") from error


def write_beside(path, write):
    """write(path of a part), and then its name: nobody sees half a file."""
    folder, name = os.path.split(path)
    part = os.path.join(folder, ".part-" + name)
    try:
        write(part)
        os.replace(part, path)
    finally:
        if os.path.exists(part):
            os.remove(part)


def write_files(result, shot, command, output):
    from .plot import draw
    from .report import record

    def write_record(path):
        with open(path, "w", encoding="utf-8") as file:
            json.dump(record(result, shot, command), file, indent=1)
            file.write("\n")

    names = ", ".join(os.path.basename(path) for path in shot.files)
    figure = draw(result, shot, f"{names} under {os.path.basename(shot.environment)}: what accuracy costs")
    write_beside(output + ".json", write_record)
    for extension in ("png", "svg"):
        write_beside(f"{output}.{extension}", figure.savefig)


def measure(arguments, command):
    from .measure import Meter
    from .report import summary
    require_output(arguments.output)
    with tempfile.TemporaryDirectory(prefix="shadowcache-trade-") as work:
        shot = shot_of(arguments, work)
        result = Meter(shot).run()
    write_files(result, shot, command, arguments.output)
    print(summary(result, shot, os.path.splitext(os.path.basename(arguments.set[0]))[0] + ".vdb"))


def main():
    arguments = parser().parse_args()
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # the folder of the caches is removed then, too
    try:
        measure(arguments, shlex.join(["python3", "-m", "shadowcache_trade", *sys.argv[1:]]))
    except KeyboardInterrupt:
        print("\nshadowcache_trade: interrupted", file=sys.stderr)
        return INTERRUPTED
    except (RuntimeError, OSError, ValueError) as error:  # shadowcache.Error is a RuntimeError
        print(f"shadowcache_trade: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
