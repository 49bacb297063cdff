"""`Fit`, what a fit returns: the model with its values, and how they were found."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from brdfkit.model import Model


@dataclass(frozen=True)
class Fit:
    """A model fitted to a measured material. Evaluates and renders like its model. Made by `fit`.

    Attributes
    ----------
    model : Model
        The model with the values that were found.
    data : str
        Name of the measured material.
    loss_name : str
        Name of the loss, one of `brdfkit.losses`.
    loss : float
        E of that loss, in its units.
    samples : int
        Number of samples that were fitted.
    evaluations : int
        How often the loss was evaluated.
    seconds : float
        Wall-clock time.
    message : str
        Why the search stopped.
    at_bounds : tuple of str
        Parameters that ended on a bound.
    notes : tuple of str
        What else one should know of the fit.
    settings : dict
        The other arguments of `fit`.
    """

    model: Model
    data: str
    loss_name: str
    loss: float
    samples: int
    evaluations: int
    seconds: float = field(compare=False)
    message: str
    at_bounds: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    settings: dict[str, Any] = field(default_factory=dict, hash=False)

    @property
    def name(self) -> str:
        """What pictures and tables call it."""
        return self.model.name

    @property
    def values(self) -> dict[str, float | tuple[float, ...]]:
        """The parameters' values by name; a weight is a tuple with one number per channel."""
        return self.model.values

    def eval(self, wi: ArrayLike, wo: ArrayLike) -> NDArray[np.float64]:
        """BRDF (n, channels) in sr⁻¹ of direction pairs (n, 3)."""
        return self.model.eval(wi, wo)

    def scene_dict(self) -> dict[str, Any]:
        """The dictionary for `mitsuba.load_dict`."""
        return self.model.scene_dict()

    def __str__(self) -> str:
        width = max(map(len, self.values))
        lines = [f"{self.name} fitted to {self.data}: {self.loss_name} loss {self.loss:.6g}"]
        for name, value in self.values.items():
            numbers = "  ".join(
                f"{v:.6g}" for v in (value if isinstance(value, tuple) else [value])
            )
            note = "   on its bound" if name in self.at_bounds else ""
            lines.append(f"  {name:<{width}}  {numbers}{note}")
        lines += [f"  {note}" for note in self.notes]
        lines.append(
            f"  {self.message}; {self.samples:,} samples, {self.evaluations} evaluations, "
            f"{self.seconds:.2f} s"
        )
        return "\n".join(lines)
