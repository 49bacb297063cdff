"""`plan`: the pairs of directions worth measuring, in the order of what they tell."""

from __future__ import annotations

from dataclasses import dataclass
from math import radians
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from brdfkit.core.arguments import to_number, to_whole_number
from brdfkit.core.array_types import AnyArray
from brdfkit.core.colours import RGB
from brdfkit.core.documents import Document, Shown
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.geometry.directions import group_equal_pairs
from brdfkit.materials.completion import plan_output
from brdfkit.materials.completion.planning import choose_directions
from brdfkit.materials.completion.posterior import EFFECTIVE_SAMPLES
from brdfkit.materials.completion.prior_choice import PriorLike, to_prior
from brdfkit.materials.completion.reach import Arms, Reach, to_directions
from brdfkit.materials.measured.evidence import is_completed
from brdfkit.materials.resolve import MaterialLike, to_measured

MOST_DIRECTIONS = 1_000


@dataclass(frozen=True, eq=False, repr=False)
class Plan(Shown):
    """Pairs of directions worth measuring, in the order of their gain; the result of `plan`.

    It prints as a table, notebooks show a picture of it.

    Attributes
    ----------
    wi, wo : ndarray, shape (n, 3)
        Directions to the light and to the detector, z along the normal; the light is at azimuth 0.
    angles : ndarray, shape (n, 3)
        The same as angles [degrees]: theta_i, theta_o, and the azimuth phi from the light to the
        detector, between 0 and 180; 180 is the mirror direction.
    errors : ndarray, shape (n + 1,)
        Expected error of the completed BRDF before the first direction and after each: the root
        mean square of its natural logarithm, about the relative error where that is small, over all
        pairs of directions with angles below 80°.
    info : dict of str to str
        Notes by topic: the reach, the noise, the prior.

    Examples
    --------
    >>> plan(20).save("plan.csv")    # doctest: +SKIP
    """

    wi: NDArray[np.float64]
    wo: NDArray[np.float64]
    angles: NDArray[np.float64]
    errors: NDArray[np.float64]
    info: dict[str, str]

    def __len__(self) -> int:
        return len(self.angles)

    @property
    def halves(self) -> tuple[tuple[int, int | None], ...]:
        """What halves the error: pairs (k, m), m directions have half the error of k.

        k is 0, 1, 2, 4, 8 and so on; m is None if the plan has too few directions.
        """
        counts = [0, *(2**power for power in range(20) if 2**power < len(self.errors))]
        return tuple((k, self._find_first_below(self.errors[k] / 2)) for k in counts)

    def _find_first_below(self, error: float) -> int | None:
        below = np.flatnonzero(self.errors <= error)
        return int(below[0]) if below.size else None

    def document(self) -> Document:
        """Return a document with the directions, what to expect of them, and a picture."""
        return plan_output.make_document(self)

    def picture(self) -> Any:
        """Draw the directions, numbered, and the falling error, as a matplotlib `Figure`."""
        from brdfkit.materials.completion.plan_picture import draw_plan

        return draw_plan(self)

    def save(self, path: str | Path, channels: tuple[str, ...] = RGB) -> None:
        """Write the plan as a table to fill in, or as a picture.

        Parameters
        ----------
        path : str or Path
            The file: .csv for a table with empty fields for the values, which `load` reads when
            they are filled in; .png, .pdf or .svg for a picture.
        channels : sequence of str, default RGB
            Names of the columns of values: ``("R", "G", "B")``, ``("BRDF",)`` or wavelengths such
            as ``("450nm", "550nm")``.

        Raises
        ------
        BrdfkitError
            For another suffix, for channels that brdfkit does not read, and for a file that cannot
            be written.

        Examples
        --------
        >>> plan(8).save("plan.csv", channels=("BRDF",))    # doctest: +SKIP
        """
        plan_output.write_plan(self, Path(path), channels)


