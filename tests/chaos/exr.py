# SPDX-License-Identifier: Apache-2.0
"""Reads the pixels of an EXR file of scanlines without compression; no general reader."""

import hashlib
import struct
from pathlib import Path

SIZES = {0: 4, 1: 2, 2: 4}  # bytes of UINT, HALF, FLOAT


def words(data, at):
    end = data.index(b"\0", at)
    return data[at:end].decode(), end + 1


def header(data):
    if data[:4] != b"\x76\x2f\x31\x01":
        raise ValueError("no EXR file")
    attributes, at = {}, 8
    while data[at] != 0:
        name, at = words(data, at)
        _, at = words(data, at)
        (size,) = struct.unpack_from("<i", data, at)
        attributes[name] = data[at + 4 : at + 4 + size]
        at += 4 + size
    return attributes, at + 1


def channels(data):
    """(name, bytes a value) in the order of the file."""
    found, at = [], 0
    while data[at] != 0:
        name, at = words(data, at)
        (kind,) = struct.unpack_from("<i", data, at)
        found.append((name, SIZES[kind]))
        at += 16
    return found


class Picture:
    def __init__(self, path):
        data = Path(path).read_bytes()
        attributes, at = header(data)
        if attributes["compression"] != b"\0" or "tiles" in attributes:
            raise ValueError(f"{path}: is compressed or tiled")
        x0, y0, x1, y1 = struct.unpack("<4i", attributes["dataWindow"])
        self.size = (x1 - x0 + 1, y1 - y0 + 1)
        self.channels = channels(attributes["channels"])
        offsets = struct.unpack_from(f"<{self.size[1]}Q", data, at)
        self.lines = []
        for offset in offsets:
            _, length = struct.unpack_from("<ii", data, offset)
            self.lines.append(data[offset + 8 : offset + 8 + length])

    def digest(self):
        """Of size, channels and every bit of every channel; metadata do not count."""
        found = hashlib.sha256(repr((self.size, self.channels)).encode())
        for line in self.lines:
            found.update(line)
        return found.hexdigest()

    def total(self, channel):
        """Sum of a channel of floats over all pixels."""
        width, at = self.size[0], 0
        for name, size in self.channels:
            if name == channel:
                return sum(sum(struct.unpack_from(f"<{width}f", line, at * width)) for line in self.lines)
            at += size
        raise ValueError(f"no channel {channel}")
