"""Errors and coverage of materials that are completed from 8, 20 and 64 directions.

python benchmarks/few_measurements.py FOLDER ... [--loose FOLDER ...]

Each folder holds measured isotropic materials of one kind. Every material is completed by the
prior that comes with brdfkit, and, if the folder has 30 or more, by a prior of the other materials
of its folder, mixed with that of brdfkit (5 folds). The directions are those that tell most, of
6,000 below 75°, and values get 5 % noise, except those of folders behind --loose, which have their
own.

error: root mean square of ln(f cosθi cosθo + 10⁻³) over 3,000 pairs of directions that were
measured, spread like the cells of a MERL table, with both angles below 80° (75° behind --loose);
the mean of the materials, and the largest. coverage: of 95 % intervals below 75°;
the mean, and the least. unlike: share of the materials with a scale above 2. A line "off by 0.25°"
has directions that are wrong by this angle, and says so. In a line "over 1°" a value is the mean
over a cone with this half angle about the detector's direction, and `complete` is told so or not.
"""

import argparse
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy import stats

import brdfkit as bk
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.geometry.directions import to_half_difference
from brdfkit.materials.completion.observations import Lookup, observe, turn
from brdfkit.materials.completion.planning import choose_directions
from brdfkit.materials.completion.posterior import (
    DEGREES_OF_FREEDOM,
    INDEPENDENT_CHANNELS,
    ChannelSolver,
)
from brdfkit.materials.completion.prior import Prior
from brdfkit.materials.completion.prior_cells import get_cells, to_logarithm
from brdfkit.materials.completion.prior_choice import get_default_prior
from brdfkit.materials.completion.prior_folder import FEWEST_MATERIALS, list_files
from brdfkit.materials.completion.prior_making import make_prior
from brdfkit.model.samples import Samples

COUNTS = 8, 20, 64
NOISE = 0.05
REACH, TARGET = np.radians(75), np.radians(80)
CONE_POINTS = 200
CANDIDATES, EVALUATED, FOLDS, RANDOM_CHOICES = 6_000, 3_000, 5, 10
CELLS = get_cells()


@dataclass(frozen=True)
class Truth:
    """A material.

    `logarithms` (channels, cells); `evaluate`: its BRDF; `samples`: what was measured if it is no
    table.
    """

    logarithms: np.ndarray
    evaluate: Callable[[np.ndarray, np.ndarray], np.ndarray]
    samples: Samples | None


@dataclass(frozen=True)
class Pairs:
    """Pairs of directions that were measured of all materials of a folder."""

    wi: np.ndarray
    wo: np.ndarray

    def list_near(self) -> np.ndarray:
        """Return which pairs have both angles below 75°."""
        return np.asarray((self.wi[:, 2] > np.cos(REACH)) & (self.wo[:, 2] > np.cos(REACH)))


def read_materials(folder: Path) -> dict[str, Truth]:
    """Read all isotropic materials of a folder."""
    found = {}
    for file in list_files(folder):
        try:
            data = bk.load(file)
        except BrdfkitError:
            continue
        if isinstance(data, bk.Measured) and not data.anisotropic:
            data = data.rgb
            logarithms = to_logarithm(data.eval(CELLS.wi, CELLS.wo).T, CELLS.cosine)
            scattered = data._table is None and data._lookup is None
            samples = data.samples.at(data.samples.valid) if scattered else None
            found[file.name] = Truth(logarithms, data.eval, samples)
    return found


def list_pairs(materials: dict[str, Truth], limit: float) -> Pairs:
    """Return the cells, or for a goniometer's files the directions of the first, below `limit`."""
    samples = next(iter(materials.values())).samples
    wi, wo = (
        (CELLS.wi[CELLS.own], CELLS.wo[CELLS.own]) if samples is None else (samples.wi, samples.wo)
    )
    below = (wi[:, 2] > np.cos(limit)) & (wo[:, 2] > np.cos(limit))
    return Pairs(wi[below], wo[below])


