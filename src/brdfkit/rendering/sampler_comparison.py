"""`SamplerComparison`, the result of `compare_samplers`: noise, time and cost of each sampler."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from brdfkit.core.documents import Document, Paragraph, Shown, Table

LEVEL = 0.05  # p-value below which a difference is significant, for all pairs of samplers together
COLUMNS = "sampler", ">noise", ">time [ms]", ">cost", ">± [%]", "beside the best"


@dataclass(frozen=True, eq=False, repr=False)
class SamplerComparison(Shown):
    """Noise, time and cost of samplers of an environment map, made by `compare_samplers`.

    The cost is noise × time, which is proportional to the time for a picture of given noise. A
    comparison prints as a table, the sampler with the least cost first.

    Attributes
    ----------
    environment, material, scene : str
        Names of the environment map, the material and the scene that were rendered.
    noise : dict of str to ndarray, shape (rounds,)
        Noise of each round, by sampler: for each pixel the variance divided by the squared mean,
        averaged over the picture.
    seconds : dict of str to ndarray, shape (rounds,)
        Processor time for a picture in each round, by sampler; the lesser of two measured times.
    rounds_requested : int
        Number of requested rounds; after Ctrl-C there may be fewer.
    """

    environment: str
    material: str
    scene: str
    noise: dict[str, np.ndarray] = field(repr=False)
    seconds: dict[str, np.ndarray] = field(repr=False)
    rounds_requested: int

    @property
    def rounds(self) -> int:
        """Number of finished rounds."""
        return len(self.noise["envmap"])

    @cached_property
    def costs(self) -> dict[str, float]:
        """Cost of each sampler divided by the cost of Mitsuba's `envmap`, the least first."""
        each = {n: float(v.mean() * np.median(self.seconds[n])) for n, v in self.noise.items()}
        return {name: each[name] / each["envmap"] for name in sorted(each, key=each.__getitem__)}

    @property
    def best(self) -> str:
        """Name of the sampler with the least cost."""
        return next(iter(self.costs))

    @cached_property
    def p_values(self) -> dict[str, float]:
        """The p-value of each sampler: how probable so large a distance from the best cost is.

        It is the probability if chance alone made the costs differ, by Tukey's test on the
        logarithms of the costs, with the rounds as blocks. The test holds for all pairs of samplers
        together, so the best sampler may be chosen from the same data.
        """
        from scipy.stats import studentized_range

        logs = {name: np.log(self.noise[name] * self.seconds[name]) for name in self.noise}
        freedom = (len(logs) - 1) * (self.rounds - 1)
        p_values = {}
        for name, costs in logs.items():
            apart = abs(costs.mean() - logs[self.best].mean()) / max(self._standard_error, 1e-12)
            p_values[name] = (
                float(studentized_range.sf(apart, len(logs), freedom)) if apart else 1.0
            )
        return p_values

    def significant(self, name: str) -> bool:
        """Return whether a sampler's cost differs significantly (5 %) from the best cost."""
        return self.p_values[name] < LEVEL

    @property
    def _standard_error(self) -> float:
        """Standard error of the mean of a sampler's log costs over the rounds, for all alike."""
        x = np.log([self.noise[name] * self.seconds[name] for name in self.noise])
        residuals = x - x.mean(axis=0) - x.mean(axis=1, keepdims=True) + x.mean()
        freedom = (x.shape[0] - 1) * (x.shape[1] - 1)
        return float(np.sqrt((residuals**2).sum() / freedom / x.shape[1]))

    @property
    def verdict(self) -> str:
        """A sentence on the sampler to take, what it saves, and whether this may be chance."""
        costs = self.costs
        alike = [name for name in costs if name != self.best and not self.significant(name)]
        chance = "envmap" in alike
        alike = [name for name in alike if name != "envmap"]
        tied = f"; {', '.join(alike)} may be as good (5 %)" if alike else ""
        if self.best == "envmap":
            return f"Take envmap, Mitsuba's own{tied}."
        saved = f"{self.best} costs {costs[self.best]:.2f} times what Mitsuba's envmap does"
        if chance:
            return f"{saved}, which may be chance: take either{tied}."
        return f"Take {self.best}: it costs {saved.partition(' costs ')[2]}{tied}."

    def table(self) -> list[tuple[str, ...]]:
        """Return the rows of the table as texts, a sampler each; the heads are `COLUMNS`.

        Noise and cost are relative to those of Mitsuba's `envmap`.
        """
        noise, p = self.noise, self.p_values
        rows: list[tuple[str, ...]] = []
        for name, cost in self.costs.items():
            ratio = float(noise[name].mean() / noise["envmap"].mean())
            said = "worse" if self.significant(name) else "no clear difference"
            chance = "p < 0.001" if p[name] < 1e-3 else f"p = {p[name]:.2g}"
            beside = "best" if name == self.best else f"{said}, {chance}"
            time_of = 1e3 * float(np.median(self.seconds[name]))
            error = 100 * np.sqrt(2) * self._standard_error
            shown = f"{ratio:.2f}", f"{time_of:.0f}", f"{cost:.2f}", f"{error:.0f}", beside
            rows.append((name, *shown))
        return rows

    @property
    def head(self) -> str:
        """Title of the table: the environment, the scene, the material and the number of rounds."""
        return (
            f"{self.environment} on {self.scene} of {self.material}: {self.rounds} rounds; noise "
            "and cost, noise × time, over Mitsuba's envmap"
        )

    def document(self) -> Document:
        """Return the table and the verdict."""
        table = Table(tuple(self.table()), COLUMNS)
        return Document(self.head, (table, Paragraph(self.verdict)))
