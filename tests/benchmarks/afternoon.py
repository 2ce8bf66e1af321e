"""An afternoon's work on the bundled courtyard in Blender, by Shadowcache and by Cycles at equal noise: afternoon.py BUILD WORK

Opens the set, looks at it, turns the sky, moves the camera and renders a final frame, with 4 bounces. Cycles gets the samples
that bring its relMSE, by the difference of two pictures, to that of Shadowcache. Its final frame is not rendered to the end: it
takes the time of one sample, and that of each further one as a few show it. All surfaces are Diffuse BSDFs of their colours:
Principled's diffuse part is another one in Cycles. Prints seconds of the processor, of all processes and with the bakes, and
how far the means are apart. Needs blender on PATH, and a BUILD; takes a quarter of an hour.
"""
import json
import math
import os
import shutil
import subprocess
import sys
import time

SIZES = {"preview": (240, 135), "final": (960, 540)}
RAYS = {"preview": (1, 4), "final": (4, 4)}    # camera rays of a pixel, and shadow rays of each
PILOT = 8                                      # samples of Cycles
TURNS = [60 * i for i in range(1, 5)]          # degrees
CAMERAS = (1, 12, 24)                          # frames of the bundled camera
BOUNCES = 4
TICK = os.sysconf("SC_CLK_TCK")


def family(root):
    """Processor seconds of a process and its children, with those that have ended."""
    parents, spent = {}, {}
    for name in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open("/proc/%s/stat" % name, encoding="ascii", errors="replace") as file:
                fields = file.read().rsplit(") ", 1)[1].split()
        except OSError:  # it has ended
            continue
        parents[int(name)] = int(fields[1])
        spent[int(name)] = sum(map(int, fields[11:15])) / TICK

    def is_ours(process):
        while process in parents and process != root:
            process = parents[process]
        return process == root

    return sum(seconds for process, seconds in spent.items() if is_ours(process))


class Studio:
    """The open set, in Blender."""

    def __init__(self, archive, programs, files, work):
        import bpy
        self.bpy, self.files, self.work = bpy, files, work
        bpy.ops.preferences.addon_install(filepath=archive)
        bpy.ops.preferences.addon_enable(module="shadowcache")
        bpy.context.preferences.addons["shadowcache"].preferences.folder = programs
        sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)),
                                        "../../render/trade/shadowcache_trade"))
        import in_blender
        self.tools = in_blender

    def open(self):
        bpy = self.bpy
        bpy.ops.wm.read_homefile(use_empty=True)
        bpy.ops.preferences.addon_enable(module="shadowcache")
        self.tools.import_gltf(self.files["set"])
        for material in bpy.data.materials:
            self._use_lambert(material.node_tree)
        with open(self.files["camera"], encoding="utf-8") as file:
            track = json.load(file)["cam"]
        for frame in CAMERAS:
            self.tools.add_camera({**track["frames"][frame - 1], "fov": math.degrees(track["yfov"])})
            bpy.context.scene.camera.name = "camera %d" % frame
            bpy.context.scene.camera.data.clip_start, bpy.context.scene.camera.data.clip_end = 0.01, 1000
        self.tools.add_sky(self.files["map"], 0)
        self.tools.choose_settings({"size": SIZES["preview"], "threads": os.cpu_count(), "bounces": BOUNCES})
        settings = bpy.context.scene.shadowcache
        settings.bounces, settings.cache_folder = BOUNCES, os.path.join(self.work, "cache")

    def _use_lambert(self, tree):
        shader = next((node for node in tree.nodes if node.type == "BSDF_PRINCIPLED"), None) if tree else None
        if shader:
            diffuse = self.tools.node_of(tree, "ShaderNodeBsdfDiffuse", Color=shader.inputs["Base Color"])
            tree.links.new(diffuse, tree.get_output_node("CYCLES").inputs["Surface"])

    def render(self, engine, kind, seed=1, samples=None, turn=0, camera=CAMERAS[0]):
        """Linear RGB, and processor and other seconds."""
        import numpy
        bpy = self.bpy
        scene = bpy.context.scene
        scene.render.engine = engine
        scene.render.resolution_x, scene.render.resolution_y = SIZES[kind]
        scene.camera = bpy.data.objects["camera %d" % camera]
        mapping = next(node for node in scene.world.node_tree.nodes if node.type == "MAPPING")
        mapping.inputs["Rotation"].default_value[2] = math.radians(90 - turn)
        scene.cycles.seed = scene.shadowcache.seed = seed
        if engine == "CYCLES":
            scene.cycles.samples = samples
        else:
            scene.shadowcache.camera_rays, scene.shadowcache.samples = samples or RAYS[kind]
        scene.render.filepath = os.path.join(self.work, "%s_%s.exr" % (engine.lower(), kind))
        start, spent = time.perf_counter(), family(os.getpid())
        bpy.ops.render.render(write_still=True)
        seconds = family(os.getpid()) - spent, time.perf_counter() - start
        image = bpy.data.images.load(scene.render.filepath)
        pixels = numpy.empty(len(image.pixels), numpy.float32)
        image.pixels.foreach_get(pixels)
        bpy.data.images.remove(image)
        return pixels.reshape(-1, 4)[:, :3].astype(float), seconds


def noise(a, b, reference):
    """relMSE of one of two pictures of other seeds."""
    return (((a - b) ** 2 / 2) / (reference ** 2 + 0.01 * reference.mean() ** 2)).mean()