def list_candidates(pairs: Pairs) -> np.ndarray:
    """Return rows of `pairs` that a goniometer reaches."""
    apart = np.sum(pairs.wi * pairs.wo, axis=1) < np.cos(np.radians(5))
    return np.random.default_rng(0).permutation(np.flatnonzero(pairs.list_near() & apart))[
        :CANDIDATES
    ]


def draw_evaluated(pairs: Pairs) -> np.ndarray:
    """Draw rows of `pairs` that are spread like the cells of a table."""
    theta_h, theta_d, phi_d = to_half_difference(pairs.wi, pairs.wo)
    fold = np.minimum(phi_d % np.pi, np.pi - phi_d % np.pi)
    bins = [np.sqrt(theta_h / (np.pi / 2)) * 20, theta_d / (np.pi / 2) * 10, fold / (np.pi / 2) * 4]
    h, d, p = (np.minimum(b.astype(int), n - 1) for b, n in zip(bins, (20, 10, 4), strict=True))
    key = (h * 10 + d) * 4 + p
    weights = 1 / np.bincount(key)[key]
    rng = np.random.default_rng(1)
    return rng.choice(len(key), min(EVALUATED, len(key)), p=weights / weights.sum())


@dataclass(frozen=True)
class Instrument:
    """What is wrong with an instrument.

    `off`: the angle [rad] by which both directions are wrong. `aperture`: half angle [rad] of the
    detector's cone. `stated_aperture`: what `complete` is told of it. `note`: the same in words.
    """

    off: float = 0.0
    aperture: float = 0.0
    stated_aperture: float = 0.0
    note: str = ""

    def measure(
        self, truth: Truth, wi: np.ndarray, wo: np.ndarray, rng: np.random.Generator
    ) -> np.ndarray:
        """Return the values (n, channels) that it measures, before their noise."""
        if self.off:
            wi, wo = (turn(w, self.off, rng.uniform(0, 2 * np.pi, len(w))) for w in (wi, wo))
        if not self.aperture:
            return truth.evaluate(wi, wo)
        # A spiral with equal areas between its points
        spiral = [
            turn(
                wo,
                self.aperture * np.sqrt((k + 0.5) / CONE_POINTS),
                np.full(len(wo), k * np.pi * (3 - np.sqrt(5))),
            )
            for k in range(CONE_POINTS)
        ]
        return np.mean([truth.evaluate(wi, w) for w in spiral], axis=0)


INSTRUMENTS = (
    Instrument(off=np.radians(0.25), note="off by 0.25°"),
    Instrument(aperture=np.radians(1), note="over 1°, not told"),
    Instrument(aperture=np.radians(1), stated_aperture=np.radians(1), note="over 1°, told"),
)


def complete(
    prior: Prior,
    truth: Truth,
    pairs: Pairs,
    rows: np.ndarray,
    noise: float,
    instrument: Instrument,
    seed: int,
) -> tuple[float, float, float]:
    """Complete a material from `rows` of pairs; return its error, coverage and scale."""
    rng = np.random.default_rng(seed)
    wi, wo = pairs.wi[rows], pairs.wo[rows]
    values = instrument.measure(truth, wi, wo, rng)
    values = values * (1 + noise * rng.normal(size=values.shape))
    observed = observe(wi, wo, values, NOISE, instrument.off, instrument.stated_aperture)
    at = draw_evaluated(pairs)
    lookup = Lookup.at(pairs.wi[at], pairs.wo[at])
    logarithms = to_logarithm(truth.evaluate(pairs.wi[at], pairs.wo[at]).T, lookup.cosine)
    q, mean = lookup.interpolate(prior.components), lookup.interpolate(prior.mean)
    left, misses, deviations, misfits = lookup.interpolate(prior.new_remainder), [], [], []
    for k in range(values.shape[1]):
        channel = ChannelSolver(prior, observed, k, 1.0)
        z = channel.find_weights(prior.new_remainder)
        covariance, misfit = channel.find_covariance()
        variance = np.sum((q @ covariance) * q, axis=1) + left
        misses.append(mean + q @ z - logarithms[k])
        deviations.append(np.sqrt(variance))
        misfits.append(misfit)
    channels = min(values.shape[1], INDEPENDENT_CHANNELS)
    freedom = DEGREES_OF_FREEDOM + channels * len(rows)
    scale = np.sqrt((DEGREES_OF_FREEDOM + channels * np.mean(misfits)) / freedom)
    half = stats.t.ppf(0.975, freedom) * max(scale, 1) * np.array(deviations)
    covered = (np.abs(misses) < half)[:, pairs.list_near()[at]]
    return float(np.sqrt(np.mean(np.square(misses)))), float(covered.mean()), float(scale)


