# SPDX-License-Identifier: GPL-3.0-or-later
"""How small a first picture is, so that it is there at once."""

TARGET = 0.06        # seconds that a first picture may take to render: with what it takes to show it, 15 a second
SMALLEST, LARGEST = 1 / 16, 1 / 2
MOST_STEP = 2        # of one picture to the next


class Coarse:
    """Share of the sides of the view; learns from the time of each first picture."""

    def __init__(self):
        self.share = 1 / 4

    def took(self, seconds):
        step = (TARGET / max(seconds, 1e-6)) ** 0.5
        step = min(max(step, 1 / MOST_STEP), MOST_STEP)
        self.share = min(max(self.share * step, SMALLEST), LARGEST)

    def shares(self):
        """Of the pictures on the way to the whole one, each twice as wide as the one before."""
        found = [self.share]
        while found[-1] <= 1 / 2:
            found.append(2 * found[-1])
        return found[:-1] if found[-1] == 1 else found
