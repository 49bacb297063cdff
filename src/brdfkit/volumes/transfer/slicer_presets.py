"""Reading of 3D Slicer's presets for volume rendering, from `presets.xml` or a scene with presets.

An element ``<VolumeProperty>`` holds three lists of numbers, each preceded by its count:

    scalarOpacity     value, opacity of a layer of d = 1 mm (VTK's ScalarOpacityUnitDistance, which
                      Slicer leaves as it is); values are HU in the presets for CT
    gradientOpacity   gradient magnitude, factor of the opacity
    colorTransfer     value, R, G, B as a screen shows them (sRGB)

They are converted to σ_t = -ln(1 - a) / d and linear R, G, B. The factor of gradients multiplies
σ_t. VTK multiplies the opacity of each sample by it, whatever the distance of samples, which is the
same for close samples. VTK scales gradient magnitudes by the mean spacing; here they are per unit
of length, the same for voxels of 1 mm. ``shade``, ``ambient`` and the like belong to VTK's lamps,
and are not read.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.colours import from_srgb
from brdfkit.core.errors import BrdfkitError, no_such
from brdfkit.core.files import read_bytes
from brdfkit.volumes.transfer.colour_maps import bracket_points, to_rising

PARTS = 8  # into which a segment between two colours is divided
UNIT_DISTANCE = 1.0  # mm


def read_preset(cls: Any, path: Path, name: str) -> Any:
    """Read the preset `name` of a file, or the only one if the name is empty."""
    try:
        root = ElementTree.fromstring(read_bytes(path))
    except ElementTree.ParseError as error:
        raise BrdfkitError(f"{path}: is no XML ({error}); fetch it again.") from error
    presets = {e.get("name", str(i)): e for i, e in enumerate(root.iter("VolumeProperty"))}
    if not presets:
        raise BrdfkitError(f"{path}: holds no <VolumeProperty>, a preset of Slicer's.")
    if not name and len(presets) > 1:
        raise BrdfkitError(
            f"{path}: holds {len(presets)} presets; name one: {path}#{next(iter(presets))}."
        )
    if name and name not in presets:
        raise no_such("preset", name, presets, str(path))
    preset = presets[name] if name else next(iter(presets.values()))
    try:
        return _convert(cls, preset)
    except BrdfkitError as error:
        raise BrdfkitError(f"{path}: {error}") from error


def _convert(cls: Any, preset: ElementTree.Element) -> Any:
    """Return the transfer function, of the class `cls`, of a <VolumeProperty>."""
    opacity, colour = _read_rows(preset, "scalarOpacity", 2), _read_rows(preset, "colorTransfer", 4)
    ends = np.union1d(opacity[:, 0], colour[:, 0])
    # VTK interpolates in sRGB; linear colours at points this close do nearly the same
    parts = [np.linspace(a, b, PARTS, endpoint=False) for a, b in pairwise(ends)]
    values = np.concatenate([*parts, ends[-1:]])
    rgb, alpha = from_srgb(_interpolate(values, colour)), _interpolate(values, opacity)
    rgba = np.column_stack([rgb, np.clip(alpha, 0, 1)])
    function = cls.from_opacity(values, rgba, unit_distance=UNIT_DISTANCE)
    name = preset.get("name", "preset")
    unit = "HU" if name.startswith("CT") else ""
    function = replace(function, name=name, value_unit=unit, length_unit="mm")
    ramp = _read_rows(preset, "gradientOpacity", 2)
    return function if (ramp[:, 1] == 1).all() else function.over_gradients(ramp)


def _read_rows(preset: ElementTree.Element, attribute: str, columns: int) -> FloatArray:
    """Read the rows (n, columns) of a list of numbers, whose first column rises."""
    try:
        count, *numbers = map(float, preset.get(attribute, "").split())
        rows = np.array(numbers).reshape(-1, columns)
    except ValueError:
        count, rows = -1, np.empty((0, columns))
    name = preset.get("name", "a preset")
    if count != rows.size or len(rows) < 2 or not np.isfinite(rows).all():
        raise BrdfkitError(
            f"{name}: {attribute} should be the count of its numbers, and two or more rows of "
            f"{columns}; mend it."
        )
    equal = np.diff(rows[:, 0]) == 0
    for i in np.flatnonzero(equal) + 1:
        rows[i, 0] = np.nextafter(rows[i - 1, 0], np.inf)  # a jump, as in Slicer
    to_rising(rows[:, 0], f"{name}: the values of {attribute}")
    return rows


def _interpolate(values: FloatArray, rows: FloatArray) -> FloatArray:
    """Interpolate all columns but the first at `values` of the first, linearly as VTK does."""
    low, high, t = bracket_points(values, rows[:, 0])
    return (1 - t) * rows[low, 1:] + t * rows[high, 1:]
