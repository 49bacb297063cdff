"""Runs sequential quadratic programming, by which the thesis fits, beside Levenberg-Marquardt."""

import numpy as np
from brdfkit.theses.kurt2007.curet import BOUNDS, WLS, compute_error, load_sample, make_signed_model
from brdfkit.theses.kurt2007.printed import SEVEN, read_printed_table
from brdfkit.theses.kurt2007.table_9_2 import find_albedo_factors

from brdfkit.fitting.fit import fit
from brdfkit.regression.solvers import SLSQP
from brdfkit.theses.claims import Claim, to_verdict
from brdfkit.theses.grid import judge_over_grid
from brdfkit.theses.page import Section, Table

SECONDS = 30
STARTS = 1, 4
ALONE = 8  # single starts for each fit
SAME = 1.001  # E over that of Levenberg-Marquardt, up to which a fit is the same
TEXT = f"""The seven nonlinear models on the five materials of Table 9.2, with weights of any sign.
*LM*: our Levenberg-Marquardt from 16 starts for each shape parameter. *SQP*: SciPy's, for
MATLAB's; from one start, at the default values of the model, or from those 4 of LM's starts that
have the least E. A fit is the same if its E is at most {SAME - 1:.1%} larger. From which starts
the thesis searched is not told."""


def check_claims(sources, report):
    """Check what the search of the thesis finds; return the section with both results."""
    table = read_printed_table("table_9_2")
    numbers = list(table["materials"].values())
    factors = find_albedo_factors(sources, numbers)
    if factors is None:  # without the transcription of Appendix 3
        factors = np.ones(len(numbers))
    errors = {starts: np.zeros((len(SEVEN), len(numbers))) for starts in (None, *STARTS)}
    alone = {name: [] for name in SEVEN}
    for column, number in enumerate(numbers):
        data = load_sample(sources, number)
        for row, (name, label) in enumerate(SEVEN.items()):
            errors[None][row, column] = data.compute_error(label, WLS, signed=True)
            each = EachStart()
            fit_by_quadratic_programming(data, label, None, each)
            alone[name].extend(each.errors <= SAME * errors[None][row, column])
            for starts in STARTS:
                errors[starts][row, column] = compute_error(
                    fit_by_quadratic_programming(data, label, starts).model, data.samples
                )
        report(column + 1, len(numbers))
    lines = []
    for row, name in enumerate(SEVEN):
        printed = table["errors"][name]
        cells = [
            f"{p:.4f} / {f * lm:.4f} / {f * sqp:.4f}"
            for p, f, lm, sqp in zip(
                printed, factors, errors[None][row], errors[STARTS[-1]][row], strict=True
            )
        ]
        lines.append((name, *cells))
    caption = (
        f"E: printed / LM / SQP from {STARTS[-1]} starts. Ours times one factor per material, that "
        "of k_d in Table 9.2."
    )
    shown = Table(("model", *table["materials"]), lines, caption)
    title = "Chapter 5: sequential quadratic programming"
    single = Table(
        ("single starts that end at the least E", *table["materials"]),
        [
            (name, *(f"{sum(e)} of {len(e)}" for e in np.split(np.array(ends), len(numbers))))
            for name, ends in alone.items()
        ],
    )
    return Section(title, TEXT, [_claim_search(errors), _claim_local(alone)], [shown, single])


def fit_by_quadratic_programming(data, label, starts=1, solver=None):
    """Return the `Fit` of a model with weights of any sign to a `Sample` of CUReT by SQP.

    A single start has the default values of the model; of several, SQP takes the best. The `solver`
    may be another one than SQP.
    """
    return fit(
        data.data,
        make_signed_model(label),
        loss="kurt",
        solver=solver or SLSQP(starts=starts),
        starts=1 if starts == 1 else None,
        bounds=BOUNDS.get(label),
        extrapolate="free",
    )


class EachStart:
    """A solver that runs SQP from each of the first starts alone, and keeps the errors of all.

    errors : E at the ends of the searches.
    """

    def __init__(self):
        self.errors = []

    def minimise(self, objective):
        """Return the best `End` of searches from single starts."""
        every = objective.starts[:ALONE]
        ends = []
        for start in every:
            objective.starts = start[None]  # SQP takes the best of those that it is given
            ends.append(SLSQP(starts=1).minimise(objective))
        objective.starts = every
        self.errors = np.sqrt([end.error for end in ends])
        return min(ends, key=lambda end: end.error)


def _claim_search(errors):
    same = {starts: errors[starts] <= SAME * errors[None] for starts in STARTS}
    better = sum(int((errors[starts] * SAME < errors[None]).sum()) for starts in STARTS)
    holds = {
        (name, str(starts)): bool(same[starts][row].all())
        for row, name in enumerate(SEVEN)
        for starts in STARTS
    }
    _, verdict = judge_over_grid(["model", "number of starts"], holds)
    counts = ", ".join(f"{s.sum()} of {s.size} from {n}" for n, s in same.items())
    return Claim(
        "Sequential quadratic programming finds the fits of the seven models.",
        "5.2",
        "by it, from starts that are not told",
        counts,
        verdict,
        f"The E of LM is larger by {SAME - 1:.1%} than that of SQP on {better} of "
        f"{len(STARTS) * same[1].size}. One start is that of the default values.",
        arithmetic=True,
    )


def _claim_local(alone):
    """Return the claim on single starts; `alone`: by model, which of them ended at the least E."""
    shares = {name: np.mean(ends) for name, ends in alone.items()}
    worst = min(shares, key=shares.get)
    every = np.concatenate(list(alone.values()))
    return Claim(
        "Sequential quadratic programming is a local search.",
        "5.2",
        "local",
        f"{every.sum()} of {every.size} single starts end at the least E; of {worst} "
        f"{shares[worst]:.0%}",
        to_verdict(not every.all()),
        f"From each of the first {ALONE} of LM's starts alone. So a single start may do by luck, "
        "or because a model's E has one minimum.",
        arithmetic=True,
    )
