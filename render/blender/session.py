# SPDX-License-Identifier: GPL-3.0-or-later
"""A resident process and what it was told: only what differs is sent again."""

import os

from . import pixels, programs
from .child import Cancelled, Failed, Gone
from .client import Server


def stamp(path):
    """Changes whenever a file is written."""
    try:
        found = os.stat(path)
    except OSError:
        return None
    return found.st_mtime_ns, found.st_size, found.st_ino


class Session:
    def __init__(self):
        self.server = None
        self.told = {}
        self.pixels = None

    def start(self, folder):
        """Makes sure that the process of a folder's program runs; whether it was started now."""
        program = programs.find("shadowcache-render", folder)
        if self.server and (self.server.program != program or not self.server.is_alive()):
            self.close()
        if self.server:
            return False
        self.server = Server(program)
        self.pixels = pixels.new_path()
        return True

    def serve(self, folder, work):
        """work() while the process runs; once more where one that was there before has ended for reasons of its own."""
        is_new = self.start(folder)
        try:
            return work()
        except Gone:
            if is_new:
                raise
        self.start(folder)
        return work()

    def load(self, fields, **calls):
        """The set, and its cache if there is one."""
        before = self.told.get("load")
        reply = self.tell("load", fields, [*fields["set"], fields.get("cache", "")], **calls)
        if self.told["load"] is not before:
            self.told.pop("lamps", None)  # they are as the file has them
        return reply

    def dim(self, gains):
        """Has lamps shine with other gains than the file's."""
        if gains or "lamps" in self.told:
            self.tell("lamps", {"lamp": list(gains)})

    def light(self, fields, **calls):
        return self.tell("environment", fields, [fields["map"]] if "map" in fields else (), **calls)

    def look(self, view, width, height):
        self.tell("size", {"width": width, "height": height})
        self.tell("camera", {"view": view})

    def tell(self, request, fields, watch=(), **calls):
        """Sends a request unless it was the last of its kind; `watch` are files whose content counts.
        Returns the reply, also the one of then."""
        key = (fields, [stamp(path) for path in watch])
        if request in self.told and self.told[request][0] == key:
            return self.told[request][1]
        self.told.pop(request, None)
        reply = self._ask(request, fields, calls)
        self.told[request] = key, reply
        return reply

    def render(self, frame, **calls):
        """Renders into the file of pixels."""
        return self._ask("render", {"pixels": self.pixels, "frame": frame, "progressive": True}, calls)

    def _ask(self, request, fields, calls):
        """The reply, with the texts that were logged before it as its "notes"."""
        notes, tell = [], calls.get("on_reply", lambda reply: None)

        def on_reply(reply):
            if reply["reply"] == "log":
                notes.append(reply["text"])
            tell(reply)

        try:
            return {**self.server.ask(request, **{**calls, "on_reply": on_reply}, **fields), "notes": notes}
        except (Failed, Cancelled):
            if not self.server.is_alive():
                self.close()
            if request in ("load", "environment"):
                self.told.pop(request, None)
            raise

    def close(self):
        if self.server:
            self.server.close()
        pixels.remove(self.pixels)
        self.server, self.told, self.pixels = None, {}, None
