# SPDX-License-Identifier: GPL-3.0-or-later
"""Talks to shadowcache-render --serve (docs/serve.md)."""

import json
import queue
import subprocess
import threading
import time

from .child import PATIENCE, Cancelled, Child, Failed, Gone

LAST = ("done", "error", "stopped")


class Server:
    """A process that holds a set and its light. Calls wait; only one thread may call."""

    def __init__(self, program):
        self.child = Child([program, "--serve"], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self.program = program
        self._last = 0
        self._replies = queue.SimpleQueue()
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self):
        for line in self.child.process.stdout:
            try:
                self._replies.put(json.loads(line))
            except ValueError:
                break
        self._replies.put(None)

    def is_alive(self):
        return self.child.process.poll() is None

    def _send(self, request, **fields):
        self._last += 1
        line = json.dumps({"id": self._last, "request": request, **fields}) + "\n"
        try:
            self.child.process.stdin.write(line.encode())
            self.child.process.stdin.flush()
        except OSError:
            raise self._gone() from None
        return self._last

    def _gone(self):
        self.child.wait(PATIENCE)
        said = self.child.last_message()
        return Gone("shadowcache-render has ended with status %s%s"
                    % (self.child.process.poll(), ": " + said if said else ""))

    def ask(self, request, should_stop=lambda: False, on_reply=lambda reply: None, patience=PATIENCE, **fields):
        """The last reply to a request; on_reply gets those before it: progress, log, picture.
        Raises Failed with the program's words, or Cancelled soon after should_stop(): a process that has not
        stopped after `patience` seconds is ended."""
        number = self._send(request, **fields)
        stop_at = None
        while True:
            try:
                reply = self._replies.get(timeout=0.02)
            except queue.Empty:
                reply = {}
            if reply is None:
                if stop_at or should_stop():
                    raise Cancelled
                raise self._gone()
            kind = reply.get("reply")
            if reply.get("id") == number and kind in LAST:
                if kind == "error":
                    raise Failed(reply["error"])
                if kind == "stopped" or stop_at:
                    raise Cancelled
                return reply
            if kind and reply.get("id") == number and not stop_at:
                on_reply(reply)
            if not stop_at and should_stop():
                stop_at = time.monotonic()
                self._send("stop")
            if stop_at and time.monotonic() > stop_at + patience:
                self.close(0)
                raise Cancelled

    def close(self, patience=PATIENCE):
        """Ends the process, by force after so many seconds; what it renders is lost."""
        process = self.child.process
        try:
            process.stdin.close()  # it ends with its input, and removes its files of pixels
        except OSError:
            pass
        self.child.wait(patience)
        if process.poll() is None:
            process.kill()
            process.wait()
        self._reader.join(1)
        self.child.end()
