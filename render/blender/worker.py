# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders what a 3D view wants, in a thread and a process of its own; the last wish counts."""

import threading
import time

from . import draw, passes, pixels, world_map
from .child import Cancelled, Failed
from .coarse import Coarse
from .programs import Missing
from .session import Session
from .view_request import with_size

REST = 0.15     # seconds that a wish must rest before its first picture is refined
PATIENCE = 5.0  # seconds until a process that does not stop is ended: to load its set anew takes longer


class Worker:
    """Knows nothing of Blender's data. `serial` counts pictures and texts; whoever saw the last has seen all."""

    def __init__(self):
        self.serial = 0
        self.status = ""
        self.rows = None        # the last picture, as draw.texture_of wants it
        self.first_seconds = 0  # from a wish to its first picture
        self.is_done = False    # nothing is left to do for the last wish
        self._session = Session()
        self._coarse = Coarse()
        self._changed = threading.Condition()
        self._wish = None
        self._wished_at = 0
        self._is_held = False
        self._is_closed = False
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def wish(self, wish):
        with self._changed:
            if wish != self._wish:
                self._wish, self._wished_at, self.is_done = wish, time.monotonic(), False
                self._changed.notify()

    def hold(self, is_held):
        """Stops, or goes on."""
        with self._changed:
            if is_held != self._is_held:
                self._is_held = is_held
                self._changed.notify()

    def close(self):
        """Ends the process soon; returns at once."""
        with self._changed:
            self._is_closed = True
            self._changed.notify()

    def join(self, seconds):
        self._thread.join(seconds)

    def _has_work(self):
        return self._is_closed or not self._is_held and self._wish is not None and not self.is_done

    def _run(self):
        while True:
            with self._changed:
                self._changed.wait_for(self._has_work)
                if self._is_closed:
                    break
                wish = self._wish
            try:
                self._serve(wish)
            except Cancelled:
                continue
            except (Failed, Missing, OSError, ValueError) as error:
                self._say(str(error))
            with self._changed:
                self.is_done = wish is self._wish
        self._session.close()

    def _ends(self):
        return self._is_closed

    def _is_over(self, wish):
        return self._is_closed or self._is_held or wish is not self._wish

    def _say(self, text):
        self.status = text
        self.serial += 1

    def _calls(self, should_stop, words):
        def on_reply(reply):
            if reply["reply"] == "progress" and words:
                self._say("%s: %s %d %%" % (words, reply["task"], 100 * reply["done"] / max(reply["total"], 1)))
        return {"should_stop": should_stop, "on_reply": on_reply, "patience": PATIENCE}

    def _serve(self, wish):
        self._session.serve(wish.programs, lambda: self._pictures(wish))

    def _pictures(self, wish):
        note = self._set_up(wish)
        for number, share in enumerate(self._coarse.shares()):
            is_first = number == 0
            picture = self._small(wish, share, is_first)
            self._show(picture, "%d %% of the size%s" % (100 * share, note))
            if is_first:
                self.first_seconds = time.monotonic() - self._wished_at
                self._coarse.took(picture["seconds"]["render"])
                self._rest(wish)
        self._whole(wish, note)

    def _rest(self, wish):
        with self._changed:
            if self._changed.wait_for(lambda: self._is_over(wish), REST):
                raise Cancelled

    def _set_up(self, wish):
        """Set and world; returns what is to be said of the cache."""
        loaded = self._session.load(wish.load, **self._calls(self._ends, "Load"))
        self._session.dim(wish.gains)
        light = world_map.keys_of(wish.world, lambda: self._is_over(wish), self._say)
        self._session.light(light, **self._calls(self._ends, "World"))
        stale = "the cache is of another state of the set: F12 bakes it again" if loaded["stale"] else ""
        return "".join(", " + text for text in (wish.note, stale) if text)

    def _small(self, wish, share, is_first):
        """A picture on the way: what the cache predicts, or one ray where there is none."""
        options = dict(wish.options)
        for name in ("camera-rays", "samples", "pass-rays"):
            options.pop(name)
        options.update({"preview": True, "spp": 0} if "cache" in wish.load else {"spp": 1})
        width, height = (max(1, round(share * side)) for side in wish.size)
        # A first picture is not stopped: while the view turns there would be none.
        should_stop = self._ends if is_first else lambda: self._is_over(wish)
        return self._render(wish, (width, height), options, self._calls(should_stop, ""))

    def _whole(self, wish, note):
        total = wish.options["camera-rays"]

        def on_reply(reply):
            if reply["reply"] == "picture":
                self._show(reply, "%d of %d rays%s" % (reply["rays"], total, note))
        calls = self._calls(lambda: self._is_over(wish), "")
        picture = self._render(wish, wish.size, wish.options, {**calls, "on_reply": on_reply})
        self._show(picture, "%d rays%s" % (total, note))

    def _render(self, wish, size, options, calls):
        self._session.look(with_size(wish.view, wish.aspect, *size), *size)
        self._session.tell("options", options)
        return self._session.render(wish.frame, **calls)

    def _show(self, reply, text):
        self.rows = draw.rows_of(passes.Picture(reply["planes"], pixels.read(reply["pixels"])).combined())
        self._say(text)
