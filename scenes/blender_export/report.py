"""The one list of what a file cannot express."""


class Report:
    """Collects what is left out, each once, in the order in which it was met."""

    def __init__(self):
        self._entries = {}

    def add(self, entry):
        self._entries.setdefault(entry, None)

    def share(self, entry, name):
        """An entry that many things have: one line, with their names."""
        self._entries.setdefault(entry, []).append(name)

    def entries(self):
        return [entry if names is None else "%s (%s)" % (entry, ", ".join(names)) for entry, names in self._entries.items()]
