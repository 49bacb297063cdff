"""Fits models to several files for `brdfkit fit`, and prints tables of their errors."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from brdfkit.cli.console import Console
from brdfkit.cli.errors import print_message
from brdfkit.core.interrupts import find_exit_status

if TYPE_CHECKING:
    from brdfkit.fitting.sweeping import Sweep


def fit_many_files(
    files: Sequence[str],
    names: Sequence[str],
    settings: dict[str, Any],
    folder: Path | None,
    workers: int | None,
    judge: bool,
    console: Console,
    client: Any = None,
) -> None:
    """Fit models to several files by `brdfkit.sweep`, and print their errors.

    Each failure is printed as one sentence; the exit status is then 2.
    """
    from brdfkit.cli.arguments import use_results_folder
    from brdfkit.fitting.sweeping import sweep

    options: dict[str, Any] = {"folder": folder, "workers": workers, "judge": judge}
    options["client"] = client
    what = f"fit {len(names)} models to {len(files)} materials"
    with use_results_folder(folder), console.progress(what) as progress:
        result = sweep(files, names, settings=settings, **options, progress=progress)
    _print_sweep(result, folder, console)
    for problem in result.problems:
        print_message(problem)
    interrupted = len(result.rows) < result.requested
    if interrupted:
        more = "; the same command continues from there" if folder else ""
        print_message(
            f"interrupted; {len(result.fits)} of {result.requested} fits are finished{more}."
        )
    if interrupted or result.failed:
        click.get_current_context().exit(find_exit_status() if interrupted else 2)


def _print_sweep(sweep: Sweep, folder: Path | None, console: Console) -> None:
    """Print the tables of errors of a sweep, unless it has no fits, or the sweep as JSON."""
    from brdfkit.fitting.sweeping.sweeping import PAGE, TABLE
    from brdfkit.fitting.sweeping.tables import compare_models, list_quantities

    pages = [folder / PAGE, folder / TABLE] if folder and sweep.fits else []
    if console.as_json:
        fits = [_make_sweep_record(row) for row in sweep.rows if row.fit]
        failed = [
            {"material": r.material, "file": r.file, "model": r.model, "message": r.message}
            for r in sweep.failed
        ]
        saved = [row.saved for row in sweep.rows if row.saved]
        console.print_json({"fits": fits, "failed": failed, "written": [*pages, *saved]})
    elif sweep.fits:
        for quantity in list_quantities(sweep):
            columns, *sections = compare_models(sweep, quantity)
            unit = "" if quantity.decibels else f" ({sweep.rows[0].loss})"
            console.print_table(columns, *sections, title=f"{quantity.title}{unit}")
        console.output.print(sweep.summary)
        console.print_written(pages)
        if pages:
            console.print_written([f"{folder}/MATERIAL/MODEL.json, {len(sweep.fits)} fits"])


def _make_sweep_record(row: Any) -> dict[str, Any]:
    """Return a row of a sweep, which is one fit to one file, as a dictionary for --json."""
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
