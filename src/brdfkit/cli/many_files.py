"""`brdfkit fit` of several files: sweeps them, and prints one table."""

import click

from brdfkit.cli.errors import say
from brdfkit.core.interrupts import exit_status


def fit_many(files, names, settings, output, workers, judge, console):
    """Fit the models of these `names` to all `files`, and print their errors.

    `output`: the folder for the fits, or None; `workers`: the number of processes, or None;
    `judge`: whether to tell errors that were held out and pictures, too. What fails is said in one
    sentence each; the exit status is then 2.
    """
    from brdfkit.cli.arguments import results_folder
    from brdfkit.fitting.sweeping import sweep

    options = {"folder": output, "workers": workers, "judge": judge}
    what = f"fit {len(names)} models to {len(files)} materials"
    with results_folder(output), console.progress(what) as progress:
        found = sweep(files, names, settings=settings, **options, progress=progress)
    _print_sweep(found, output, console)
    for problem in found.problems:
        say(problem)
    interrupted = len(found.rows) < found.requested
    if interrupted:
        more = "; the same command goes on from there" if output else ""
        say(f"interrupted; {len(found.fits)} of {found.requested} fits are finished{more}.")
    if interrupted or found.failed:
        click.get_current_context().exit(exit_status() if interrupted else 2)


def _print_sweep(found, output, console):
    """Print the table of errors; of a sweep without any fit nothing, but as JSON."""
    from brdfkit.fitting.sweeping.sweeping import PAGE, TABLE
    from brdfkit.fitting.sweeping.tables import compare, quantities

    made = [output / PAGE, output / TABLE] if output and found.fits else []
    if console.as_json:
        fits = [_record(row) for row in found.rows if row.fit]
        failed = [
            {"material": r.material, "file": r.file, "model": r.model, "message": r.message}
            for r in found.failed
        ]
        saved = [row.saved for row in found.rows if row.saved]
        console.json({"fits": fits, "failed": failed, "written": [*made, *saved]})
    elif found.fits:
        for quantity in quantities(found):
            columns, *sections = compare(found, quantity)
            unit = "" if quantity.decibels else f" ({found.rows[0].loss})"
            console.table(columns, *sections, title=f"{quantity.title}{unit}")
        console.out.print(found.summary)
        console.list_written(made)
        if made:
            console.list_written([f"{output}/MATERIAL/MODEL.json, {len(found.fits)} fits"])


def _record(row):
    """A fit for JSON."""
    return {
        "material": row.material,
        "file": row.file,
        "model": row.model,
        "parameters": row.fit.values,
        "loss": row.loss,
        "error": row.error,
        "held_out": row.held_out,
        "psnr": row.psnr,
        "albedo": row.fit.albedo,
        "at_bounds": row.at_bounds,
        "notes": row.fit.notes,
        "samples": row.samples,
        "seconds": row.seconds,
        "message": row.message,
    }
