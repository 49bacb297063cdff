"""`brdfkit report`: one HTML file that shows how well models describe a measured material."""

from functools import partial
from pathlib import Path

import click

from brdfkit.commands._errors import say
from brdfkit.commands._options import fit_options, output_options, render_options
from brdfkit.commands._stopping import status
from brdfkit.errors import BrdfkitError
from brdfkit.reporting.defaults import SIZE, SPP

MODELS = "ward", "ggx", "ggx+ggx"  # without -m


@click.command()
@click.argument("files", nargs=-1, required=True, metavar="FILE...")
@fit_options(", ".join(MODELS))
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    help="The page, .html; of several FILEs a folder. Default: NAME-report.html, and reports.",
)
@partial(render_options, spp=SPP, size=SIZE)
@output_options
def report(files, names, how, output, spp, until, size, seed, console):
    """Show how well models fit, in one HTML file.

    Any browser shows it, without a network: a verdict, pictures to wipe and to flicker, errors,
    lobes, slices, parameters and the audit. MODEL may also be a saved fit, FILE.json. Where a model
    cannot be fitted, the others go on; the exit status is then 2. Ctrl-C during the pictures keeps
    the samples that all have.

    Of several FILEs each has a report in a folder, with a page that leads to them: index.html.
    """
    names = list(dict.fromkeys(names or MODELS))
    how |= {"seed": seed}
    pictures = {"spp": spp, "size": size or SIZE, "seed": seed, "until": until}
    if len(files) > 1:
        _report_many(files, names, how, output or Path("reports"), pictures, console)
    else:
        _report_one(files[0], names, how, output, pictures, console)


def _report_one(file, names, how, output, pictures, console):
    """Fit the models to one file, and write and print its report."""
    from brdfkit.commands._ranking import recommend
    from brdfkit.materials import measured_material
    from brdfkit.names import slug
    from brdfkit.reporting.report import require_page, write_report

    with console.progress(f"read {file}"):
        material = measured_material(file)
    path = require_page(output or f"{slug(material.name)}-report.html")
    names, _ = recommend(names, material, how, console)
    fits, failed = _fit_each(names, material, how, console)
    with console.progress("render") as progress:
        said = write_report(material, fits, path, file, **pictures, progress=progress)
    _print_report(said, path, console)
    for error in failed:
        say(error)
    if said.spp < said.asked:
        say(f"interrupted; rendered with {said.spp} of {said.asked} samples per pixel.")
        click.get_current_context().exit(status())
    if failed:
        click.get_current_context().exit(2)


def _fit_each(names, material, how, console):
    """The fits, and the errors of the models that cannot be fitted; the first one is raised where
    none can."""
    from brdfkit.reporting.fits import to_fit

    fits, failed = [], []
    for number, name in enumerate(names, 1):
        try:
            with console.progress(f"fit {name} ({number} of {len(names)})") as progress:
                fits.append(to_fit(name, material, how, progress))
        except BrdfkitError as error:
            failed.append(error)
    if not fits:
        raise failed[0]
    return fits, failed


def _print_report(said, path, console):
    if console.as_json:
        console.json({**_record(said), "written": [path]})
        return
    console.out.print(f"{said.material}: {said.verdict}")
    console.list_written([path])


def _record(said):
    """The `Contents` of a report for JSON."""
    best = {"best": said.names[0], "loss": said.loss, "error": said.error}
    return {"material": said.material, "verdict": said.verdict, **best}


def _report_many(files, names, how, folder, pictures, console):
    """Write a report of each file to `folder`, and the page that leads to them."""
    from brdfkit.commands._ranking import BEST
    from brdfkit.commands._targets import results_folder
    from brdfkit.reporting.many_files import report_many

    if BEST in names:
        raise BrdfkitError("-m best ranks models on one material; name one FILE, or a model.")
    with results_folder(folder), console.progress(f"report on {len(files)} materials") as progress:
        found = report_many(files, names, folder, how, **pictures, progress=progress)
    if console.as_json:
        console.json(
            {
                "reports": [_record(entry.contents) for entry in found.entries],
                "failed": found.problems,
                "written": found.written,
            }
        )
    elif found.entries:
        console.table(*found.table(), title="reports")
        console.list_written(found.written)
    for problem in found.problems:
        say(problem)
    if found.interrupted:
        say(f"interrupted; {len(found.entries)} of {len(files)} reports are finished.")
    if found.interrupted or found.problems:
        click.get_current_context().exit(status() if found.interrupted else 2)
