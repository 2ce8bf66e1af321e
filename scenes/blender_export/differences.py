"""What of Blender's data is not understood: all that RNA lists of an item, but for what allowed.py has."""

from .allowed import INPUTS, INSIDE, PROPERTIES, READ, WORDS, Free
from .node_values import link_of

KNOWN = {}  # of looked_at(), by the names of structs, and by how many properties they have with those of add-ons


def kinds_of(rna):
    """Names of a struct and of its bases, its own first."""
    while rna:
        yield rna.identifier
        rna = rna.base


def rule_of(rna, name):
    """Of a property of a struct; None if it is not listed."""
    return next((PROPERTIES[kind][name] for kind in kinds_of(rna) if name in PROPERTIES.get(kind, ())), None)


def plain(value):
    """A value that can be compared: arrays as tuples."""
    return tuple(value) if hasattr(value, "__len__") and not isinstance(value, str) else value


def default_of(rna):
    return tuple(rna.default_array) if getattr(rna, "is_array", False) else rna.default


def looked_at(rna):
    """Names and rules of the properties of a struct that are to be looked at."""
    key = rna.identifier, len(rna.properties)
    if key not in KNOWN:
        found = [(p, rule_of(rna, p.identifier)) for p in rna.properties]
        KNOWN[key] = [(p.identifier, rule) for p, rule in found if not (
            isinstance(rule, Free) or rule is READ or rule is None and is_unread(rna, p))]
    return KNOWN[key]


def is_unread(owner, rna):
    """Whether a property that is not listed is a result, as it cannot be set, or an add-on's own; Cycles' are listed."""
    if rna.is_runtime and not any(kind.startswith("Cycles") for kind in kinds_of(owner)):
        return True
    return rna.is_readonly and rna.type not in ("POINTER", "COLLECTION")


def is_allowed(item, rna, rule):
    value = getattr(item, rna.identifier)
    if rule is not None:
        return plain(value) in rule
    if rna.type == "POINTER":
        return value is None
    if rna.type == "COLLECTION":
        return not len(value)
    return plain(value) == default_of(rna)


def differences(item):
    """A text for each property of an item, and of the structs in it, that is not understood as it is."""
    for name, rule in looked_at(item.bl_rna):
        if rule is INSIDE:
            yield from differences(getattr(item, name))
        elif not is_allowed(item, item.bl_rna.properties[name], rule):
            yield words_of(item, item.bl_rna.properties[name])


def words_of(item, rna):
    found = next((WORDS[kind, rna.identifier] for kind in kinds_of(item.bl_rna) if (kind, rna.identifier) in WORDS), None)
    if found:
        return found
    value = plain(getattr(item, rna.identifier))
    if isinstance(value, bool):
        return "%s is %s" % (rna.name, "on" if value else "off")
    if rna.type in ("POINTER", "COLLECTION"):
        return rna.name
    if isinstance(value, (float, tuple)):
        value = ", ".join("%.4g" % v if isinstance(v, float) else str(v) for v in ((value,) if isinstance(value, float) else value))
    return "%s is %s" % (rna.name, value)


def node_differences(node):
    """Of a node that is read: its properties, and the inputs that are not read."""
    for text in differences(node):
        yield "node %s: %s" % (node.bl_label, text)
    rules = INPUTS[node.bl_idname]
    for socket in node.inputs:
        if socket.enabled and not is_neutral(socket, rules.get(socket.identifier)):
            yield socket.name


def is_neutral(socket, rule):
    if isinstance(rule, Free) or rule is READ:
        return True
    if link_of(socket):
        return False
    value = plain(getattr(socket, "default_value", 0))
    if rule is not None:
        return value in rule
    return not any(value if isinstance(value, tuple) else (value,))