class Afternoon:
    def __init__(self, studio):
        self.studio = studio
        self.rows, self.samples, self.noise = {}, {}, {}

    def step(self, name, engine, pictures):
        """Renders some pictures, and adds a row of what they take together."""
        found = [self.studio.render(engine, **picture) for picture in pictures]
        self.rows.setdefault(name, {"pictures": len(found)})[engine] = [sum(s) for s in zip(*(f[1] for f in found))]
        return found[-1][0]

    def finish(self, engine):
        """The final frame. Of Cycles, as many samples cost as a few do."""
        name, picture = "final frame", {"kind": "final", "turn": TURNS[0]}
        if engine == "SHADOWCACHE":
            self.step(name, engine, [picture])
            return
        one, some = (self.studio.render(engine, samples=samples, **picture)[1] for samples in (1, PILOT))
        more = (self.samples["final"] - 1) / (PILOT - 1)
        self.rows[name][engine] = [a + (b - a) * more for a, b in zip(one, some)]

    def choose(self, kind):
        """Samples of Cycles for the noise of Shadowcache."""
        render = self.studio.render
        own = [render("SHADOWCACHE", kind, seed)[0] for seed in (11, 12)]
        reference = (own[0] + own[1]) / 2
        pilot = [render("CYCLES", kind, seed, PILOT)[0] for seed in (11, 12)]
        own_noise, of_pilot = noise(*own, reference), noise(*pilot, reference)
        self.samples[kind] = max(1, round(PILOT * of_pilot / own_noise))
        of_cycles, pictures = of_pilot * PILOT / self.samples[kind], pilot
        if kind == "preview":
            pictures = [render("CYCLES", kind, seed, self.samples[kind])[0] for seed in (13, 14)]
            of_cycles = noise(*pictures, reference)
        self.noise[kind] = {"SHADOWCACHE": own_noise, "CYCLES": of_cycles,
                            "means": (sum(pictures).mean(axis=0) / 2 / reference.mean(axis=0)).tolist()}

    def spend(self):
        for kind in SIZES:
            self.choose(kind)
        for engine in ("SHADOWCACHE", "CYCLES"):
            shutil.rmtree(os.path.join(self.studio.work, "cache"), ignore_errors=True)
            start, spent = time.perf_counter(), family(os.getpid())
            self.studio.open()
            self.rows.setdefault("open the set", {"pictures": 0})[engine] = [family(os.getpid()) - spent,
                                                                         time.perf_counter() - start]

            def view(**more):
                return {"kind": "preview", "samples": self.samples["preview"] if engine == "CYCLES" else None, **more}

            self.step("first picture, with the bake", engine, [view()])
            self.step("the sky turned", engine, [view(turn=turn) for turn in TURNS])
            self.step("other cameras", engine, [view(camera=camera) for camera in CAMERAS[1:]])
            self.finish(engine)

    def show(self):
        print("\n| step | pictures | Shadowcache, s | Cycles, s |\n|---|---|---|---|")
        for name, row in self.rows.items():
            print("| %s | %s | %.1f | %.1f |" % (name, row["pictures"] or "", row["SHADOWCACHE"][0], row["CYCLES"][0]))
        print("| all | %d | %.1f | %.1f |" % (sum(row["pictures"] for row in self.rows.values()),
                                              *(sum(row[e][0] for row in self.rows.values()) for e in ("SHADOWCACHE", "CYCLES"))))
        for kind, found in self.noise.items():
            print("%s, %dx%d: Shadowcache %d camera rays with %d shadow rays each, relMSE %.5f; Cycles %d samples, %.5f; "
                  "means of Cycles over Shadowcache %.4f %.4f %.4f" % (kind, *SIZES[kind], *RAYS[kind], found["SHADOWCACHE"],
                                                                      self.samples[kind], found["CYCLES"], *found["means"]))
        with open(os.path.join(self.studio.work, "afternoon.json"), "w", encoding="ascii") as out:
            json.dump({"rows": self.rows, "samples": self.samples, "noise": self.noise}, out, indent=1)


def in_blender(archive, programs, files, work):
    studio = Studio(archive, programs, json.loads(files), work)
    studio.open()
    afternoon = Afternoon(studio)
    afternoon.spend()
    afternoon.show()


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    build, work = (os.path.abspath(word) for word in sys.argv[1:])
    source = os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, os.pardir)
    shutil.rmtree(work, ignore_errors=True)
    os.makedirs(os.path.join(work, "scripts/addons"))
    files = {"set": os.path.join(work, "courtyard.glb"), "camera": os.path.join(work, "camera.json"),
             "map": os.path.abspath(os.path.join(source, "scenes/maps/courtyard.exr"))}
    subprocess.run([os.path.join(build, "scenes/shadowcache-make-set"), "courtyard", "-o", files["set"], "--camera",
                    files["camera"]], check=True)
    # Blender's Python takes its modules from where the first python3 of PATH has them.
    path = os.pathsep.join(["/usr/bin", os.environ["PATH"]])
    log = os.path.join(work, "blender.log")
    with open(log, "w", encoding="utf-8") as out:
        status = subprocess.run(
            ["blender", "-b", "--factory-startup", "--python-exit-code", "1", "-P", os.path.abspath(__file__), "--",
             os.path.join(build, "shadowcache-blender.zip"), build, json.dumps(files), work], stdout=out, stderr=out,
            env={**os.environ, "PATH": path, "BLENDER_USER_SCRIPTS": os.path.join(work, "scripts")}, check=False).returncode
    with open(log, encoding="utf-8", errors="replace") as file:
        said = file.read()
    if status:
        sys.exit("Blender failed (Debian package: blender):\n" + said[-4000:])
    print(said[said.index("\n| step |") + 1:said.index("\nBlender quit")])


if "--" in sys.argv:
    in_blender(*sys.argv[sys.argv.index("--") + 1:])
else:
    main()
