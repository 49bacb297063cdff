"""`brdfkit report`: one HTML file that shows how well models describe a measured material."""

from functools import partial
from pathlib import Path

import click

from brdfkit.cli.errors import say
from brdfkit.cli.options import MESHES, fit_options, render_options, scene_options, writing_options
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.interrupts import exit_status
from brdfkit.reporting.pictures.defaults import LARGEST_SIZE, MODELS, SIZE, SMALLEST_SIZE, SPP


@click.command()
@click.argument("files", nargs=-1, required=True, metavar="FILE...")
@fit_options(", ".join(MODELS), others="FILE.py with one, a saved fit, FIT.json, or best")
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    help="The page, .html; of several FILEs a folder. Default: NAME-report.html, and reports.",
)
@partial(scene_options, files=f"or {MESHES}")
@partial(render_options, spp=SPP, size=f"{SIZE}; from {SMALLEST_SIZE} to {LARGEST_SIZE}")
@writing_options
def report(files, names, how, output, scene, environment, spp, noise_floor, size, seed, console):
    """Show how well models fit, in one HTML file.

    Any browser shows it, without a network: a verdict, pictures to wipe and to flicker, errors,
    lobes, slices, parameters and the audit. Where a model cannot be fitted, the others go on; the
    exit status is then 2. Ctrl-C during the pictures keeps the samples that all have.

    -m best ranks all models first, and shows the ranking and the one that it recommends.

    Of several FILEs each has a report in a folder, with a page that leads to them: index.html.
    """
    from brdfkit.reporting.pictures.pictures import check_pictures

    for file in files:
        if file.lower().endswith(".json"):
            raise BrdfkitError(
                f"{file}: a saved fit goes behind -m; name the material that it was fitted to."
            )
    names = list(dict.fromkeys(names or MODELS))
    how |= {"seed": seed}
    size = SIZE if size is None else size
    check_pictures(size, scene, environment)
    pictures = {"spp": spp, "size": size, "seed": seed, "noise_floor": noise_floor}
    pictures |= {"scene": scene, "environment": environment}
    if len(files) > 1:
        _report_many(files, names, how, output or Path("reports"), pictures, console)
    else:
        _report_one(files[0], names, how, output, pictures, console)


def _report_one(file, names, how, output, pictures, console):
    """Fit the models to one file, and write and print its report."""
    from brdfkit.cli.rank_output import print_ranking, recommend
    from brdfkit.fitting.settings import FitSettings
    from brdfkit.materials.resolve import to_measured
    from brdfkit.reporting.fits import fit_each
    from brdfkit.reporting.report import check_page, choose_file_name, write_report

    with console.progress(f"read {file}"):
        material = to_measured(file)
    path = check_page(output or choose_file_name(material))
    names, ranking = recommend(names, material, how, console)
    if ranking:
        print_ranking(ranking, console)
    fits, failed = fit_each(names, material, FitSettings(**how), console.progress)
    with console.progress("render") as progress:
        said = write_report(material, fits, path, file, ranking, **pictures, progress=progress)
    if console.as_json:
        console.json({**_record(said), "written": [path]})
    else:
        _print_verdict(said, console)
        console.list_written([path])
    for error in failed:
        say(error)
    if said.spp < said.requested:
        say(f"interrupted; rendered with {said.spp} of {said.requested} samples per pixel.")
        click.get_current_context().exit(exit_status())
    if failed:
        click.get_current_context().exit(2)


def _print_verdict(said, console):
    """Print the sentence at the head of a report's `Contents`, and what is wrong or doubtful."""
    console.out.print(f"{said.material}: {said.verdict}")
    for warning in said.warnings:
        console.out.print(f"! {warning}")
    console.list_doubts(said.findings)


def _record(said):
    """The `Contents` of a report for JSON."""
    best = {"best": said.names[0], "loss": said.loss, "error": said.error}
    found = {"material": said.material, "verdict": said.verdict, **best}
    return {**found, "warnings": said.warnings, "findings": said.findings}


def _report_many(files, names, how, folder, pictures, console):
    """Write a report of each file to `folder`, and the page that leads to them."""
    from brdfkit.cli.arguments import results_folder
    from brdfkit.cli.rank_output import refuse_best
    from brdfkit.fitting.settings import FitSettings
    from brdfkit.reporting.many_files import report_many

    refuse_best(names)
    if folder.suffix.lower() in (".html", ".htm"):
        raise BrdfkitError(f"{folder} is one page; of several FILEs name a folder behind -o.")
    with results_folder(folder), console.progress(f"report on {len(files)} materials") as progress:
        found = report_many(files, names, folder, FitSettings(**how), **pictures, progress=progress)
    if console.as_json:
        console.json(
            {
                "reports": [_record(entry.contents) for entry in found.entries],
                "failed": found.problems,
                "written": found.written,
            }
        )
    elif found.entries:
        for entry in found.entries:
            _print_verdict(entry.contents, console)
        console.list_written(found.written)
    for problem in found.problems:
        say(problem)
    if found.interrupted:
        fewer = len(found.entries) - found.finished
        noisy = ", and one with fewer samples per pixel is kept" if fewer else ""
        say(f"interrupted; {found.finished} of {len(files)} reports are finished{noisy}.")
    if found.interrupted or found.problems:
        click.get_current_context().exit(exit_status() if found.interrupted else 2)
