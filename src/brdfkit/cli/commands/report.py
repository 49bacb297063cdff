"""`brdfkit report`: one HTML file that shows how well models describe a measured material."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from brdfkit.cli.console import Console
from brdfkit.cli.errors import print_message
from brdfkit.cli.options import (
    MESHES,
    output_option,
    render_options,
    scene_options,
    writing_options,
)
from brdfkit.cli.settings import fit_options
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.interrupts import find_exit_status
from brdfkit.reporting.pictures.defaults import LARGEST_SIZE, MODELS, SIZE, SMALLEST_SIZE, SPP

if TYPE_CHECKING:
    from brdfkit.reporting.contents import Contents


@click.command()
@click.argument("files", nargs=-1, required=True, metavar="FILE...")
@fit_options(", ".join(MODELS), others="FILE.py with one, a saved fit, FIT.json, or best")
@output_option(
    "The page to write, .html, or for several FILEs the folder. Default: NAME-report.html, or the "
    "folder reports."
)
@partial(scene_options, files=f"or {MESHES}")
@partial(render_options, spp=SPP, size=f"{SIZE}; from {SMALLEST_SIZE} to {LARGEST_SIZE}")
@writing_options
def report(
    files: tuple[str, ...],
    names: tuple[str, ...],
    how: dict[str, Any],
    output: Path | None,
    console: Console,
    **pictures: Any,
) -> None:
    """Show how well models fit, in one HTML file.

    The file needs no network. It contains a verdict, pictures to compare with a slider or by
    flickering, errors, lobes, slices, parameters and the audit. If a model cannot be fitted, the
    command continues with the others, and its exit status is 2. After Ctrl-C during the pictures,
    they have the samples that were finished for all of them.

    With -m best, the command ranks all models first, and shows the ranking and the model that it
    recommends.

    Of several FILEs, each gets a report in a folder; the page index.html lists them.
    """
    from brdfkit.reporting.pictures.pictures import check_picture_arguments

    for file in files:
        if file.lower().endswith(".json"):
            raise BrdfkitError(
                f"{file}: a saved fit goes behind -m; name the material that it was fitted to."
            )
    models = list(dict.fromkeys(names or MODELS))
    how |= {"seed": pictures["seed"]}
    pictures["size"] = SIZE if pictures["size"] is None else pictures["size"]
    check_picture_arguments(pictures["size"], pictures["scene"], pictures["environment"])
    if len(files) > 1:
        _report_many_files(files, models, how, output or Path("reports"), pictures, console)
    else:
        _report_one_file(files[0], models, how, output, pictures, console)


def _report_one_file(
    file: str,
    names: list[str],
    how: dict[str, Any],
    output: Path | None,
    pictures: dict[str, Any],
    console: Console,
) -> None:
    """Fit the models to one file, and write and print its report."""
    from brdfkit.cli.rank_output import recommend_model
    from brdfkit.fitting.settings import FitSettings
    from brdfkit.materials.resolve import to_measured
    from brdfkit.reporting.fits import fit_models
    from brdfkit.reporting.report import choose_file_name, require_html_path, write_report

    with console.progress(f"read {file}"):
        material = to_measured(file)
    path = require_html_path(output or choose_file_name(material))
    names, ranking = recommend_model(names, material, how, console)
    fits, failed = fit_models(names, material, FitSettings(**how), console.progress)
    with console.progress("render") as progress:
        contents = write_report(material, fits, path, file, ranking, **pictures, progress=progress)
    if console.as_json:
        console.print_json({**_make_report_record(contents), "written": [path]})
    else:
        _print_verdict(contents, console)
        console.print_written([path])
    for error in failed:
        print_message(error)
    if contents.spp < contents.requested:
        print_message(
            f"interrupted; rendered with {contents.spp} of {contents.requested} samples per pixel."
        )
        click.get_current_context().exit(find_exit_status())
    if failed:
        click.get_current_context().exit(2)


def _print_verdict(contents: Contents, console: Console) -> None:
    """Print the verdict of a report, its warnings, and the doubts about the measurement."""
    console.output.print(f"{contents.material}: {contents.verdict}")
    for warning in contents.warnings:
        console.output.print(f"! {warning}")
    console.print_doubts(contents.findings)


def _make_report_record(contents: Contents) -> dict[str, Any]:
    """Return the results of a report as a dictionary, for --json."""
    return {
        "material": contents.material,
        "verdict": contents.verdict,
        "best": contents.names[0],
        "loss": contents.loss,
        "error": contents.error,
        "warnings": contents.warnings,
        "findings": contents.findings,
    }


def _report_many_files(
    files: Sequence[str],
    names: list[str],
    how: dict[str, Any],
    folder: Path,
    pictures: dict[str, Any],
    console: Console,
) -> None:
    """Write a report of each file to `folder`, and a page that lists them."""
    from brdfkit.cli.arguments import use_results_folder
    from brdfkit.cli.rank_output import refuse_best
    from brdfkit.fitting.settings import FitSettings
    from brdfkit.reporting.many_files import write_reports

    refuse_best(names)
    if folder.suffix.lower() in (".html", ".htm"):
        raise BrdfkitError(f"{folder} is one page; for several FILEs, name a folder behind -o.")
    settings, what = FitSettings(**how), f"report on {len(files)} materials"
    with use_results_folder(folder), console.progress(what) as progress:
        reports = write_reports(files, names, folder, settings, **pictures, progress=progress)
    if console.as_json:
        console.print_json(
            {
                "reports": [_make_report_record(entry.contents) for entry in reports.entries],
                "failed": reports.problems,
                "written": reports.written_files,
            }
        )
    elif reports.entries:
        for entry in reports.entries:
            _print_verdict(entry.contents, console)
        console.print_written(reports.written_files)
    for problem in reports.problems:
        print_message(problem)
    if reports.interrupted:
        fewer = len(reports.entries) - reports.finished_count
        noisy = ", and one with fewer samples per pixel is kept" if fewer else ""
        print_message(
            f"interrupted; {reports.finished_count} of {len(files)} reports are finished{noisy}."
        )
    if reports.interrupted or reports.problems:
        click.get_current_context().exit(find_exit_status() if reports.interrupted else 2)
