"""`compare_samplers`: which sampler of an environment map costs least on a user's map and mesh."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from brdfkit.core.arguments import to_whole_number
from brdfkit.core.array_types import FloatArray, MitsubaObject
from brdfkit.core.colours import luminance
from brdfkit.core.documents import Document, Paragraph, Shown, Table
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit.threads import in_turn
from brdfkit.core.progress_bar import Progress
from brdfkit.materials import resolve
from brdfkit.mitsuba_bridge.properties.picture_file import load_by_mitsuba
from brdfkit.rendering.progressive import to_rgb
from brdfkit.rendering.scene_input.arguments import load_mitsuba
from brdfkit.rendering.scene_input.environment import describe_environment, replace_light
from brdfkit.rendering.scene_input.loading import find_scene, find_suffix
from brdfkit.rendering.scene_input.material import load_material

SAMPLERS: dict[str, dict[str, Any]] = {
    "envmap": {"type": "envmap"},
    "blocks": {"type": "kdtree_envmap"},
    "blocks, compensated": {"type": "kdtree_envmap", "compensated": True},
    "cdf": {"type": "sampled_envmap", "sampler": "cdf"},
    "alias": {"type": "sampled_envmap", "sampler": "alias"},
    "alias, compensated": {"type": "sampled_envmap", "sampler": "alias", "compensated": True},
}
SPP, SIZE, ROUNDS, FEWEST_ROUNDS = 16, 96, 10, 3
LEVEL = 0.05  # of significance, for all pairs of samplers together
DARK = 0.01  # share of the mean brightness; darker pixels weigh no more than one this dark
COLUMNS = "sampler", ">noise", ">time [ms]", ">cost", ">± [%]", "beside the best"


@dataclass(frozen=True, eq=False, repr=False)
class SamplerComparison(Shown):
    """Samplers of an environment map, by the cost of equally good pictures, the least first.

    Made by `compare_samplers`.

    Attributes
    ----------
    environment, material, scene : str
        What was rendered.
    noise : dict of str to ndarray, shape (rounds,)
        The variance of a pixel over the square of its mean, in the mean over the picture.
    seconds : dict of str to ndarray, shape (rounds,)
        Processor time of a picture, the lesser of the two of a round.
    rounds_requested : int
        Rounds that were requested; Ctrl-C leaves fewer.
    """

    environment: str
    material: str
    scene: str
    noise: dict[str, np.ndarray] = field(repr=False)
    seconds: dict[str, np.ndarray] = field(repr=False)
    rounds_requested: int

    @property
    def rounds(self) -> int:
        """Rounds that were finished."""
        return len(self.noise["envmap"])

    @cached_property
    def costs(self) -> dict[str, float]:
        """Noise times time over that of Mitsuba's `envmap`, by sampler, the least first."""
        each = {n: float(v.mean() * np.median(self.seconds[n])) for n, v in self.noise.items()}
        return {name: each[name] / each["envmap"] for name in sorted(each, key=each.__getitem__)}

    @property
    def best(self) -> str:
        """The sampler of the least cost."""
        return next(iter(self.costs))

    @cached_property
    def p_values(self) -> dict[str, float]:
        """How probable a difference to the best as large as this one is if there is none.

        Tukey's test on the logarithms of costs, with the rounds as blocks: it holds for all pairs
        together, and so for the one that turned out best.
        """
        from scipy.stats import studentized_range

        logs = {name: np.log(self.noise[name] * self.seconds[name]) for name in self.noise}
        freedom = (len(logs) - 1) * (self.rounds - 1)
        p_values = {}
        for name, costs in logs.items():
            apart = abs(costs.mean() - logs[self.best].mean()) / max(self._spread, 1e-12)
            p_values[name] = (
                float(studentized_range.sf(apart, len(logs), freedom)) if apart else 1.0
            )
        return p_values

    def significant(self, name: str) -> bool:
        """Whether a sampler costs more than the best, beyond chance at 5 %."""
        return self.p_values[name] < LEVEL

    @property
    def _spread(self) -> float:
        """The standard error of the mean logarithm of a cost, pooled over samplers."""
        x = np.log([self.noise[name] * self.seconds[name] for name in self.noise])
        residuals = x - x.mean(axis=0) - x.mean(axis=1, keepdims=True) + x.mean()
        freedom = (x.shape[0] - 1) * (x.shape[1] - 1)
        return float(np.sqrt((residuals**2).sum() / freedom / x.shape[1]))

    @property
    def verdict(self) -> str:
        """Which sampler to take, how much it saves, and whether that is more than chance."""
        p, costs = self.p_values, self.costs
        alike = [name for name in costs if name != self.best and not p[name] < LEVEL]
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
        """A row of texts for each sampler, under `COLUMNS`; noise and cost over envmap's."""
        noise, p = self.noise, self.p_values
        rows: list[tuple[str, ...]] = []
        for name, cost in self.costs.items():
            ratio = float(noise[name].mean() / noise["envmap"].mean())
            said = "worse" if p[name] < LEVEL else "no clear difference"
            chance = "p < 0.001" if p[name] < 1e-3 else f"p = {p[name]:.2g}"
            beside = "best" if name == self.best else f"{said}, {chance}"
            time_of = 1e3 * float(np.median(self.seconds[name]))
            error = 100 * np.sqrt(2) * self._spread
            shown = f"{ratio:.2f}", f"{time_of:.0f}", f"{cost:.2f}", f"{error:.0f}", beside
            rows.append((name, *shown))
        return rows

    @property
    def head(self) -> str:
        """What was compared, in a line."""
        return (
            f"{self.environment} on {self.scene} of {self.material}: {self.rounds} rounds; noise "
            "and cost, noise × time, over Mitsuba's envmap"
        )

    def document(self) -> Document:
        """The table and the verdict."""
        table = Table(tuple(self.table()), COLUMNS)
        return Document(self.head, (table, Paragraph(self.verdict)))


