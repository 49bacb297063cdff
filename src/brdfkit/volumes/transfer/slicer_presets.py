"""Reading of 3D Slicer's presets for volume rendering, from `presets.xml` or a scene with presets.

An element ``<VolumeProperty>`` has three lists of numbers, each preceded by its count:

    scalarOpacity     value, opacity of a layer of d = 1 mm (VTK's ScalarOpacityUnitDistance, which
                      Slicer leaves as it is); values are HU in the presets for CT
    gradientOpacity   gradient magnitude, factor of the opacity
    colorTransfer     value, R, G, B as a screen shows them (sRGB)

Opacities a become extinctions σ_t = -ln(1 - a) / d, and R, G, B become linear. The factor from
gradientOpacity multiplies σ_t, while VTK multiplies the opacity of each sample, which is the same
for close samples. VTK scales gradient magnitudes by the mean spacing; here they are per mm, which
is the same for voxels of 1 mm. Settings of VTK's lamps, such as ``shade`` and ``ambient``, are not
read.
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
from brdfkit.core.errors import BrdfkitError, no_such_error
from brdfkit.core.files import read_bytes
from brdfkit.volumes.transfer.colour_maps import find_bracketing_points, require_rising

PARTS = 8  # number of parts into which a segment between two control points is divided
UNIT_DISTANCE = 1.0  # thickness d of the layer whose opacity is stated [mm]


def read_preset(cls: Any, path: Path, name: str) -> Any:
    """Read the preset `name` of a file as a transfer function, of the class `cls`.

    If the name is empty, the file must have only one preset.
    """
    try:
        root = ElementTree.fromstring(read_bytes(path))
    except ElementTree.ParseError as error:
        raise BrdfkitError(f"{path}: is no XML ({error}); save or fetch it again.") from error
    presets = {e.get("name", str(i)): e for i, e in enumerate(root.iter("VolumeProperty"))}
    if not presets:
        raise BrdfkitError(f"{path}: has no <VolumeProperty>, as Slicer's presets are called.")
    if not name and len(presets) > 1:
        raise BrdfkitError(
            f"{path}: has {len(presets)} presets; name one: {path}#{next(iter(presets))}."
        )
    if name and name not in presets:
        raise no_such_error("preset", name, presets, str(path))
    preset = presets[name] if name else next(iter(presets.values()))
    try:
        return _convert_preset(cls, preset)
    except BrdfkitError as error:
        raise BrdfkitError(f"{path}: {error}") from error


def _convert_preset(cls: Any, preset: ElementTree.Element) -> Any:
    """Convert an XML element <VolumeProperty> to a transfer function, of the class `cls`."""
    opacity, colour = (
        _read_number_rows(preset, "scalarOpacity", 2),
        _read_number_rows(preset, "colorTransfer", 4),
    )
    ends = np.union1d(opacity[:, 0], colour[:, 0])
    # VTK interpolates colours in sRGB, which linear colours approximate at close points
    parts = [np.linspace(a, b, PARTS, endpoint=False) for a, b in pairwise(ends)]
    values = np.concatenate([*parts, ends[-1:]])
    rgb, alpha = from_srgb(_interpolate_rows(values, colour)), _interpolate_rows(values, opacity)
    rgba = np.column_stack([rgb, np.clip(alpha, 0, 1)])
    function = cls.from_opacity(values, rgba, unit_distance=UNIT_DISTANCE)
    name = preset.get("name", "preset")
    unit = "HU" if name.startswith("CT") else ""
    function = replace(function, name=name, value_unit=unit, length_unit="mm")
    ramp = _read_number_rows(preset, "gradientOpacity", 2)
    return function if (ramp[:, 1] == 1).all() else function.over_gradients(ramp)


def _read_number_rows(preset: ElementTree.Element, attribute: str, columns: int) -> FloatArray:
    """Read the numbers of an attribute, a list that its count precedes, as rows (n, columns).

    Raises `BrdfkitError` unless the first column rises. Equal neighbours in it, which mean a jump
    in Slicer, become different by the smallest step of a float.
    """
    try:
        count, *numbers = map(float, preset.get(attribute, "").split())
        rows = np.array(numbers).reshape(-1, columns)
    except ValueError:
        count, rows = -1, np.empty((0, columns))
    name = preset.get("name", "a preset")
    if count != rows.size or len(rows) < 2 or not np.isfinite(rows).all():
        raise BrdfkitError(
            f"{name}: {attribute} should be the count of its numbers, and two or more rows of "
            f"{columns}; correct it."
        )
    equal = np.diff(rows[:, 0]) == 0
    for i in np.flatnonzero(equal) + 1:
        rows[i, 0] = np.nextafter(rows[i - 1, 0], np.inf)
    require_rising(rows[:, 0], f"{name}: the values of {attribute}")
    return rows


def _interpolate_rows(values: FloatArray, rows: FloatArray) -> FloatArray:
    """Interpolate `rows` linearly at `values` of their first column; return the other columns."""
    low, high, t = find_bracketing_points(values, rows[:, 0])
    return (1 - t) * rows[low, 1:] + t * rows[high, 1:]
