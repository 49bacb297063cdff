"""Ranks models for `-m best` of `brdfkit fit` and `brdfkit report`, and prints the ranking."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

from brdfkit.cli.console import Console
from brdfkit.cli.errors import exit_interrupted, print_message
from brdfkit.core.errors import BrdfkitError

if TYPE_CHECKING:
    from brdfkit.fitting.ranking import Ranking
    from brdfkit.materials.measured import Measured

BEST = "best"  # the word that stands for the recommended model
# Options that a ranking ignores, by the names of their settings
IGNORED_OPTIONS = {"robust": "robust", "spectral": "spectral", "fixed": "fixed", "bounds": "bound"}


def recommend_model(
    names: list[str],
    material: Measured,
    how: Mapping[str, Any],
    console: Console,
    ranked: list[str] | None = None,
) -> tuple[list[str], Ranking | None]:
    """Rank all models on a material, and print the ranking, if "best" is among the `names`.

    Returns the names with the recommended model instead of "best", and the ranking or None. `how`
    are the settings of the fit; `ranked` are the labels of the models to rank, None for all. An
    interrupted ranking ends the command.
    """
    from brdfkit.fitting.ranking import rank
    from brdfkit.fitting.settings import require_no_sample_settings

    if BEST not in names:
        return names, None
    if how["loss"] == "picture":  # the fit would refuse these settings only after the ranking
        require_no_sample_settings(robust=how.get("robust"), spectral=how.get("spectral"))
    for setting, option in IGNORED_OPTIONS.items():
        if how.get(setting):
            print_message(f"models are ranked without --{option}; the fit then uses it.")
    settings = {name: how[name] for name in ("loss", "max_angle", "seed")}
    with console.progress(f"rank models on {material.name}") as progress:
        ranking = rank(material, ranked, **settings, progress=progress)
    _print_ranking(ranking, console)
    if len(ranking.rows) < ranking.requested:
        exit_interrupted(f"{len(ranking.rows)} of {ranking.requested} models are ranked")
    models = [ranking.best if name == BEST else name for name in names]
    return list(dict.fromkeys(models)), ranking


def refuse_best(names: Iterable[str]) -> None:
    """Raise `BrdfkitError` where "best" is among the `names` of models for several files."""
    if BEST in names:
        raise BrdfkitError("-m best ranks models on one material; name one FILE, or a model.")


def _print_ranking(ranking: Ranking, console: Console) -> None:
    """Print a ranking as a table and sentences, unless results are JSON, and the models' errors."""
    from brdfkit.fitting.ranking.result import COLUMNS

    if not console.as_json:
        title = f"{ranking.material}: errors ({ranking.loss}) at directions that were held out"
        console.print_table(COLUMNS, ranking.table(), title=title)
        sentences = [ranking.reason, *ranking.doubts, ranking.suits, ""]
        console.output.print("\n".join(filter(None, sentences)))
    for problem in ranking.problems:
        print_message(problem)


def make_ranking_record(ranking: Ranking | None) -> dict[str, Any] | None:
    """Return a ranking as a dictionary for --json; None stays None."""
    if ranking is None:
        return None
    return {
        "best": ranking.best,
        "reason": ranking.reason,
        "models": [
            {
                **vars(row),
                "tied": row.tied,
                "psnr": row.psnr,
                "albedo": row.albedo and vars(row.albedo),
            }
            for row in ranking.rows
        ],
    }