def compare_samplers(
    environment: str | Path,
    material: resolve.MaterialLike = "plaster",
    *,
    scene: str | Path = "ball",
    rounds: int = ROUNDS,
    spp: int = SPP,
    size: int = SIZE,
    seed: int = 0,
    progress: Progress | None = None,
) -> SamplerComparison:
    """Measure which sampler of an environment map needs least time for an equally good picture.

    The picture is path-traced, so that light and surfaces are both sampled. In each round every
    sampler renders two pictures with seeds of their own, the same for all samplers; half of the
    squared difference is the variance of a pixel. The order of the samplers changes from round to
    round, so that a busy machine disturbs all alike. Ctrl-C keeps the finished rounds, from three
    on.

    Parameters
    ----------
    environment : str or Path
        The environment map: a known name or a file, as for `render`.
    material : Measured, Fit, Model, str, Path or dict, default "plaster"
        The material that is lit.
    scene : str or Path, default "ball"
        A scene under the sky, or a mesh (.obj, .ply; "FILE.obj#z" where z points up).
    rounds : int, default 10
        Number of repetitions, at least 3.
    spp : int, default 16
        Samples per pixel.
    size : int, default 96
        Side of the pictures [pixels].
    seed : int, default 0
        Seed of the first picture.
    progress : callable, optional
        Called with (done, total) after each round.

    Returns
    -------
    SamplerComparison
        Prints as a table, with the sampler to take.

    Raises
    ------
    BrdfkitError
        For a map, material or scene that cannot be rendered, and fewer than three rounds.

    Examples
    --------
    >>> print(compare_samplers("probe.exr", "car_paint", scene="teapot.obj"))    # doctest: +SKIP
    """
    rounds = to_whole_number("rounds", rounds, least=FEWEST_ROUNDS)
    spp, size = to_whole_number("spp", spp, least=1), to_whole_number("size", size, least=1)
    seed = to_whole_number("seed", seed, least=0)
    if not isinstance(scene, str | Path):
        raise BrdfkitError(f"scene = {scene!r:.60} should be a scene's name or a mesh's file.")
    load_mitsuba()
    found = resolve.to_material(material)
    noise, seconds = _measure(environment, found, scene, rounds, spp, size, seed, progress)
    where = str(Path(str(environment)).name), found.name, Path(str(scene)).name
    return SamplerComparison(*where, noise, seconds, rounds)


@in_turn
def _measure(
    environment: str | Path,
    material: resolve.Material,
    scene: str | Path,
    rounds: int,
    spp: int,
    size: int,
    seed: int,
    progress: Progress | None,
) -> tuple[dict[str, FloatArray], dict[str, FloatArray]]:
    """Return the noise and the seconds of the rounds by sampler; the arrays are (rounds,)."""
    lights = _load_scenes(environment, material, scene, size)
    names = list(lights)
    for loaded in lights.values():  # compile the kernels before anything is timed
        _render(loaded, spp, seed)
    pairs: list[dict[str, Any]] = []
    seconds: list[dict[str, float]] = []
    try:
        for r in range(rounds):
            pair: dict[str, Any] = {}
            took: dict[str, float] = {}
            for name in names[r % len(names) :] + names[: r % len(names)]:
                pair[name], each = [], []
                for k in (0, 1):
                    start = time.process_time()
                    pair[name].append(_render(lights[name], spp, seed + 2 * r + k))
                    each.append(time.process_time() - start)
                took[name] = min(each)  # other programs may have slowed the other one
            pairs.append(pair)
            seconds.append(took)
            if progress:
                progress(r + 1, rounds)
    except KeyboardInterrupt:
        if len(seconds) < FEWEST_ROUNDS:
            raise
    pairs = pairs[: len(seconds)]
    mean = np.mean([pictures for pair in pairs for pictures in pair.values()], axis=(0, 1))
    scale = np.maximum(mean, DARK * mean.mean())
    noise = {
        n: np.array([np.mean((p[n][0] - p[n][1]) ** 2 / 2 / scale**2) for p in pairs])
        for n in names
    }
    return noise, {n: np.array([took[n] for took in seconds]) for n in names}


def _load_scenes(
    environment: str | Path, material: resolve.Material, scene: str | Path, size: int
) -> dict[str, MitsubaObject]:
    """Load a `mitsuba.Scene` for each sampler, by the sampler's name."""
    import mitsuba as mi

    light, is_mesh = describe_environment(environment), bool(find_suffix(scene))
    shown = load_material(material.scene_dict(), str(material.name), both_sides=is_mesh)
    made, scenes = find_scene(scene)(shown, (size, size)), {}
    for name, sampler in SAMPLERS.items():
        scenes[name] = load_by_mitsuba(mi.load_dict, replace_light(light | sampler, made), name)
    return scenes


def _render(loaded: MitsubaObject, spp: int, seed: int) -> FloatArray:
    """Render a picture, and return its luminance (height, width)."""
    import mitsuba as mi

    return luminance(to_rgb(mi.render(loaded, spp=spp, seed=seed)).astype(float))