def make_fold_priors(folder: str, materials: dict[str, Truth]) -> dict[str, Prior]:
    """Return for each material a prior of the materials of other folds."""
    names, base = list(materials), get_default_prior()
    fold = np.random.default_rng(1).permutation(len(names)) % FOLDS
    priors = {}
    for k in range(FOLDS):
        rows = [materials[n].logarithms for n, f in zip(names, fold, strict=True) if f != k]
        groups = np.repeat(np.arange(len(rows)), [len(row) for row in rows])
        prior = make_prior(folder, np.concatenate(rows), groups, base=base)
        priors |= {n: prior for n, f in zip(names, fold, strict=True) if f == k}
    return priors


def test_materials(
    title: str, materials: dict[str, Truth], priors: dict[str, Prior], noise: float
) -> None:
    """Print the lines of a folder and a kind of prior."""
    pairs, kinds = (
        list_pairs(materials, TARGET if noise else REACH),
        {id(p): p for p in priors.values()},
    )
    rows = list_candidates(pairs)
    for count, instrument in [
        *((n, Instrument()) for n in COUNTS),
        *((20, i) for i in INSTRUMENTS),
    ]:
        candidates = pairs.wi[rows], pairs.wo[rows]
        chosen = {
            key: rows[choose_directions(p, *candidates, count, noise, instrument.off)[0]]
            for key, p in kinds.items()
        }
        results = [
            complete(priors[name], truth, pairs, chosen[id(priors[name])], noise, instrument, seed)
            for seed, (name, truth) in enumerate(materials.items())
        ]
        errors, covered, scales = np.array(results).T
        note = f" {instrument.note}"
        if count == 20 and not instrument.note:
            note = count_wins(materials, priors, pairs, noise, errors)
        print(
            f"{title:32}{count:4}{errors.mean():8.3f}{errors.max():7.3f}{covered.mean():9.3f}"
            f"{covered.min():7.2f}{np.mean(scales > 2):8.2f} {note}",
            flush=True,
        )


def count_wins(
    materials: dict[str, Truth],
    priors: dict[str, Prior],
    pairs: Pairs,
    noise: float,
    errors: np.ndarray,
) -> str:
    """Return how often chosen directions are better than the median of random ones."""
    rows = list_candidates(pairs)
    rng, wins, names = np.random.default_rng(2), 0, list(materials)[:: max(1, len(materials) // 20)]
    for name in names:
        seed = list(materials).index(name)
        others = [
            complete(
                priors[name],
                materials[name],
                pairs,
                rng.choice(rows, 20),
                noise,
                Instrument(),
                seed,
            )[0]
            for _ in range(RANDOM_CHOICES)
        ]
        wins += errors[seed] < np.median(others)
    return f" better than random directions: {wins} of {len(names)}"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folders", nargs="*", type=Path)
    parser.add_argument("--loose", nargs="*", type=Path, default=[], help="folders without noise")
    options = parser.parse_args()
    head = f"{'folder, prior':32}   n   error  worst coverage  least  unlike"
    print(head)
    for folder in [*options.folders, *options.loose]:
        materials, noise = read_materials(folder), 0.0 if folder in options.loose else NOISE
        name = f"{folder.name} ({len(materials)})"
        test_materials(
            f"{name}, models", materials, dict.fromkeys(materials, get_default_prior()), noise
        )
        if len(materials) >= FEWEST_MATERIALS:
            own = make_fold_priors(folder.name, materials)
            test_materials(f"{name}, own + models", materials, own, noise)


if __name__ == "__main__":
    main()
