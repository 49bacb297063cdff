"""Defines the losses that a fit can minimise by name, such as "cbrt" and "log".

The formula of some losses contains only the cosine of the angle of incidence θ_i. They are computed
with a mean of the cosines of θ_i and of the angle of view θ_o, so that it does not matter which
direction a file lists first. The integral over all pairs of directions stays the same, because a
BRDF is reciprocal.

A measured value may be negative, because of noise or of a colour out of gamut. Losses that are
linear in the model use it unchanged; the other losses use 0, because their functions need values
≥ 0.
"""

from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.array_types import FloatArray, JitFloat
from brdfkit.core.documents import Cell, Document, Shown, Table
from brdfkit.core.documents.parts import STRONG
from brdfkit.core.errors import BrdfkitError, no_such_error
from brdfkit.regression.losses.loss import Loss, make_loss, require_working_loss
from brdfkit.regression.losses.picture import Picture

# Name of the loss that a fit minimises by default
DEFAULT = "cbrt"
# Noise of a measured table [sr⁻¹]; smaller BRDF values count little in the losses log and relative
OFFSET = 1e-3
# Added to the argument of the cube root, because its derivative at 0 is infinite
CBRT_OFFSET = 1e-6


def _compute_cosine_difference(
    model: JitFloat, measured: JitFloat, cos_i: JitFloat, cos_o: JitFloat
) -> JitFloat:
    return dr.sqrt((dr.square(cos_i) + dr.square(cos_o)) / 2) * (model - measured)


def _compute_cbrt_difference(
    model: JitFloat, measured: JitFloat, cos_i: JitFloat, cos_o: JitFloat
) -> JitFloat:
    squares = dr.square(dr.cbrt(cos_i)) + dr.square(dr.cbrt(cos_o))
    roots = dr.cbrt(model + CBRT_OFFSET), dr.cbrt(dr.maximum(measured, 0) + CBRT_OFFSET)
    return dr.sqrt(squares / 2) * (roots[0] - roots[1])


def _compute_log_difference(
    model: JitFloat, measured: JitFloat, cos_i: JitFloat, cos_o: JitFloat
) -> JitFloat:
    cosines = cos_i * cos_o
    return dr.log(cosines * model + OFFSET) - dr.log(cosines * dr.maximum(measured, 0) + OFFSET)


def _compute_relative_difference(
    model: JitFloat, measured: JitFloat, cos_i: JitFloat, cos_o: JitFloat
) -> JitFloat:
    return (model - measured) / (dr.maximum(measured, 0) + OFFSET)


def _compute_sine(cosine: FloatArray) -> FloatArray:
    return np.sqrt(np.maximum(1 - cosine**2, 0))


class Losses(Shown, dict[str, Loss | Picture]):
    """A dictionary of the losses that `fit` minimises, by name; it prints as a table.

    A loss E is the root mean square (RMS) difference between a model and the data. Most losses
    compare the BRDF f, or its product with cosines of the angles of incidence θ_i and of view θ_o:

    - "cosine": f cos θ_i [sr⁻¹].
    - "cbrt": the cube root of f cos θ_i [sr^(-1/3)].
    - "plain": f [sr⁻¹].
    - "lafortune": f cos θ_i cos θ_o [sr⁻¹].
    - "log": the logarithm of f cos θ_i cos θ_o, without unit; 0.1 is about 10 %.
    - "relative": f as a share of the measured f, without unit; 0.1 is about 10 %.
    - "kurt": f cos θ_i [sr⁻¹], summed over the samples as in [Kurt 2007].
    - "picture": the pixels of pictures of a ball, where 1 is white.

    >>> named["plain"].meaning
    'RMS difference of f: what is bright counts'
    """

    @property
    def by_sample(self) -> dict[str, Loss]:
        """The losses that compare a model with the data sample by sample: all but "picture"."""
        return {name: loss for name, loss in self.items() if isinstance(loss, Loss)}

    def __missing__(self, name: str) -> Loss | Picture:
        raise no_such_error("loss", name, self)

    def document(self) -> Document:
        """Return the page that the losses print: a table of their names and meanings."""
        rows = tuple((Cell(name, kind=STRONG), loss.meaning) for name, loss in self.items())
        return Document("Losses: what a fit makes small", (Table(rows),))


named = Losses(
    (loss.name, loss)
    for loss in (
        Loss(
            name="cosine",
            meaning="RMS difference of f cos θ_i by solid angle: the light that is reflected",
            difference=_compute_cosine_difference,
            measure="solid_angle",
        ),
        Loss(
            name="log",
            meaning="RMS difference of ln(f cos θ_i cos θ_o + 0.001): relative error, dark counts",
            difference=_compute_log_difference,
            measure="angles",
        ),
        Loss(
            name="cbrt",
            meaning="RMS difference of the cube root of f cos θ_i: between cosine and log",
            difference=_compute_cbrt_difference,
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
            difference=_compute_relative_difference,
            measure="angles",
        ),
        Loss(
            name="kurt",
            meaning="the sum of [Kurt 2007, eq. 5.13]: f cos θ_i, w = sin θ_i, each sample one, "
            "channels summed",
            difference=lambda model, measured, cos_i, cos_o: cos_i * (model - measured),
            measure="samples",
            weights=_compute_sine,
            channel_mean=False,
        ),
        Picture(),
    )
)


def to_loss(value: Any) -> Loss | Picture:
    """Return the loss that a user gives as a name in `named`, as a function, or as an object.

    A function computes the difference between a model and the data, as in `Loss`. Raises
    `BrdfkitError` for an unknown name, and for a function that fails on Dr.Jit arrays.
    """
    if isinstance(value, str) and value in named:
        return named[value]
    if isinstance(value, Picture):
        return value
    if not callable(value) and not isinstance(value, Loss):
        raise no_such_error("loss", value, named)
    loss = value if isinstance(value, Loss) else make_loss(value)
    if loss is named.get(loss.name):
        return loss
    if not isinstance(loss.name, str) or loss.name in named:
        raise BrdfkitError(
            f"A loss of your own is named {loss.name!r}; give it a text as name that is not in "
            "brdfkit.losses.named."
        )
    require_working_loss(loss)
    return loss
