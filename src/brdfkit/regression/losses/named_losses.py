"""The losses by name.

Those with a cosine of θ_i alone have a mean of both cosines' in its place: over all pairs of
directions the integral is the same, because a BRDF is reciprocal, and a file's samples may have
either direction first.

A measured value may be negative (noise, or a colour out of gamut): the losses that are linear in
the model take it as it is, the others as 0, because their functions need values ≥ 0.
"""

from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.documents import Cell, Document, Shown, Table
from brdfkit.core.documents.parts import STRONG
from brdfkit.core.errors import BrdfkitError, no_such
from brdfkit.regression.losses.loss import Loss, loss_of, require_working
from brdfkit.regression.losses.picture import Picture

# The loss of a fit that names none
DEFAULT = "cbrt"
# Added inside the logarithm, which is nearly linear for smaller values, and to the measured value
# below a relative difference: about the noise of a measured table [sr⁻¹]
OFFSET = 1e-3
# Added inside the cube root, which has no derivative at 0
CBRT_OFFSET = 1e-6


def _cosine(model, measured, cos_i, cos_o):
    return dr.sqrt((dr.square(cos_i) + dr.square(cos_o)) / 2) * (model - measured)


def _cbrt(model, measured, cos_i, cos_o):
    squares = dr.square(dr.cbrt(cos_i)) + dr.square(dr.cbrt(cos_o))
    roots = dr.cbrt(model + CBRT_OFFSET), dr.cbrt(dr.maximum(measured, 0) + CBRT_OFFSET)
    return dr.sqrt(squares / 2) * (roots[0] - roots[1])


def _log(model, measured, cos_i, cos_o):
    cosines = cos_i * cos_o
    return dr.log(cosines * model + OFFSET) - dr.log(cosines * dr.maximum(measured, 0) + OFFSET)


def _relative(model, measured, cos_i, cos_o):
    return (model - measured) / (dr.maximum(measured, 0) + OFFSET)


def _sine(cosine):
    return np.sqrt(np.maximum(1 - cosine**2, 0))


class Losses(Shown, dict[str, Loss | Picture]):
    """The losses by name: what `fit` makes small. Prints as a table of their meanings.

    A loss E is a root mean square of differences: of f cos θ_i [sr⁻¹] for "cosine", of its cube
    root [sr^(-1/3)] for "cbrt", of f [sr⁻¹] for "plain", of f cos θ_i cos θ_o [sr⁻¹] for
    "lafortune", and without a unit, 0.1 being about 10 %, of the logarithm of f cos θ_i cos θ_o for
    "log" and of f as a share of the measured one for "relative"; for "picture", of pixels, 1 being
    white. "kurt" is the thesis's sum of f cos θ_i [sr⁻¹] over the samples as they are. `by_sample`:
    all but "picture", which judge a model sample by sample.

    >>> named["plain"].meaning
    'RMS difference of f: what is bright counts'
    """

    @property
    def by_sample(self) -> dict[str, Loss]:
        """Those that are a `Loss`, which judges a model sample by sample."""
        return {name: loss for name, loss in self.items() if isinstance(loss, Loss)}

    def __missing__(self, name: str) -> Loss | Picture:
        raise no_such("loss", name, self)

    def document(self) -> Document:
        """The losses by name, with the meaning of each."""
        rows = tuple((Cell(name, kind=STRONG), loss.meaning) for name, loss in self.items())
        return Document("Losses: what a fit makes small", (Table(rows),))


named = Losses(
    (loss.name, loss)
    for loss in (
        Loss(
            name="cosine",
            meaning="RMS difference of f cos θ_i by solid angle: the light that is reflected",
            difference=_cosine,
            measure="solid_angle",
        ),
        Loss(
            name="log",
            meaning="RMS difference of ln(f cos θ_i cos θ_o + 0.001): relative error, dark counts",
            difference=_log,
            measure="angles",
        ),
        Loss(
            name="cbrt",
            meaning="RMS difference of the cube root of f cos θ_i: between cosine and log",
            difference=_cbrt,
        ),
        Loss(
            name="plain",
            meaning="RMS difference of f: what is bright counts",
            difference=lambda model, measured, cos_i, cos_o: model - measured,
            measure="solid_angle",
        ),
        Loss(
            name="lafortune",
            meaning="RMS difference of f cos θ_i cos θ_o [Lafortune et al. 1997]",
            difference=lambda model, measured, cos_i, cos_o: cos_i * cos_o * (model - measured),
            measure="solid_angle",
        ),
        Loss(
            name="relative",
            meaning="RMS difference of f as a share of the measured f + 0.001: dark counts",
            difference=_relative,
            measure="angles",
        ),
        Loss(
            name="kurt",
            meaning="the sum of [Kurt 2007, eq. 5.13]: f cos θ_i, w = sin θ_i, each sample one, "
            "channels summed",
            difference=lambda model, measured, cos_i, cos_o: cos_i * (model - measured),
            measure="samples",
            weights=_sine,
            channel_mean=False,
        ),
        Picture(),
    )
)


def as_loss(given: Any) -> Loss | Picture:
    """The loss of a name in `named`, of a difference written as a function, or a loss itself.

    Raises `BrdfkitError` for an unknown name, and for a function that fails on Dr.Jit's arrays.
    """
    if isinstance(given, str) and given in named:
        return named[given]
    if isinstance(given, Picture):
        return given
    if not callable(given) and not isinstance(given, Loss):
        raise no_such("loss", given, named)
    loss = given if isinstance(given, Loss) else loss_of(given)
    if loss is named.get(loss.name):
        return loss
    if not isinstance(loss.name, str) or loss.name in named:
        raise BrdfkitError(
            f"A loss of your own is named {loss.name!r}; give it a name that brdfkit.losses.named "
            "lacks."
        )
    require_working(loss)
    return loss
