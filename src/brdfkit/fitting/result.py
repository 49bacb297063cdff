"""`Fit`, what a fit returns: the model with its values, and how they were found."""

from dataclasses import dataclass, field
from typing import Any

from brdfkit.model import Model


@dataclass(frozen=True)
class Fit:
    """A model fitted to a measured material. Evaluates and renders like its `model`.

    `loss`: E of the loss named `loss_name` (its units: `brdfkit.losses`); `at_bounds`:
    parameters that ended on a bound; `notes`: what else one should know; `data`: name of the
    material; `settings`: what `fit` got.
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
    def name(self):
        """What pictures and tables call it."""
        return self.model.name

    @property
    def values(self):
        """The parameters' values by name; a weight is a tuple with one number per channel."""
        return self.model.values

    def eval(self, wi, wo):
        """BRDF (n, channels) in sr⁻¹ of direction pairs (n, 3)."""
        return self.model.eval(wi, wo)

    def scene_dict(self):
        """The dictionary for `mitsuba.load_dict`."""
        return self.model.scene_dict()

    def __str__(self):
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
