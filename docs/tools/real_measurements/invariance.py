"""Compares fits of one material in five kinds of files with the fit of the MERL table."""

from functools import cache, partial

import numpy as np

import brdfkit as bk
from brdfkit.core.geometry.directions import from_angles
from brdfkit.core.geometry.quadrature import directional_albedo
from brdfkit.materials.measured.selection import select_samples
from brdfkit.model.evaluation import compute_lobe_values, to_weight_matrix
from brdfkit.regression.losses.loss import sum_squared_differences

LOSSES = "cosine", "log", "cbrt", "plain"
# A parameter counts as equal within this share of its value
SAME = 0.03
# The albedo of a lobe also counts as equal within this share of all reflected light
OF_ALL = 0.01
# An albedo counts as equal within this share of its value
SAME_ALBEDO = 0.02
# Number of cells of the table on which the losses of two fits are compared
PART = 40_000
# If fits differ, they are repeated with directions below this angle [degrees]
INNER = 70
# Angles of incidence [degrees] at which albedos of single lobes are compared
LOBES = 5, 75
# The loss on the table distinguishes two fits if it differs by more than this share
TOLD = 0.005
# A file's estimate of the loss of a given fit counts as wrong if it is off by more than this share
ESTIMATED = 0.02
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
    """The numbers of a fit by which it is compared with another: parameters and albedos.

    `parameters`: shape parameters by name, and albedos of each lobe at 5° and at 75°, which stand
    for its weight and its Fresnel parameter, because these trade off; equal lobes are in the order
    of their widths. `albedos`: albedos of the whole model at 5°, 45° and 75°. `floors`: limits of
    parameters below which differences do not count.
    """

    def __init__(self, fit):
        model, weights = fit.model, to_weight_matrix(fit.model).mean(axis=1)

        def lobes(wi, wo):
            """Return the values (n, lobes) of the weighted lobes."""
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
        self.parameters = _sort_lobes(found)

    def compare_with(self, other):
        """Return how these numbers differ from the numbers of another fit, as a list.

        Its entries are the number of parameters, the number of equal ones, the name of the most
        different one and its relative difference, and the ratios of the albedos.
        """
        apart = {}
        for name, its in other.parameters.items():
            size = max(abs(its), other.floors[name] / SAME)
            apart[name] = (self.parameters[name] - its) / size
        same = sum(abs(share) <= SAME for share in apart.values())
        worst = max(apart, key=lambda name: abs(apart[name]))
        factors = self.albedos / other.albedos
        return [len(apart), int(same), worst, float(apart[worst]), *factors.tolist()]


def _sort_lobes(parameters):
    """Return parameters by name with the lobes of `ggx+ggx` in the order of their widths."""
    first, second = "ggx_1_", "ggx_2_"
    if parameters.get(f"{first}alpha_u", 0) <= parameters.get(f"{second}alpha_u", 0):
        return parameters
    other = {first: second, second: first}
    return {other.get(n[:6], n[:6]) + n[6:]: value for n, value in parameters.items()}


class Part:
    """A random part of a table's cells, on which the loss of fits is evaluated."""

    def __init__(self, table):
        samples = select_samples(table, 80.0)
        rows = np.random.default_rng(0).choice(len(samples.wi), PART, replace=False)
        self.samples = samples.at(np.sort(rows))

    def compute_error(self, fit):
        """Return the loss E that the fit minimised, evaluated on this part of the table."""
        loss = bk.losses.named[fit.loss_name]
        values = fit.eval(self.samples.wi, self.samples.wo)
        return float(
            np.sqrt(
                loss.importance(self.samples) @ sum_squared_differences(loss, values, self.samples)
            )
        )


def compare_files(files, model, loss, part):
    """Return comparisons of the fits of some files with the fit of the table, by kind of file.

    `files`: measured materials by kind, the table first; `part`: a part of the table. A comparison
    has the entry `beside`, the result of `Numbers.compare_with`. If the fits differ, further
    entries may explain it. `excess`: loss of the fit on the table over the loss of the table's own
    fit, less 1; `estimate`: loss of the table's fit on the file over its loss on the table, less 1;
    `again`: whether one of the fits was searched again for its albedo; `inner`: comparison of fits
    below 70°, if the loss distinguishes the fits and `again` is False.
    """
    (table, *others), found = files, {}
    fit = partial(bk.fit, model=model, loss=loss)
    reference = fit(files[table])
    inner = cache(lambda: Numbers(fit(files[table], max_angle=INNER)))
    own, error = Numbers(reference), part.compute_error(reference)
    for kind in others:
        data = files[kind]
        other = fit(data)
        row = found[kind] = {
            "beside": Numbers(other).compare_with(own),
            "effective": other.effective_samples,
            "unrepresented": other.unrepresented,
        }
        if is_same(row["beside"]):
            continue
        row["excess"] = part.compute_error(other) / error - 1
        row["estimate"] = bk.compare(data, reference).errors[reference.name][loss] / error - 1
        notes = (*reference.notes, *other.notes)
        row["again"] = any(note.startswith("by the loss alone") for note in notes)
        if row["excess"] >= TOLD and not row["again"]:
            row["inner"] = Numbers(fit(data, max_angle=INNER)).compare_with(inner())
    return found


def find_cause(row):
    """Return the key in `CAUSES` of why two fits differ, or None if they are equal."""
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
    """Return whether all numbers of two fits are equal; `beside`: their comparison."""
    count, same, _, _, *factors = beside
    return count == same and all(abs(factor - 1) <= SAME_ALBEDO for factor in factors)
