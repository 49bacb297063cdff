"""Conventions of environment maps: the layout of a picture, and the axes of the world in it.

``mitsuba`` is short for ``latlong_poles:-x+y+z``: latitude and longitude with rows at the poles,
and the world's -x to the right in the picture, its +y at the top, and its +z in the middle.
"""

import re
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.errors import BrdfkitError, no_such_error
from brdfkit.lighting.environments.cubes import CROSS, STRIP, VERTICAL_CROSS, Cube
from brdfkit.lighting.environments.layouts import Angular, LatitudeLongitude, Paraboloids

Layout: TypeAlias = LatitudeLongitude | Angular | Paraboloids | Cube

LAYOUTS: dict[str, Layout] = {
    "latlong": LatitudeLongitude(at_poles=False),
    "latlong_poles": LatitudeLongitude(at_poles=True),
    "angular": Angular(),
    "cross": CROSS,
    "vertical_cross": VERTICAL_CROSS,
    "strip": STRIP,
    "paraboloids": Paraboloids(),
}
# The conventions of programs and of map collections, according to their code or documentation
NAMED = {
    "mitsuba": "latlong_poles:-x+y+z",  # see src/emitters/envmap.cpp: atan2(v.x, -v.z), acos(v.y)
    "blender": "latlong:-y+z+x",  # see Cycles, camera/projection.h: direction_to_equirectangular
    "pbrt-v3": "latlong:-y+z-x",  # see src/lights/infinite.cpp: SphericalPhi(w), SphericalTheta(w)
    "three.js": "latlong:+z+y+x",  # see ShaderChunk/common.glsl.js: equirectUv
    "opengl": "strip:+x+y+z",  # see OpenGL 4.6, table 8.19
    "debevec": "angular:+x+y-z",  # see http://www.debevec.org/Probes
    "usc": "latlong:+x+y-z",  # see https://vgl.ict.usc.edu/Data/HighResProbes
}
AXES = re.compile("([+-][xyz])([+-][yz])([+-][xyz])")


@dataclass(frozen=True)
class Convention:
    """How a program stores directions of its world in the picture of an environment map.

    `layout` relates pixels to the directions right, up and ahead; the columns of `frame` (3, 3) are
    these directions in a world with y up. A world with z up is turned into one with y up as
    exporters do: (x, y, z) → (x, z, -y).
    """

    layout: Layout
    frame: FloatArray


def parse_convention(name: str) -> Convention:
    """Return the `Convention` of a name such as ``blender``, ``cross`` or ``latlong:+x+y-z``.

    A layout's name without axes means Mitsuba's axes. Raises `BrdfkitError` for an unknown name.

    >>> parse_convention("blender").frame[:, 2].tolist()    # ahead is +x
    [1.0, 0.0, -0.0]
    """
    layout, _, axes = NAMED.get(str(name), str(name)).partition(":")
    if layout not in LAYOUTS:
        raise no_such_error("convention of maps", name, [*NAMED, *LAYOUTS])
    return Convention(LAYOUTS[layout], _parse_axes(axes or NAMED["mitsuba"].partition(":")[2]))


def _parse_axes(axes: str) -> FloatArray:
    """Return the frame (3, 3) of a `Convention` with axes such as "-x+y+z": right, up and ahead."""
    match = AXES.fullmatch(axes)
    if not match or len({word[1] for word in match.groups()}) < 3:
        raise BrdfkitError(
            f"{axes!r} should be the axes to the right, up and ahead, as in -x+y+z: each once, and "
            "y or z up."
        )
    columns = [float(f"{word[0]}1") * np.eye(3)["xyz".index(word[1])] for word in match.groups()]
    frame = np.stack(columns, axis=1)
    z_is_up = match[2][1] == "z"
    return np.stack([frame[0], frame[2], -frame[1]]) if z_is_up else frame
