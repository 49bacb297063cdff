"""`brdfkit fit`: fits models to measured materials, and compares them."""

from pathlib import Path

import click
from click.core import ParameterSource

from brdfkit.cli.commands.render import path_trace
from brdfkit.cli.errors import say
from brdfkit.cli.fit_output import print_fits
from brdfkit.cli.options import (
    fit_options,
    mend_options,
    render_options,
    scene_options,
    writing_options,
)
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.interrupts import Interrupted, exit_status


@click.command()
@click.argument("files", nargs=-1, required=True, metavar="FILE...")
@fit_options("all")
@mend_options
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    help="Folder for the fits. Default: they are not written; with --render, the material's name.",
)
@click.option(
    "-j",
    "--workers",
    type=click.IntRange(min=1),
    metavar="N",
    help="Number of processes, for several FILEs. Default: one for each core.",
)
@click.option(
    "--judge",
    is_flag=True,
    help="Of several FILEs, tell each fit's error in directions held out and its picture, too; "
    "takes about as long again.",
)
@click.option("--render", "rendered", is_flag=True, help="Path-trace the measurement and the fits.")
@click.option("--spectral", is_flag=True, help="Fit a weight for each measured wavelength.")
@scene_options
@render_options
@writing_options
def fit(
    files,
    names,
    how,
    mends,
    output,
    workers,
    judge,
    rendered,
    spectral,
    scene,
    environment,
    spp,
    noise_floor,
    size,
    seed,
    console,
):
    """Fit models to measured materials.

    FILE is a measured file, or the name of a material that brdfkit knows. The errors of the models
    are compared. Ctrl-C keeps the finished fits. Where a model cannot be fitted, the others go on;
    the exit status is then 2.

    -m best ranks all models and two-lobe sums by their error at directions that were held out and
    by their pictures, says which to take and why, and fits that one.

    Several FILEs are fitted in several processes, past those that cannot be read. With -o a page
    and a table are written, too, and the same command goes on where it was stopped.
    """
    from brdfkit.cli.arguments import measured_material, results_folder
    from brdfkit.cli.many_files import fit_many
    from brdfkit.cli.rank_output import BEST, print_ranking, recommend, refuse_best
    from brdfkit.core.memory import require_memory
    from brdfkit.core.names import to_file_stem, to_fit_path
    from brdfkit.fitting.compare import compare
    from brdfkit.model import labels
    from brdfkit.rendering.scene_input.loading import SIZE, require_scene

    if not rendered:
        _refuse_for_pictures("scene", "environment", "spp", "noise_floor", "size")
    _refuse_models(files)
    names = list(dict.fromkeys(map(labels.load_files, names or labels.models())))
    for name in names:
        if name != BEST:
            labels.model(name)
    how |= {"seed": seed, "spectral": spectral}
    if len(files) > 1:
        refuse_best(names)
        _refuse_to_mend(mends)
        if rendered:
            raise BrdfkitError("--render shows one material; name one FILE, or leave it out.")
        fit_many(files, names, how, output, workers, judge, console)
        return
    if judge:
        raise BrdfkitError("--judge is for several FILEs; -m best judges all models of one FILE.")
    (file,) = files
    with console.progress(f"read {file}"):
        material = measured_material(file, mends)
    names, ranking = recommend(names, material, how, console)
    if ranking:
        print_ranking(ranking, console)
    if rendered:
        require_scene(scene, environment)
        require_memory((size, size) if size else SIZE, 1 + len(names))
        output = output or Path(to_file_stem(material.name))

    errors = None  # of pictures
    with results_folder(output):
        _require_files(output, names, rendered)
        fits, failed, interrupted = _fit_each(names, material, how, output, console)
        files = [to_fit_path(output, f.name) for f in fits] if output else []
        written = [file for file in files if file.is_file()]
        if rendered and not interrupted:
            shown, exr = [material, *fits], output / "render.exr"
            where = {"size": size, "seed": seed, "scene": scene, "environment": environment}
            picture = path_trace(shown, exr, console, spp, noise_floor, **where)
            errors, interrupted = picture.errors(), picture.spp < picture.requested
            written += [exr, output / "render.png"]
    with console.progress("compare"):
        comparison = compare(material, fits, max_angle=how["max_angle"], spectral=spectral)
    print_fits(material, fits, failed, comparison, errors, written, ranking, console)
    for error in failed.values():
        say(error)
    if interrupted or failed:
        click.get_current_context().exit(exit_status() if interrupted else 2)


def _require_files(folder, names, rendered):
    """Raise `BrdfkitError` where a file cannot be written to `folder`, unless it is None."""
    from brdfkit.cli.arguments import picture_file
    from brdfkit.core.files import require_writable
    from brdfkit.core.names import to_fit_path
    from brdfkit.model import labels

    if folder is not None:
        for name in names:
            require_writable(to_fit_path(folder, labels.model(name)().name))
    if rendered:
        picture_file(folder / "render.exr")


def _refuse_models(files):
    """Raise `BrdfkitError` where a model stands among the files: it belongs to -m."""
    from brdfkit.model import labels

    for file in files:
        if labels.is_label(file) and not Path(file).exists():
            raise BrdfkitError(f"{file} is a model, not a file: write -m {file}.")


def _refuse_to_mend(mends):
    """Raise `BrdfkitError` where `mends` were given for several files: each has its own."""
    for option in ("--" + name.replace("_", "-") for name in mends):
        raise BrdfkitError(
            f"{option} mends one FILE: write each one that needs it by brdfkit convert FILE "
            f"MENDED.csv {option}, and fit those."
        )


def _refuse_for_pictures(*options):
    """Refuse these options of pictures where they were given without --render."""
    context = click.get_current_context()
    names = {parameter.name: parameter.opts[0] for parameter in context.command.params}
    for name in options:
        if context.get_parameter_source(name) is ParameterSource.COMMANDLINE:
            raise BrdfkitError(f"{names[name]} is for pictures; add --render, or leave it out.")


def _fit_each(names, material, how, output, console):
    """The fits, best first, by name the errors of the models that cannot be fitted, and whether
    Ctrl-C ended them.

    Each fit is saved as soon as it is finished. Ctrl-C ends with the fits that are finished and, as
    the last one, with what another one had come to. Where no model can be fitted, the first error
    is raised.
    """
    from brdfkit.core.names import to_fit_path
    from brdfkit.fitting.fit import fit as fit_model
    from brdfkit.materials.loading import save

    fits, failed = [], {}
    try:
        for number, name in enumerate(names, 1):
            try:
                with console.progress(f"fit {name} ({number} of {len(names)})") as progress:
                    found = fit_model(material, name, **how, progress=progress)
            except BrdfkitError as error:
                failed[name] = error
                continue
            if output is not None:
                save(found, to_fit_path(output, found.name))
            fits.append(found)
    except Interrupted as stop:
        say(f"interrupted; {len(fits)} of {len(names)} fits are finished, the last one is not.")
        return [*sorted(fits, key=lambda f: f.loss), stop.best], failed, True
    except KeyboardInterrupt:
        if not fits:
            raise
        say(f"interrupted; {len(fits)} of {len(names)} fits are finished.")
        return sorted(fits, key=lambda f: f.loss), failed, True
    if not fits:
        raise next(iter(failed.values()))
    return sorted(fits, key=lambda f: f.loss), failed, False
