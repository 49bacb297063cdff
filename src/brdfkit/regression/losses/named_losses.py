"""The losses that have a name, such as "cbrt" and "log".

A loss whose formula has only the cosine of θ_i is computed with a mean of both cosines instead. The
integral over all pairs of directions is the same, because a BRDF is reciprocal, and a file may list
either direction first.

A measured value may be negative, from noise or from a colour out of gamut. Losses that are linear
in the model use it as it is; the other losses use 0, because their functions need values ≥ 0.
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

# The loss of a fit that names none
DEFAULT = "cbrt"
# Added inside the logarithm, which is nearly linear for smaller values, and to the measured value
# that divides a relative difference: about the noise of a measured table [sr⁻¹]
OFFSET = 1e-3
# Added inside the cube root, which has no derivative at 0
CBRT_OFFSET = 1e-6


def _cosine_difference(
    model: JitFloat, measured: JitFloat, cos_i: JitFloat, cos_o: JitFloat
) -> JitFloat:
    return dr.sqrt((dr.square(cos_i) + dr.square(cos_o)) / 2) * (model - measured)


def _cbrt_difference(
    model: JitFloat, measured: JitFloat, cos_i: JitFloat, cos_o: JitFloat
) -> JitFloat:
    squares = dr.square(dr.cbrt(cos_i)) + dr.square(dr.cbrt(cos_o))
    roots = dr.cbrt(model + CBRT_OFFSET), dr.cbrt(dr.maximum(measured, 0) + CBRT_OFFSET)
    return dr.sqrt(squares / 2) * (roots[0] - roots[1])


def _log_difference(
    model: JitFloat, measured: JitFloat, cos_i: JitFloat, cos_o: JitFloat
) -> JitFloat:
    cosines = cos_i * cos_o
    return dr.log(cosines * model + OFFSET) - dr.log(cosines * dr.maximum(measured, 0) + OFFSET)


def _relative_difference(
    model: JitFloat, measured: JitFloat, cos_i: JitFloat, cos_o: JitFloat
) -> JitFloat:
    return (model - measured) / (dr.maximum(measured, 0) + OFFSET)


def _sine(cosine: FloatArray) -> FloatArray:
    return np.sqrt(np.maximum(1 - cosine**2, 0))


class Losses(Shown, dict[str, Loss | Picture]):
    """The losses by name, which `fit` minimises; they print as a table of their meanings.

    A loss E is a root mean square of differences. These are differences of f cos θ_i [sr⁻¹] for
    "cosine", of its cube root [sr^(-1/3)] for "cbrt", of f [sr⁻¹] for "plain", and of
    f cos θ_i cos θ_o [sr⁻¹] for "lafortune". "log" has the logarithm of f cos θ_i cos θ_o, and
    "relative" f as a share of the measured one; both have no unit, and 0.1 is about 10 %. "picture"
    has differences of pixels, where 1 is white. "kurt" is the sum of f cos θ_i [sr⁻¹] over the
    samples, as in the thesis.

    >>> named["plain"].meaning
    'RMS difference of f: what is bright counts'
    """

    @property
    def by_sample(self) -> dict[str, Loss]:
        """All losses except "picture": they compare a model with the data sample by sample."""
        return {name: loss for name, loss in self.items() if isinstance(loss, Loss)}

    def __missing__(self, name: str) -> Loss | Picture:
        raise no_such_error("loss", name, self)

    def document(self) -> Document:
        """Return a table of the losses and their meanings."""
        rows = tuple((Cell(name, kind=STRONG), loss.meaning) for name, loss in self.items())
        return Document("Losses: what a fit makes small", (Table(rows),))


named = Losses(
    (loss.name, loss)
    for loss in (
        Loss(
            name="cosine",
            meaning="RMS difference of f cos θ_i by solid angle: the light that is reflected",
            difference=_cosine_difference,
            measure="solid_angle",
        ),
        Loss(
            name="log",
            meaning="RMS difference of ln(f cos θ_i cos θ_o + 0.001): relative error, dark counts",
            difference=_log_difference,
            measure="angles",
        ),
        Loss(
            name="cbrt",
            meaning="RMS difference of the cube root of f cos θ_i: between cosine and log",
            difference=_cbrt_difference,
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
            difference=_relative_difference,
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


def to_loss(value: Any) -> Loss | Picture:
    """Return the loss of a name in `named`, of a difference as a function, or a loss itself.

    Raises `BrdfkitError` for an unknown name, and for a function that fails on Dr.Jit arrays.
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
            f"A loss of your own is named {loss.name!r}; give it a name that brdfkit.losses.named "
            "lacks."
        )
    require_working_loss(loss)
    return loss
