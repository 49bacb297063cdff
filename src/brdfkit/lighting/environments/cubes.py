"""Layouts of cube maps: six square faces, the views through a cube's sides, in a cross or row."""

from dataclasses import dataclass

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray
from brdfkit.lighting.environments.layouts import PixelCoordinates

Face = tuple[FloatArray, FloatArray, FloatArray]

RIGHT, UP, AHEAD = np.eye(3)
# Each face has the directions through its middle, to its right edge and to its lower edge. With x
# right and z ahead they are OpenGL's faces +x, -x, +y, -y, +z, -z [OpenGL 4.6, table 8.19]
RIGHT_FACE = RIGHT, -AHEAD, -UP
LEFT_FACE = -RIGHT, AHEAD, -UP
UP_FACE = UP, RIGHT, AHEAD
DOWN_FACE = -UP, RIGHT, -AHEAD
AHEAD_FACE = AHEAD, RIGHT, -UP
BACK_FACE = -AHEAD, -RIGHT, -UP
BACK_FACE_TURNED = -AHEAD, RIGHT, UP


@dataclass(frozen=True)
class Cube:
    """A layout of an environment map with a cube's faces on a grid of `columns` × `lines` squares.

    `faces` are tuples (column, line, (through, right, down)) with the square of a face, and unit
    vectors through its middle, to its right edge and to its lower edge. `layouts.py` describes the
    attributes and methods of layouts.
    """

    columns: int
    lines: int
    faces: tuple[tuple[int, int, Face], ...]
    closed: bool = False

    @property
    def aspect(self) -> float:
        return self.columns / self.lines

    @property
    def rows(self) -> float:
        return float(self.lines)

    def directions(self, x: AnyArray, y: AnyArray, height: int, width: int) -> FloatArray:
        x, y = np.broadcast_arrays(x, y)
        side = height / self.lines
        directions = np.full((*x.shape, 3), np.nan)
        for column, line, (through, right, down) in self.faces:
            s = 2 * ((x + 0.5) / side - column) - 1
            t = 2 * ((y + 0.5) / side - line) - 1
            here = (np.abs(s) <= 1) & (np.abs(t) <= 1)
            towards = through + s[here, None] * right + t[here, None] * down
            directions[here] = towards / np.linalg.norm(towards, axis=-1, keepdims=True)
        return directions

    def pixel_coordinates(
        self, directions: FloatArray, height: int, width: int
    ) -> PixelCoordinates:
        side = height / self.lines
        forward = np.stack([directions @ face[0] for _, _, face in self.faces])
        part = forward.argmax(axis=0)
        columns, lines = np.array([(column, line) for column, line, _ in self.faces]).T[:, part]
        axes = np.array([face for _, _, face in self.faces])[part]
        depth = forward.max(axis=0)
        s, t = (np.einsum("...k,...k->...", directions, axes[..., i, :]) / depth for i in (1, 2))
        x = (columns + (s + 1) / 2) * side - 0.5
        y = (lines + (t + 1) / 2) * side - 0.5
        return x, y, part


STRIP = Cube(
    6,
    1,
    tuple(
        (i, 0, face)
        for i, face in enumerate((RIGHT_FACE, LEFT_FACE, UP_FACE, DOWN_FACE, AHEAD_FACE, BACK_FACE))
    ),
)
CROSS = Cube(
    4,
    3,
    (
        (1, 0, UP_FACE),
        (0, 1, LEFT_FACE),
        (1, 1, AHEAD_FACE),
        (2, 1, RIGHT_FACE),
        (3, 1, BACK_FACE),
        (1, 2, DOWN_FACE),
    ),
)
VERTICAL_CROSS = Cube(
    3,
    4,
    (
        (1, 0, UP_FACE),
        (0, 1, LEFT_FACE),
        (1, 1, AHEAD_FACE),
        (2, 1, RIGHT_FACE),
        (1, 2, DOWN_FACE),
        (1, 3, BACK_FACE_TURNED),
    ),
)