def plan(
    n: int,
    *,
    reach: Reach | None = None,
    measured: MaterialLike | None = None,
    prior: PriorLike = None,
    noise: float = 0.05,
    alignment: float = 0.0,
    seed: int = 0,
) -> Plan:
    """Choose the directions worth measuring of an unknown isotropic material.

    Each is the one of all within `reach` that lessens the expected error of the material most, if
    `complete` completes it from this direction and those before.

    Parameters
    ----------
    n : int
        Number of pairs of directions, from 1 to 1,000.
    reach : dict, optional
        What the instrument reaches, in degrees: ``max_theta_i`` and ``max_theta_o``, the largest
        angles of light and detector to the normal (75); ``separation``, the least angle between
        both (5); ``step`` of the arms (0.5); ``in_plane``, whether they stay in one plane (False);
        ``theta_i``, a list of angles, if the light has only a few places.
    measured : Measured, str or Path, optional
        A material of which some directions are measured already, or its file; the plan goes on from
        these.
    prior : Prior, str or Path, optional
        The prior, or a file that `brdfkit prior` wrote. By default the one that comes with brdfkit.
    noise : float, default 0.05
        Relative standard deviation of a value, from 0 to 1.
    alignment : float, default 0
        Angle [degrees] by which directions may be off, from 0 to 5. Directions in highlights then
        tell less.
    seed : int, default 0
        Seed of the directions among which the plan chooses.

    Returns
    -------
    Plan
        The directions, with the expected error after each.

    Raises
    ------
    BrdfkitError
        For a reach that is impossible or has too few directions, and for an anisotropic material.

    Examples
    --------
    >>> plan(20, reach={"max_theta_o": 60, "step": 2}).save("plan.csv")    # doctest: +SKIP
    """
    n = to_whole_number("n", n, 1, MOST_DIRECTIONS)
    arms, known = Arms.from_reach(reach), to_prior(prior)
    noise = to_number("noise", noise, least=0, most=1)
    alignment = to_number("alignment", alignment, least=0, most=5)
    candidates = arms.list_candidates(to_whole_number("seed", seed, 0))
    if len(candidates) < n:
        raise BrdfkitError(
            f"The instrument reaches {len(candidates):,} pairs of directions ({arms.describe()}), "
            f"fewer than {n:,}; ask for fewer, or give a smaller step."
        )
    already = None if measured is None else list_measured_pairs(measured)
    wi, wo = to_directions(candidates)
    rows, errors = choose_directions(known, wi, wo, n, noise, radians(alignment), already)
    info = {
        "reach": arms.describe(),
        "noise": f"{noise:.2g} of a value, directions off by {alignment:g}°",
        **known.notes(),
    }
    if already is not None:
        _, counts = group_equal_pairs(*already)
        info["measured"] = f"{len(counts):,} directions were measured before"
    angles = np.asarray(candidates[rows], np.float64)
    wi, wo = (np.asarray(w, np.float64) for w in to_directions(angles))
    return Plan(wi, wo, angles, np.asarray(errors, np.float64), info)


def list_measured_pairs(measured: MaterialLike) -> tuple[AnyArray, AnyArray]:
    """Return the directions (n, 3) each that are measured; of many, those that a completion counts.

    Raises `BrdfkitError` for an anisotropic or a completed material.
    """
    data = to_measured(measured)
    if is_completed(data):
        raise BrdfkitError(
            f"{data.name} is completed already; give what was measured, from which it was made."
        )
    if data.anisotropic:
        raise BrdfkitError(
            f"{data.name} is anisotropic, and a plan is for isotropic materials; leave measured "
            "out."
        )
    (rows,) = np.nonzero(data.samples.valid)
    if len(rows) > EFFECTIVE_SAMPLES:
        rows = np.sort(np.random.default_rng(0).choice(rows, EFFECTIVE_SAMPLES, replace=False))
    return data.samples.wi[rows], data.samples.wo[rows]
