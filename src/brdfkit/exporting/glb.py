"""Writes a ball with a material as a binary glTF 2.0 file, `.glb`."""

from __future__ import annotations

import json
import struct
import zlib
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray
from brdfkit.exporting.ball_mesh import make_ball

# The numbers of the file format: its name, its version, and the kinds of its two chunks
MAGIC, VERSION, JSON, BIN = 0x46546C67, 2, 0x4E4F534A, 0x004E4942
FLOAT, UNSIGNED, VERTICES, INDICES = 5126, 5125, 34962, 34963


class _Buffer:
    """The binary chunk of a file, with the views and accessors that tell what is in it."""

    def __init__(self) -> None:
        self.data = b""
        self.views: list[dict[str, int]] = []
        self.accessors: list[dict[str, Any]] = []

    def add_view(self, data: bytes, **details: int) -> int:
        """Append bytes; return the number of their view."""
        self.data += b"\0" * (-len(self.data) % 4)
        place = {"byteOffset": len(self.data), "byteLength": len(data)}
        self.views.append({"buffer": 0, **place, **details})
        self.data += data
        return len(self.views) - 1

    def add_vectors(self, values: AnyArray, **bounds: Any) -> int:
        """Append vectors (n, 2 to 4) of the vertices; return the number of their accessor."""
        data = values.astype("<f4")
        view = self.add_view(data.tobytes(), target=VERTICES)
        kind = {"componentType": FLOAT, "count": len(data), "type": f"VEC{data.shape[1]}"}
        self.accessors.append({"bufferView": view, **kind, **bounds})
        return len(self.accessors) - 1

    def add_indices(self, values: AnyArray) -> int:
        """Append indices of vertices; return the number of their accessor."""
        data = values.astype("<u4").ravel()
        view = self.add_view(data.tobytes(), target=INDICES)
        kind = {"componentType": UNSIGNED, "count": data.size, "type": "SCALAR"}
        self.accessors.append({"bufferView": view, **kind})
        return len(self.accessors) - 1


def make_glb(
    material: dict[str, Any], comment: list[str], pixel: tuple[int, int, int] | None = None
) -> bytes:
    """Return the bytes of a file with a ball of this material.

    `comment`: lines that the file's `extras` hold; `pixel`: the colour of the texture 0, a single
    pixel, for which the ball gets tangents along u and texture coordinates.
    """
    ball, buffer = make_ball(), _Buffer()
    points = ball.points.astype(np.float32)
    bounds = {"min": points.min(axis=0).tolist(), "max": points.max(axis=0).tolist()}
    attributes = {
        "POSITION": buffer.add_vectors(points, **bounds),
        "NORMAL": buffer.add_vectors(points),  # of a ball of radius 1
    }
    root: dict[str, Any] = {}
    if pixel:
        handed = np.column_stack([ball.tangents, np.ones(len(points))])
        attributes["TANGENT"] = buffer.add_vectors(handed)
        # In glTF v points down, from the top of a picture
        attributes["TEXCOORD_0"] = buffer.add_vectors(ball.uv * (1, -1) + (0, 1))
        image = {"bufferView": buffer.add_view(_make_png(pixel)), "mimeType": "image/png"}
        root = {"images": [image], "samplers": [{}], "textures": [{"source": 0, "sampler": 0}]}
    triangles = buffer.add_indices(ball.triangles)
    primitive = {"attributes": attributes, "indices": triangles, "material": 0}
    buffer.data += b"\0" * (-len(buffer.data) % 4)
    if extensions := sorted(material.get("extensions", {})):
        root["extensionsUsed"] = extensions
    root |= {
        "asset": {"version": "2.0", "generator": "brdfkit", "extras": {"comment": comment}},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "name": "Ball"}],
        "meshes": [{"primitives": [primitive]}],
        "materials": [material],
        "accessors": buffer.accessors,
        "bufferViews": buffer.views,
        "buffers": [{"byteLength": len(buffer.data)}],
    }
    text = json.dumps(root, ensure_ascii=False, allow_nan=False).encode()
    chunks = _make_chunk(JSON, text + b" " * (-len(text) % 4)) + _make_chunk(BIN, buffer.data)
    return struct.pack("<III", MAGIC, VERSION, 12 + len(chunks)) + chunks


def _make_chunk(kind: int, data: bytes) -> bytes:
    """Return a chunk of the file: its length, its kind and its data."""
    return struct.pack("<II", len(data), kind) + data


def _make_png(pixel: tuple[int, int, int]) -> bytes:
    """Return a picture of one pixel, red, green and blue from 0 to 255, as a PNG file."""
    size_and_kind = struct.pack(">IIBBBBB", 1, 1, 8, 2, 0, 0, 0)
    parts = (b"IHDR", size_and_kind), (b"IDAT", zlib.compress(b"\0" + bytes(pixel))), (b"IEND", b"")
    chunks = (
        struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
        for name, data in parts
    )
    return b"\x89PNG\r\n\x1a\n" + b"".join(chunks)
