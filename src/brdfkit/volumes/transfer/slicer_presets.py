"""Reads presets of 3D Slicer's volume rendering: `presets.xml`, or a scene that has them.

An element ``<VolumeProperty>`` holds three lists of numbers, each after their count:

    scalarOpacity     value, opacity of a layer of d = 1 mm (VTK's ScalarOpacityUnitDistance, which
                      Slicer leaves as it is); values are HU in the presets for CT
    gradientOpacity   gradient magnitude, factor of the opacity
    colorTransfer     value, R, G, B as a screen shows them (sRGB)

What becomes of them: σ_t = -ln(1 - a) / d; R, G, B made linear. The factor of gradients multiplies
σ_t: VTK multiplies the opacity of each sample by it, whatever the distance of samples, which is the
same where samples are close. It takes gradient magnitudes as its mappers scale them, by the mean
spacing; here they are per unit of length, the same for voxels of 1 mm. ``shade``, ``ambient`` and
the like belong to VTK's lamps, and are not read.
"""

from dataclasses import replace
from itertools import pairwise
from xml.etree import ElementTree

import numpy as np

from brdfkit.core.colours import from_srgb
from brdfkit.core.errors import BrdfkitError, no_such
from brdfkit.core.files import read_bytes
from brdfkit.volumes.transfer.colour_maps import places, require_order

PARTS = 8  # of a segment between two colours
UNIT_DISTANCE = 1.0  # mm


def read(cls, path, name):
    """The preset `name` of a file; the only one if the name is empty."""
    try:
        root = ElementTree.fromstring(read_bytes(path))
    except ElementTree.ParseError as error:
        raise BrdfkitError(f"{path}: is no XML ({error}); fetch it again.") from error
    found = {e.get("name", str(i)): e for i, e in enumerate(root.iter("VolumeProperty"))}
    if not found:
        raise BrdfkitError(f"{path}: holds no <VolumeProperty>, a preset of Slicer's.")
    if not name and len(found) > 1:
        raise BrdfkitError(
            f"{path}: holds {len(found)} presets; name one: {path}#{next(iter(found))}."
        )
    if name and name not in found:
        raise no_such("preset", name, found, str(path))
    preset = found[name] if name else next(iter(found.values()))
    try:
        return _convert(cls, preset)
    except BrdfkitError as error:
        raise BrdfkitError(f"{path}: {error}") from error


def _convert(cls, preset):
    opacity, colour = _points(preset, "scalarOpacity", 2), _points(preset, "colorTransfer", 4)
    ends = np.union1d(opacity[:, 0], colour[:, 0])
    # VTK mixes colours of screens; so do points this close
    parts = [np.linspace(a, b, PARTS, endpoint=False) for a, b in pairwise(ends)]
    values = np.concatenate([*parts, ends[-1:]])
    rgba = np.column_stack([from_srgb(_at(values, colour)), np.clip(_at(values, opacity), 0, 1)])
    function = cls.from_opacity(values, rgba, UNIT_DISTANCE)
    name = preset.get("name", "preset")
    unit = "HU" if name.startswith("CT") else ""
    function = replace(function, name=name, value_unit=unit, length_unit="mm")
    ramp = _points(preset, "gradientOpacity", 2)
    return function if (ramp[:, 1] == 1).all() else function.over_gradients(ramp)


def _points(preset, attribute, columns):
    """The rows of a list of numbers, by values that rise."""
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
        rows[i, 0] = np.nextafter(rows[i - 1, 0], np.inf)  # as Slicer does: a step
    require_order(rows[:, 0], f"{name}: the values of {attribute}")
    return rows


def _at(values, rows):
    """The rows' numbers, without the first, at `values`: linear, as VTK has them."""
    low, high, t = places(values, rows[:, 0])
    return (1 - t) * rows[low, 1:] + t * rows[high, 1:]
