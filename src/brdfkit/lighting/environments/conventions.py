"""Conventions of environment maps: a layout, and which axes of the world are right, up and ahead.

``mitsuba`` is short for ``latlong_poles:-x+y+z``: latitude and longitude with rows at the poles; in
the middle of the picture is the world's +z, above is its +y, and to the right its -x.
"""

import re
from dataclasses import dataclass

import numpy as np

from brdfkit.core.errors import BrdfkitError, no_such
from brdfkit.lighting.environments.cubes import CROSS, STRIP, VERTICAL_CROSS
from brdfkit.lighting.environments.layouts import Angular, LatitudeLongitude, Paraboloids

LAYOUTS = {
    "latlong": LatitudeLongitude(at_poles=False),
    "latlong_poles": LatitudeLongitude(at_poles=True),
    "angular": Angular(),
    "cross": CROSS,
    "vertical_cross": VERTICAL_CROSS,
    "strip": STRIP,
    "paraboloids": Paraboloids(),
}
# What programs and collections do, as far as their code or documentation says
NAMED = {
    "mitsuba": "latlong_poles:-x+y+z",  # src/emitters/envmap.cpp: atan2(v.x, -v.z), acos(v.y)
    "blender": "latlong:-y+z+x",  # Cycles, kernel/camera/projection.h: direction_to_equirectangular
    "pbrt-v3": "latlong:-y+z-x",  # src/lights/infinite.cpp: SphericalPhi(w), SphericalTheta(w)
    "three.js": "latlong:+z+y+x",  # ShaderChunk/common.glsl.js: equirectUv
    "opengl": "strip:+x+y+z",  # OpenGL 4.6, table 8.19
    "debevec": "angular:+x+y-z",  # http://www.debevec.org/Probes
    "usc": "latlong:+x+y-z",  # https://vgl.ict.usc.edu/Data/HighResProbes
}
AXES = re.compile("([+-][xyz])([+-][yz])([+-][xyz])")


@dataclass(frozen=True)
class Convention:
    """A `layout`, and the `frame` (3, 3): its columns are right, up and ahead in a world with y up.

    A world with z up is turned to one with y up as exporters do: (x, y, z) → (x, z, -y).
    """

    layout: object
    frame: np.ndarray


def convention(name):
    """The `Convention` of a name, as ``blender``, ``cross`` or ``latlong:+x+y-z``.

    A layout without axes has those of Mitsuba. Raises `BrdfkitError` for anything else.

    >>> convention("blender").frame[:, 2].tolist()    # ahead is +x
    [1.0, 0.0, 0.0]
    """
    layout, _, axes = NAMED.get(str(name), str(name)).partition(":")
    if layout not in LAYOUTS:
        raise no_such("convention of maps", name, [*NAMED, *LAYOUTS])
    return Convention(LAYOUTS[layout], _frame(axes or NAMED["mitsuba"].partition(":")[2]))


def _frame(axes):
    """The matrix of axes such as -x+y+z."""
    found = AXES.fullmatch(axes)
    if not found or len({word[1] for word in found.groups()}) < 3:
        raise BrdfkitError(
            f"{axes!r} should name the axes that are right, up and ahead, each once, up y or z: "
            "as in -x+y+z."
        )
    columns = [float(f"{sign}1") * np.eye(3)["xyz".index(axis)] for sign, axis in found.groups()]
    frame = np.stack(columns, axis=1)
    z_is_up = found[2][1] == "z"
    return np.stack([frame[0], frame[2], -frame[1]]) if z_is_up else frame
