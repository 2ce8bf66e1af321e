# SPDX-License-Identifier: GPL-3.0-or-later
"""From a depsgraph to a picture: set, cache, light, camera, pixels."""

from . import bake, hybrid, light_groups, passes, pixels, preferences, scene_check, view, world_map
from .child import Cancelled
from .folders import folder_of, set_file_of
from .options import options_of
from .set_file import fps

MENDED = " % of the light"  # in a note on a map with light below 0, which Cycles has
PASS_RAYS = 16  # camera rays of a pixel after which a picture is shown, and a render can be stopped


class Job:
    """What frames of one render have in common; a new one begins with each render."""

    def __init__(self):
        self.exported = set()    # names of sets whose motion was recorded
        self.baked_for = set()   # names of sets whose cache serves all frames
        self.left_out = None     # the last list that was reported


class Frame:
    """One picture. `engine` gives size, status and the wish to stop; what is left out is in left_out."""

    def __init__(self, engine, depsgraph, session, job):
        self.engine = engine
        self.depsgraph = depsgraph
        self.scene = depsgraph.scene
        # With the values of the frame: in an animation the original scene keeps those that it had before.
        self.evaluated = depsgraph.scene_eval
        self.settings = self.evaluated.shadowcache
        self.session = session
        self.job = job
        self.set_file = set_file_of(self.scene, depsgraph.view_layer.name)
        self.programs = preferences.program_folder()
        self.left_out = []
        self.wanted = passes.wanted(depsgraph.view_layer)
        self.is_hybrid = hybrid.is_on(self.scene.original)
        self.lights_lamps = not self.is_hybrid or hybrid.lights_lamps(self.scene.original)
        self.state = None
        self.groups = []  # rules of light groups

    def _stopped(self):
        return self.engine.test_break()

    def _say(self, text, share=None):
        self.engine.update_stats("", text)
        if share is not None:
            self.engine.update_progress(min(max(share, 0), 1))

    def _calls(self, words):
        """How requests report and stop."""
        def on_reply(reply):
            if reply["reply"] == "progress":
                self._say("%s: %s" % (words, reply["task"]), reply["done"] / max(reply["total"], 1))
            elif reply["reply"] == "log":
                print("Shadowcache: " + reply["text"])
        return {"should_stop": self._stopped, "on_reply": on_reply}

    def render(self, on_picture=lambda picture: None):
        """The Picture; on_picture(picture) for those on the way to it. Raises Failed, Cancelled and what the export
        raises."""
        self._export()
        return self.session.serve(self.programs, lambda: self._render(on_picture))

    def _render(self, on_picture):
        self._load(on_picture)
        self._tell_view()
        return self._pixels(on_picture)

    def _tell_view(self):
        """What is seen of the set, and by which light."""
        if self.lights_lamps:
            self.session.dim(self.set_file.gains(self.state))
        self._tell_light()
        width, height = view.size_of(self.scene)
        self.session.look(self._camera(), width, height)
        self.session.tell("region", view.region_of(self.scene))

    def _set_frame(self, frame):
        if self._stopped():
            raise Cancelled
        self.engine.frame_set(frame, 0.0)

    def _export(self):
        self._say("Export")
        name = self.set_file.path
        records = name not in self.job.exported and self._is_among_frames()
        self.job.exported.add(name)
        # Cycles' shadow rays end at glass.
        state = self.set_file.update(self.depsgraph, self._set_frame if records else None, self.settings.use_motion,
                                     panes=not self.is_hybrid)
        self.state = state
        if self.is_hybrid:  # Cycles has what the set has not
            hybrid.prepare(self.depsgraph, self._camera_object(), self.set_file.left_out(state), self.set_file.path)
        else:
            self.left_out += self.set_file.left_out(state)
            self.left_out += scene_check.left_out(self.depsgraph, self._camera_object())
        self.left_out += passes.left_out(self.depsgraph.view_layer)
        if self.is_hybrid:
            self.left_out += ["pass %s%s" % (light_groups.PREFIX, name)
                              for name in light_groups.names(self.depsgraph.view_layer)]
        else:
            self.groups, left_out = light_groups.rules_of(self.depsgraph, self.set_file.path)
            self.left_out += left_out

    def _is_among_frames(self):
        """Whether the frame is one of those in which motion is recorded; else the file is of this one alone."""
        scene = self.scene
        return scene.frame_start <= scene.frame_current <= scene.frame_end and not scene.frame_subframe

    def _camera_object(self):
        return self.engine.camera_override or self.scene.camera

    def _camera(self):
        thing = self._camera_object()
        return view.view_of(thing and thing.evaluated_get(self.depsgraph), self.scene)

    def _views(self):
        """Of the frames that the cache is to serve: once for an animation, else of this one."""
        current = self.scene.frame_current
        frames = {current: self._camera()}
        if self.engine.is_animation and self.set_file.path not in self.job.baked_for:
            scene = self.scene
            for frame in range(scene.frame_start, scene.frame_end + 1, scene.frame_step):
                self._set_frame(frame)
                camera = view.camera_at(scene, frame)
                frames[frame] = view.view_of(camera and camera.evaluated_get(self.depsgraph), scene)
            self._set_frame(current)
        self.job.baked_for.add(self.set_file.path)
        return bake.Views(frames, view.size_of(self.scene))

    def _load(self, on_picture):
        if self.set_file.all_moves():
            self._tell_load(None)  # there is nothing to bake
            return
        recipe = bake.Recipe(self.settings)
        views = self._views()
        why = bake.why_bake(self.set_file, recipe, views)
        if why:
            self._bake(recipe, views, why, on_picture)
        if self._tell_load(self.set_file.cache)["stale"] and self.settings.stale == "BAKE":
            self._bake(recipe, views, "the set has changed", on_picture)
            self._tell_load(self.set_file.cache)

    def _tell_load(self, cache):
        self._say("Load")
        fields = self.set_file.load_fields(self.scene, cache, lamps=self.lights_lamps)
        return self.session.load(fields, **self._calls("Load"))

    def _bake(self, recipe, views, why, on_picture):
        def on_progress(task, share, left):
            self._say("Bake (%s): %s %d %%, %s left" % (why, task, 100 * share, bake.time_text(left)), share)
        self._show_first(on_picture)
        self.session.close()  # two of them may not fit into memory
        self._say("Bake (%s)" % why, 0)
        bake.bake(self.set_file, recipe, views, self.scene, self.programs, self._stopped, on_progress)
        self.session.start(self.programs)

    def _show_first(self, on_picture):
        """A picture to look at during a bake: without a cache, of one ray a pixel."""
        if self.is_hybrid:
            return  # it would lack what Cycles adds
        self._tell_load(None)
        self._tell_view()
        self.session.tell("options", options_of(self.evaluated, 1, 1))
        on_picture(self._picture(self.session.render(self.scene.frame_current, **self._calls("First picture"))))

    def _tell_light(self):
        self._say("World")
        layer = self.depsgraph.view_layer_eval
        light, left_out = world_map.light_of(self.evaluated, layer, folder_of(self.scene))
        if isinstance(light, world_map.Baking):
            light.prepare(self.evaluated.world)
        reply = self.session.light(world_map.keys_of(light, self._stopped, self._say), **self._calls("World"))
        left_out = left_out + ["world %s: %s" % (self.scene.world.name, note) for note in reply["notes"] if MENDED in note]
        self.left_out += [entry for entry in left_out if entry not in self.left_out]

    def _pixels(self, on_picture):
        aovs, of_centre = passes.aovs_of(self.wanted)
        calls = self._calls("Render")
        if of_centre:
            self.session.tell("options", options_of(self.evaluated, 1, 1, of_centre, PASS_RAYS, self.is_hybrid,
                                                    self.groups))
            centre = self._picture(self.session.render(self.scene.frame_current, **calls))
        rays = None if self.settings.target_error else self.settings.camera_rays
        self.session.tell("options", options_of(self.evaluated, rays, self.settings.samples, aovs, PASS_RAYS,
                                                self.is_hybrid, self.groups))
        plain = calls["on_reply"]

        def on_reply(reply):
            if reply["reply"] == "picture":
                on_picture(self._picture(reply))
            else:
                plain(reply)

        calls["on_reply"] = on_reply
        self._say("Render", 0)
        picture = self._picture(self.session.render(self.scene.frame_current, **calls))
        if of_centre:
            picture.add(centre)
        return picture

    def _picture(self, reply):
        picture = passes.Picture(reply["planes"], pixels.read(reply["pixels"]))
        if not self.is_hybrid:
            light_groups.join_sky(picture, self.groups, light_groups.of_world(self.scene))
        return picture
