"""Fits R, G and B of CUReT together, as the thesis did, where only their mean is measured.

The mean is divided among the channels by the colours that the thesis's own fits have.
"""

import numpy as np
from brdfkit.theses.kurt2007.appendix_3 import find_scales, read_rows
from brdfkit.theses.kurt2007.curet import BOUNDS, compute_error, make_signed_model
from brdfkit.theses.kurt2007.printed import SEVEN, read_printed_table

from brdfkit.fitting.fit import fit
from brdfkit.materials.measured import Measured
from brdfkit.materials.measured.selection import select_samples
from brdfkit.theses.claims import NOT_RUN, Claim
from brdfkit.theses.page import Section, Table

SECONDS = 15
NEAR = 0.1  # relative distance up to which an error is near the printed one
TEXT = """The file of the measured R, G and B is not to be had; that of their mean is. Here the mean
is brought to the printed k_d of Oren-Nayar, and divided among the channels in each pair of
directions as the printed fit with the least error of Appendix 3 has it, whose weights are all above
0. No error enters. The seven models are fitted to the three channels together, with weights of any
sign. *Grey*: the mean, times the factor by k_d of Table 9.2. Cells: printed / grey / R, G, B."""


def check_claims(sources, report):
    """Compare fits to R, G and B with the printed errors; return the section."""
    rows = read_rows(sources)
    says, where = "The errors of the seven nonlinear models, by R, G and B.", "Table 9.2"
    title = "Table 9.2 by R, G and B"
    if rows is None:
        why = "The transcription of Appendix 3, which has the colours, is not at hand."
        return Section(title, TEXT, [Claim(says, where, "35 errors", "", NOT_RUN, why)])
    table, scales = read_printed_table("table_9_2"), find_scales(rows)
    errors = {kind: np.zeros((len(SEVEN), len(table["materials"]))) for kind in ("grey", "rgb")}
    for column, number in enumerate(table["materials"].values()):
        of_sample = [row for row in rows if row.number == number]
        scale, channels = scales[number]
        coloured = make_coloured_material(of_sample, scale)
        for row, label in enumerate(SEVEN.values()):
            data = of_sample[0].data
            errors["grey"][row, column] = data.compute_error(label, signed=True) / scale * channels
            errors["rgb"][row, column] = _fit_channels(coloured, label)
        report(column + 1, len(table["materials"]))
    printed = np.array([table["errors"][name] for name in SEVEN])
    lines = [
        (name, *(f"{p:.4f} / {g:.4f} / {c:.4f}" for p, g, c in zip(*cells, strict=True)))
        for name, *cells in zip(SEVEN, printed, errors["grey"], errors["rgb"], strict=True)
    ]
    ratios = {kind: e / printed for kind, e in errors.items()}
    near = {kind: int((np.abs(r - 1) <= NEAR).sum()) for kind, r in ratios.items()}
    worst = np.unravel_index(np.abs(np.log(ratios["rgb"])).argmax(), printed.shape)
    materials = list(table["materials"])
    off = ", ".join(f"{m} {r:.2f}" for m, r in zip(materials, np.median(ratios["rgb"], axis=0),
                                                    strict=True))  # fmt: skip
    claim = Claim(
        says,
        where,
        f"{printed.size} errors",
        f"{near['rgb']} of {printed.size} within {NEAR:.0%}, and {near['grey']} by the mean",
        NOT_RUN,
        "The measured R, G and B are missing, and colours that are made from the printed fits "
        f"neither confirm nor refute the errors of others. The farthest is "
        f"{list(SEVEN)[worst[0]]} on "
        f"{materials[worst[1]]}, {ratios['rgb'][worst]:.2f} times the printed one; medians by "
        f"material: {off}.",
    )
    return Section(title, TEXT, [claim], [Table(("model", *materials), lines)])


def make_coloured_material(rows, scale):
    """Return a sample with three channels, by the colours of its printed fits, `rows`.

    scale : the measured over the printed albedo.
    """
    best = min((row for row in rows if row.is_usable), key=lambda row: row.error)
    values = best.lobes @ best.weights
    shares = values / values.mean(axis=1, keepdims=True)
    data = best.data
    return Measured.from_samples(
        data.wi, data.wo, data.values[:, None] / scale * shares, name=f"CUReT {best.number}"
    )


def _fit_channels(material, label):
    """Return E, eq. 5.13, of a model's fit to the three channels of a material together."""
    found = fit(
        material,
        make_signed_model(label),
        loss="kurt",
        bounds=BOUNDS.get(label),
        extrapolate="free",
    )
    return compute_error(found.model, select_samples(material, 80))
