"""`brdfkit fit -m best`: ranks the models, says which one is recommended, and why."""

import click

from brdfkit.cli.errors import say
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.interrupts import exit_status

BEST = "best"  # stands for the recommended model
# Options that a ranking leaves out, with the settings that they give
LATER = {"robust": "robust", "spectral": "spectral", "fix": "fixed", "bound": "bounds"}


def recommend(names, material, how, console):
    """The `names` with the recommended model in place of BEST, and the `Ranking`, None without.

    `how`: loss, angle and seed of the fit. An interrupted ranking is printed, and ends the command.
    """
    from brdfkit.fitting.ranking import rank
    from brdfkit.fitting.settings import require_plain

    if BEST not in names:
        return names, None
    if how["loss"] == "picture":  # what the fit would refuse after the ranking
        require_plain(robust=how.get("robust"), spectral=how.get("spectral"))
    for option, name in LATER.items():
        if how.get(name):
            say(f"models are ranked without --{option}; the fit then uses it.")
    how = {name: how[name] for name in ("loss", "max_angle", "seed")}
    with console.progress(f"rank models on {material.name}") as progress:
        ranking = rank(material, **how, progress=progress)
    if len(ranking.rows) < ranking.requested:
        print_ranking(ranking, console)
        say(f"interrupted; {len(ranking.rows)} of {ranking.requested} models are ranked.")
        click.get_current_context().exit(exit_status())
    chosen = [ranking.best if name == BEST else name for name in names]
    return list(dict.fromkeys(chosen)), ranking


def refuse_best(names):
    """Raise `BrdfkitError` where `names`, of models for several files, have BEST."""
    if BEST in names:
        raise BrdfkitError("-m best ranks models on one material; name one FILE, or a model.")


def print_ranking(ranking, console):
    """Print the table and the sentences of a ranking, but not as JSON; say what failed."""
    from brdfkit.fitting.ranking.result import COLUMNS

    if not console.as_json:
        title = f"{ranking.material}: errors ({ranking.loss}) at directions that were held out"
        console.table(COLUMNS, ranking.table(), title=title)
        said = [ranking.reason, *ranking.doubts, ranking.suits, ""]
        console.out.print("\n".join(filter(None, said)))
    for problem in ranking.problems:
        say(problem)


def record(ranking):
    """A ranking for JSON; None stays so."""
    return ranking and {
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
