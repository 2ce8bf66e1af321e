"""How far a measurement is, on stderr, with the time left."""
import sys
import time


class Progress:
    """Steps of several kinds, each with an amount of work; the seconds of a kind are learnt from its first step."""

    def __init__(self, steps, out=None):
        self.left = list(steps)  # (kind, work)
        self.count = len(self.left)
        self.spent = {}  # kind: [seconds, work]
        self.out = sys.stderr if out is None else out
        self.shown = 0.0

    def add(self, steps):
        self.left += steps
        self.count += len(steps)

    def time_left(self, of_step=0.0):
        """As text, of the kinds that were seen; `of_step`: how much of the step under way is done, 0 to 1."""
        total, unseen = 0.0, False
        for i, (kind, work) in enumerate(self.left):
            seconds, done = self.spent.get(kind, (0.0, 0.0))
            unseen = unseen or not done
            total += seconds / done * work * (1 - of_step if i == 0 else 1) if done else 0.0
        return f", {'over ' if unseen else ''}{duration(total)} left" if total else ""

    def run(self, label, action):
        """Does the first of the steps that are left: action(progress callback)."""
        number = self.count - len(self.left) + 1
        kind, work = self.left[0]
        begin = time.monotonic()

        def report(_task, done, total):
            if self.out.isatty() and time.monotonic() - self.shown > 0.2:
                self.shown = time.monotonic()
                share = done / total if total else 0.0
                self.out.write(f"\r{self.line(number, label, f'{100 * share:.0f} %', share)}\033[K")
                self.out.flush()

        report(label, 0, 1)
        result = action(report)
        spent = self.spent.setdefault(kind, [0.0, 0.0])
        spent[0] += time.monotonic() - begin
        spent[1] += work
        self.left.pop(0)
        text = self.line(number, label, f"{time.monotonic() - begin:.1f} s", 0.0)
        self.out.write(f"\r{text}\033[K\n" if self.out.isatty() else text + "\n")
        self.out.flush()
        return result

    def line(self, number, label, state, share):
        return f"[{number}/{self.count}] {label}: {state}{self.time_left(share)}"


def duration(seconds):
    if seconds < 100:
        return f"{seconds:.0f} s"
    minutes = seconds / 60
    return f"{minutes:.0f} min" if minutes < 100 else f"{minutes / 60:.1f} h"
