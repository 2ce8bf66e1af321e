# SPDX-License-Identifier: GPL-3.0-or-later
"""A 3D view in Rendered shading: sees what has changed, and draws what its worker has.

No pointer to Blender's data is kept between calls.
"""

import os
import time
import weakref

import bpy

from . import draw, fingerprint, preferences, scene_check, view_request, world_map
from .folders import folder_of, set_file_of
from .options import options_of
from .session import stamp
from .set_file import SetFile
from .wish import Wish
from .worker import Worker

REST = 0.3       # seconds that a set must rest before it is looked at
INTERVAL = 0.02  # seconds between looks for news
# What is no part of a set.
OTHER = (bpy.types.World, bpy.types.Scene, bpy.types.Camera, bpy.types.Screen)
OTHER_OBJECTS = {"CAMERA", "LIGHT_PROBE", "SPEAKER"}
LIVE = weakref.WeakSet()


class Viewport:
    """Of one view. Its methods are called in Blender's main thread."""

    def __init__(self):
        self.worker = Worker()
        self._set_left_out = None  # not yet known
        self._world_left_out = []
        self._scene_left_out = []
        self._due_at = 0.0       # when the set is to be looked at; None: the file holds it
        self._places = None
        self._set_file = None
        self._gains = ()         # of its lamps
        self._shot = None        # the set of F12, and its stamp
        self._world = None       # as a Wish has it
        self.error = ""
        self._texture = None
        self._rows = None        # of the texture
        self._seen = 0           # of the worker's serial
        LIVE.add(self)
        if not bpy.app.timers.is_registered(tick):
            bpy.app.timers.register(tick, persistent=True)

    @property
    def left_out(self):
        """Of the set, the world and the scene; None: not yet known."""
        if self._set_left_out is None:
            return None
        return self._set_left_out + self._world_left_out + self._scene_left_out

    def close(self):
        LIVE.discard(self)
        self.worker.close()

    def wants_redraw(self):
        due = self._due_at is not None and time.monotonic() > self._due_at
        return due or self._seen != self.worker.serial

    def update(self, depsgraph):
        """Something has changed in the scene."""
        places = fingerprint.current_places(depsgraph)
        if self._set_file and (places != self._places or changes_set(depsgraph)):
            self._due_at = time.monotonic() + REST
        self._places = places
        self._scene_left_out = scene_check.left_out(depsgraph, depsgraph.scene.camera)
        try:
            self._update_world(depsgraph)
            self.error = ""
        except (OSError, ValueError) as error:
            self.error = str(error)

    def draw(self, engine, context, depsgraph):
        if not self.error:
            try:
                self._update_set(depsgraph)
                self.worker.wish(self._wish(engine, context, depsgraph))
            except (OSError, ValueError) as error:
                self.error = str(error)
        self._seen = self.worker.serial
        rows = self.worker.rows
        if rows is not self._rows:
            self._texture, self._rows = draw.texture_of(rows), rows
        if self._texture:
            draw.draw(engine, depsgraph.scene, self._texture, context.region.width, context.region.height)
        engine.update_stats("", self.error or self.worker.status)

    def _update_world(self, depsgraph):
        scene = depsgraph.scene
        light, self._world_left_out = world_map.light_of(scene, depsgraph.view_layer, folder_of(scene))
        if light != self._world:
            if isinstance(light, world_map.Baking):
                light.prepare(scene.world)
            self._world = light

    def _update_set(self, depsgraph):
        """Finds the file that holds the set: that of F12, or one of the views' own."""
        shot = set_file_of(depsgraph.scene, depsgraph.view_layer.name)
        found = shot.path, stamp(shot.path)
        if found != self._shot:
            self._shot, self._due_at = found, self._due_at or 0.0
        if self._due_at is None or time.monotonic() < self._due_at:
            return
        self._due_at = None
        state = fingerprint.State(depsgraph)
        if shot.holds(state, depsgraph.scene):
            self._set_file = shot
        else:
            folder, name = os.path.split(shot.path)
            own = SetFile(os.path.join(folder, "viewport"), os.path.splitext(name)[0])
            own.cache = shot.cache
            if not own.holds(state, depsgraph.scene):
                own.export(depsgraph, state)
            self._set_file = own
        self._set_left_out = self._set_file.left_out(state)
        self._gains = tuple(self._set_file.gains(state))

    def _wish(self, engine, context, depsgraph):
        scene, space, region = depsgraph.scene, context.space_data, context.region
        cache = self._set_file.cache
        is_baked = os.path.exists(cache)
        load = self._set_file.load_fields(scene, cache if is_baked else None)
        camera = space.camera if space.use_local_camera else scene.camera
        view, aspect = view_request.view_of(context.region_data, camera, depsgraph)
        pixel = engine.get_preview_pixel_size(scene)
        settings = scene.shadowcache
        return Wish(programs=preferences.program_folder(), load=load, stamps=(stamp(self._set_file.path), stamp(cache)),
                    gains=self._gains, world=self._world, view=view, aspect=aspect,
                    size=(max(1, region.width // pixel), max(1, region.height // pixel)),
                    options=options_of(scene, settings.viewport_rays, settings.samples, pass_rays=1),
                    frame=scene.frame_current, note="" if is_baked else "no cache: F12 bakes it")


def changes_set(depsgraph):
    """Whether something was changed that a set may be made of."""
    tree = depsgraph.scene.world and depsgraph.scene.world.original.node_tree
    for update in depsgraph.updates:
        thing = update.id.original
        if isinstance(thing, OTHER) or thing == tree:
            continue
        if isinstance(thing, bpy.types.Object) and thing.type in OTHER_OBJECTS:
            continue
        if isinstance(thing, bpy.types.Light) or update.is_updated_geometry or update.is_updated_shading or update.is_updated_transform:
            return True
    return False


def tick():
    """A timer: has views drawn that have news. Ends with the last of them."""
    is_held = bpy.app.is_job_running("RENDER")
    news = False
    for viewport in list(LIVE):
        viewport.worker.hold(is_held)
        news = viewport.wants_redraw() or news
    if news:
        for window in bpy.context.window_manager.windows:
            for area in window.screen.areas:
                if area.type == "VIEW_3D":
                    redraw(area)
    return INTERVAL if LIVE else None


def redraw(area):
    for region in area.regions:
        if region.type == "WINDOW":
            region.tag_redraw()


def close_all():
    """Ends all processes; a view that is drawn again begins anew."""
    for viewport in list(LIVE):
        viewport.close()
    if bpy.app.timers.is_registered(tick):
        bpy.app.timers.unregister(tick)
