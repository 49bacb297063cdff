"""Finds lobes that are narrower than the spacing of the samples, so that their width is a guess.

A lobe is one term of a model, such as one of its highlights. The half angle θ_h is the angle
between the half vector and the normal; the difference angle θ_d is the angle between the half
vector and the direction of incidence.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from brdfkit.core.geometry.directions import cos_theta_h, from_half_difference
from brdfkit.model import Model
from brdfkit.model.evaluation import compute_lobe_values, to_weight_matrix
from brdfkit.model.samples import Samples

# Half angles θ_h at which a lobe is evaluated, and the difference angle θ_d of all of them [rad]
HALF_ANGLES = np.concatenate([[0.0], np.geomspace(1e-5, 1.2, 400)])
THETA_D = np.radians(20)
# Half angles with a smaller difference [degrees] count as equal: goniometers round their angles
SAME = 0.01
# Number of samples nearest to the mirror direction that decide the spacing of half angles
NEAREST = 1_000


def list_narrow_lobe_notes(samples: Samples, fitted: Model) -> dict[str, str]:
    """Return a sentence on each lobe whose highlight is narrower than the spacing of the samples.

    The keys are the names of the parameters that make these lobes narrow.
    """
    widths = [n for n in fitted.shapes(anisotropic=True) if find_width_exponent(fitted, n)]
    step = find_half_angle_spacing(samples) if widths else 0.0
    notes = {}
    for k, half_width in enumerate(compute_half_widths(fitted) if step else ()):
        own = [
            n for n in widths if half_width < step / 2 and k in find_lobes_with_parameter(fitted, n)
        ]
        if not own or not to_weight_matrix(fitted)[k].any():
            continue
        name = min(own, key=lambda n: getattr(fitted, n) ** find_width_exponent(fitted, n))
        notes[name] = (
            f"{name} = {getattr(fitted, name):.3g} makes a lobe of the half width "
            f"{half_width:.2g}°, where the half vectors of the samples are {step:.2g}° apart: its "
            "width is a guess; measure nearer to the mirror direction, or fix it"
        )
    return notes


def find_width_exponent(model: Model, name: str) -> float:
    """Return the power of a shape parameter to which the width of its lobe is proportional.

    It is 0 for a parameter that does not set a width.
    """
    parameter = model.parameters[name]
    return model.parameters[parameter.follows or name].width


def find_half_angle_spacing(samples: Samples) -> float:
    """Return the second smallest half angle θ_h of samples [degrees].

    A narrower highlight contains samples at one half angle only, which do not determine its width.
    """
    starts = samples.half_vector_starts
    if starts is None:
        cosine = cos_theta_h(samples.wi, samples.wo)
        few = np.partition(cosine, -NEAREST)[-NEAREST:] if len(cosine) > NEAREST else cosine
    else:  # samples of a table with equal half vectors are counted together
        cosine = cos_theta_h(samples.wi[starts], samples.wo[starts])
        order = np.argsort(-cosine)
        counts = np.diff(starts, append=len(samples.wi))[order]
        few = cosine[order][np.cumsum(counts) - counts < NEAREST]
    different = np.unique(np.round(np.degrees(np.arccos(np.minimum(few, 1))) / SAME)) * SAME
    return float(different[min(1, len(different) - 1)])


def compute_half_widths(model: Model) -> NDArray[np.float64]:
    """Return the half width at half maximum of every lobe, as a half angle θ_h (lobes,) [degrees].

    It is the smaller of the widths along the two tangents. It is infinite for a lobe whose maximum
    is not in the mirror direction.
    """
    by_axis = []
    for phi_h in (0.0, np.pi / 2):
        wi, wo = from_half_difference(HALF_ANGLES, THETA_D, np.pi / 2, phi_h)
        above = (wi[:, 2] > 0) & (wo[:, 2] > 0)
        values = compute_lobe_values(model, wi[above], wo[above])[0]
        low = values < values[0] / 2
        half = np.degrees(HALF_ANGLES[above][low.argmax(axis=0)])
        peaked = low.any(axis=0) & (values.max(axis=0) <= values[0] * (1 + 1e-9))
        by_axis.append(np.where(peaked, half, np.inf))
    return np.minimum(*by_axis)


def find_lobes_with_parameter(model: Model, name: str) -> NDArray[np.intp]:
    """Return the indices of the lobes whose values change with the shape parameter `name`."""
    low, high = model.parameters[name].bounds
    value = getattr(model, name)
    other = value + 0.05 * ((high if value < (low + high) / 2 else low) - value)
    wi, wo = from_half_difference(HALF_ANGLES, THETA_D, 1.0, 0.5)
    above = (wi[:, 2] > 0) & (wo[:, 2] > 0)
    before, after = (
        np.concatenate(compute_lobe_values(m, wi[above], wo[above]))
        for m in (model, model.changed(**{name: other}))
    )
    return np.flatnonzero((np.abs(after - before) > 1e-9 * np.abs(before)).any(axis=0))
