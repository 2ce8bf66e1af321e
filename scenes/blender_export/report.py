"""The one list of what a file cannot express."""


class Report:
    """Collects what is left out, each once, in the order in which it was met."""

    def __init__(self):
        self._entries = {}

    def add(self, entry):
        self._entries[entry] = None

    def entries(self):
        return list(self._entries)
