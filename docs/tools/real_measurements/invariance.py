"""Fits of one material as five files, held to the fit of the MERL table."""

from functools import cache, partial

import numpy as np

import brdfkit as bk
from brdfkit.core.geometry.directions import from_angles
from brdfkit.core.geometry.quadrature import directional_albedo
from brdfkit.materials.measured.selection import select_samples
from brdfkit.model.evaluation import compute_lobe_values, to_weight_matrix
from brdfkit.regression.losses.loss import sum_squared_differences

LOSSES = "cosine", "log", "cbrt", "plain"
# A parameter is the same within this share of it, or a lobe's albedo within that share of all light
SAME, OF_ALL = 0.03, 0.01
# An albedo is the same within this share of it
SAME_ALBEDO = 0.02
# Cells of the table on which fits are held beside each other
PART = 40_000
# Where fits differ, they are made again of directions below this angle [degrees]
INNER = 70
# Angles [degrees] of the albedos of lobes
LOBES = 5, 75
# An excess of the error on the table by which it tells two fits apart, and an estimate of the error
# of one and the same fit that is wrong
TOLD, ESTIMATED = 0.005, 0.02
CAUSES = {
    "flat": "The loss hardly tells the two fits apart: on the table, their errors differ by less "
    "than 0.5 %.",
    "light": "One of the two was searched again for its light. The strength of that term is "
    "measured by the error of the file's own first fit, and its aim by the file's own albedo; both "
    "depend on where the file ends.",
    "end": "The search on the table ended in another minimum: on the table, too, the error of the "
    "file's fit is the smaller one.",
    "inner": "The file is coarse or ends where directions graze: below 70° the fits are the same.",
    "estimate": "The file's estimate of the error of one and the same fit is 2 % or more off: its "
    "samples are too few or too coarse for what the model leaves of a highlight, or count wrongly.",
    "open": "None of these.",
}


class Numbers:
    """The numbers by which two fits are compared: `parameters`, by name, and the `albedos` at 5°,
    45° and 75°.

    The parameters are those of shape, and the albedos of each lobe at 5° and at 75°: these stand
    for its weight and its Fresnel parameter, which trade off. Lobes of equal models are in the
    order of their widths. `floors`: below which a parameter's differences do not count.
    """

    def __init__(self, fit):
        model, weights = fit.model, to_weight_matrix(fit.model).mean(axis=1)

        def lobes(wi, wo):
            return compute_lobe_values(model, wi, wo)[0] * weights

        left_out = (*model.weights(), "alpha_v", "f0", "ior")
        found = {n: v for n, v in fit.values.items() if not n.endswith(left_out)}
        self.albedos = np.array(fit.albedo.fit[:3]).mean(axis=1)
        self.floors = dict.fromkeys(found, 1e-12)
        for angle, all_ in zip(LOBES, self.albedos[[0, -1]], strict=True):
            light = directional_albedo(lobes, from_angles(np.radians(angle), 0.0))
            named = {f"{n} at {angle}°": a for n, a in zip(model.weights(), light, strict=True)}
            found |= named
            self.floors |= dict.fromkeys(named, OF_ALL * all_)
        self.parameters = _in_order(found)

    def beside(self, other):
        """How this differs from another fit's: the number of parameters, how many of them are the
        same, the one that is farthest and by what share, and the factors of the albedos."""
        apart = {}
        for name, its in other.parameters.items():
            size = max(abs(its), other.floors[name] / SAME)
            apart[name] = (self.parameters[name] - its) / size
        same = sum(abs(share) <= SAME for share in apart.values())
        worst = max(apart, key=lambda name: abs(apart[name]))
        factors = self.albedos / other.albedos
        return [len(apart), int(same), worst, float(apart[worst]), *factors.tolist()]


def _in_order(parameters):
    """Parameters by name, in which the lobes of `ggx+ggx` are in the order of their widths."""
    first, second = "ggx_1_", "ggx_2_"
    if parameters.get(f"{first}alpha_u", 0) <= parameters.get(f"{second}alpha_u", 0):
        return parameters
    other = {first: second, second: first}
    return {other.get(n[:6], n[:6]) + n[6:]: value for n, value in parameters.items()}


class Part:
    """A part of a table's cells, by which the loss of the whole is estimated."""

    def __init__(self, table):
        samples = select_samples(table, 80.0)
        rows = np.random.default_rng(0).choice(len(samples.wi), PART, replace=False)
        self.samples = samples.at(np.sort(rows))

    def error(self, fit):
        """E of the loss that the fit minimised, on the part."""
        loss = bk.losses.named[fit.loss_name]
        values = fit.eval(self.samples.wi, self.samples.wo)
        return float(
            np.sqrt(
                loss.importance(self.samples) @ sum_squared_differences(loss, values, self.samples)
            )
        )


def compare_files(files, model, loss, part):
    """Kind of file → how the fit of it differs from that of the first, the table's.

    `beside`: see `Numbers.beside`. Of those that differ, figures that may explain it: `excess`, the
    error of the fit on the table over that of the table's own fit, less 1; `estimate`, the error of
    the table's fit on the file over that on the table, less 1; `again`, whether one of the two was
    searched again for its light. Where the excess tells them apart and neither was searched again,
    also comparisons of the `inner` fits, below 70°.
    """
    (table, *others), found = files, {}
    fit = partial(bk.fit, model=model, loss=loss)
    reference = fit(files[table])
    inner = cache(lambda: Numbers(fit(files[table], max_angle=INNER)))
    own, error = Numbers(reference), part.error(reference)
    for kind in others:
        data = files[kind]
        other = fit(data)
        row = found[kind] = {
            "beside": Numbers(other).beside(own),
            "effective": other.effective_samples,
            "unrepresented": other.unrepresented,
        }
        if is_same(row["beside"]):
            continue
        row["excess"] = part.error(other) / error - 1
        row["estimate"] = bk.compare(data, reference).errors[reference.name][loss] / error - 1
        notes = (*reference.notes, *other.notes)
        row["again"] = any(note.startswith("by the loss alone") for note in notes)
        if row["excess"] >= TOLD and not row["again"]:
            row["inner"] = Numbers(fit(data, max_angle=INNER)).beside(inner())
    return found


def cause(row):
    """Why a comparison differs, by its figures: a key of `CAUSES`, or None where it does not."""
    if "excess" not in row:
        return None
    if abs(row["excess"]) < TOLD:
        return "flat"
    if row["again"]:
        return "light"
    if row["excess"] < 0:
        return "end"
    if "inner" in row and is_same(row["inner"]):
        return "inner"
    return "estimate" if abs(row["estimate"]) >= ESTIMATED else "open"


def is_same(beside):
    """Whether all numbers of a comparison are the same."""
    count, same, _, _, *factors = beside
    return count == same and all(abs(factor - 1) <= SAME_ALBEDO for factor in factors)
