# SPDX-License-Identifier: GPL-3.0-or-later
"""A process that ends: within a second when it is told to, and with Blender if that is killed."""

import os
import shutil
import subprocess
import tempfile

MOST_MESSAGES = 1 << 16  # bytes
PATIENCE = 0.7  # seconds until a process that was told to end is killed


class Cancelled(Exception):
    """The user wants no more of it."""


class Failed(Exception):
    """A program has refused or failed; the text is its own."""


def die_with_parent(command):
    """The command, ended by the system if Blender dies; for programs that read no input whose end would tell them."""
    tool = shutil.which("setpriv")
    return [tool, "--pdeathsig", "TERM", *command] if tool else command


class Gone(Failed):
    """A program that was to stay has ended."""


class Child:
    """A process whose messages are kept."""

    def __init__(self, command, **options):
        self.name = command[-1] if len(command) == 1 else command[0].rsplit("/", 1)[-1]
        self.messages = tempfile.TemporaryFile()
        try:
            self.process = subprocess.Popen(command, stderr=self.messages, **options)
        except OSError as error:
            self.messages.close()
            raise Failed("%s: %s" % (command[0], error.strerror)) from error

    def last_lines(self):
        """The end of its messages. It shares the place in their file, which stays where it writes."""
        file = self.messages.fileno()
        size = os.fstat(file).st_size
        return os.pread(file, MOST_MESSAGES, max(0, size - MOST_MESSAGES)).decode("utf-8", "replace").splitlines()

    def last_message(self):
        """The last line that is no progress."""
        lines = [line for line in self.last_lines() if line.strip() and not line.startswith("{")]
        return lines[-1] if lines else ""

    def wait(self, seconds):
        """Whether it ends in so many seconds."""
        try:
            self.process.wait(seconds)
        except subprocess.TimeoutExpired:
            return False
        return True

    def end(self):
        """Ends it, and returns when it has ended."""
        if self.process.poll() is None:
            self.process.terminate()
            if not self.wait(PATIENCE):
                self.process.kill()
                self.process.wait()
        for pipe in (self.process.stdin, self.process.stdout):
            if pipe:
                try:
                    pipe.close()
                except OSError:  # what could not be written
                    pass
        if not self.messages.closed:
            self.messages.close()


def run(command, should_stop, on_wait=lambda child: None):
    """Runs a command to its end; on_wait(child) is called ten times a second. Raises Cancelled, Failed."""
    child = Child(die_with_parent(command), stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
    try:
        while not child.wait(0.1):
            if should_stop():
                raise Cancelled
            on_wait(child)
        if child.process.returncode:
            # Ctrl-C goes to both of us.
            if should_stop():
                raise Cancelled
            raise Failed(child.last_message() or "%s has ended with status %d"
                         % (command[0], child.process.returncode))
    finally:
        child.end()

