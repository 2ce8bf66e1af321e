"""Puts a glTF document together and writes it, as .glb or as .gltf with a .bin beside it."""

import json
import os
import struct

import numpy

COMPONENTS = {"f": (5126, 4), "I": (5125, 4)}
KINDS = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}
MOST_BYTES = 2 ** 32 - 1


class GltfFile:
    """Lists of the document by name ("meshes", "nodes", ...), and its one buffer."""

    def __init__(self):
        self.document = {"asset": {"version": "2.0", "generator": "Shadowcache, from Blender"}}
        self.chunks = []
        self.size = 0

    def add(self, kind, entry):
        """Appends an entry to one of the lists; its number there."""
        entries = self.document.setdefault(kind, [])
        entries.append(entry)
        return len(entries) - 1

    def use(self, extension):
        used = self.document.setdefault("extensionsUsed", [])
        if extension not in used:
            used.append(extension)

    def add_view(self, data):
        """A piece of the buffer, bytes or a contiguous array; its number."""
        view = {"buffer": 0, "byteOffset": self.size, "byteLength": memoryview(data).nbytes}
        padding = -view["byteLength"] % 4
        self.chunks += [data, b"\0" * padding]
        self.size += view["byteLength"] + padding
        return self.add("bufferViews", view)

    def add_accessor(self, array, bounds=False):
        """Rows of float32, or a list of float32 or uint32; its number. `bounds`: with least and most, as positions
        and times need them; what is not finite counts as 0 there, because JSON has no such number."""
        array = numpy.ascontiguousarray(array)
        component, _ = COMPONENTS[array.dtype.char]
        width = 1 if array.ndim == 1 else array.shape[1]
        accessor = {"bufferView": self.add_view(array), "componentType": component, "count": len(array),
                    "type": KINDS[width]}
        if bounds:
            rows = array.reshape(-1, width)
            for name, of in (("min", rows.min(axis=0)), ("max", rows.max(axis=0))):
                accessor[name] = numpy.nan_to_num(of, nan=0, posinf=0, neginf=0).tolist()
        return self.add("accessors", accessor)

    def write(self, path):
        if path.endswith(".gltf"):
            name = os.path.splitext(path)[0] + ".bin"
            self._close(os.path.basename(name))
            with open(path, "w", encoding="utf-8") as out:
                json.dump(self.document, out)
            with open(name, "wb") as out:
                self._write_buffer(out)
            return
        self._close(None)
        text = json.dumps(self.document).encode()
        text += b" " * (-len(text) % 4)
        total = 12 + 8 + len(text) + (8 + self.size if self.size else 0)
        if total > MOST_BYTES:
            raise ValueError("%s: %d bytes, expected at most %d in a .glb; export as .gltf" % (path, total, MOST_BYTES))
        with open(path, "wb") as out:
            out.write(b"glTF" + struct.pack("<II", 2, total) + struct.pack("<I", len(text)) + b"JSON" + text)
            if self.size:
                out.write(struct.pack("<I", self.size) + b"BIN\0")
                self._write_buffer(out)

    def _close(self, uri):
        nodes = self.document.setdefault("nodes", [])
        inner = {child for node in nodes for child in node.get("children", [])}
        self.document["scenes"] = [{"nodes": [i for i in range(len(nodes)) if i not in inner]}]
        self.document["scene"] = 0
        if not nodes:
            del self.document["nodes"], self.document["scenes"][0]["nodes"]
        if self.size:
            self.document["buffers"] = [{"byteLength": self.size, **({"uri": uri} if uri else {})}]

    def _write_buffer(self, out):
        for chunk in self.chunks:
            out.write(chunk)
