"""`brdfkit fit`: fits models to measured materials, and compares them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from brdfkit.cli.cluster import connect_client, scheduler_option
from brdfkit.cli.console import Console
from brdfkit.cli.errors import print_message
from brdfkit.cli.fit_output import print_fits
from brdfkit.cli.options import (
    SPP,
    mend_options,
    output_option,
    render_options,
    scene_options,
    writing_options,
)
from brdfkit.cli.picture_output import path_trace, write_picture
from brdfkit.cli.settings import fit_options
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.interrupts import Interrupted, find_exit_status

if TYPE_CHECKING:
    from brdfkit.materials.measured import Measured
    from brdfkit.regression import Fit


@click.command()
@click.argument("files", nargs=-1, required=True, metavar="FILE...")
@fit_options("all")
@mend_options
@output_option(
    "Folder for the fits. Default: none, and the fits are not saved; with --render, the "
    "material's name."
)
@click.option(
    "-j",
    "--workers",
    type=click.IntRange(min=1),
    metavar="N",
    help="Number of processes, for several FILEs. Default: one for each core.",
)
@scheduler_option("For several FILEs: ")
@click.option(
    "--judge",
    is_flag=True,
    help="For several FILEs: compute also each fit's error in directions held out and its "
    "picture's error, which doubles the time.",
)
@click.option(
    "--exportable",
    metavar="TARGET",
    help="With -m best: rank only models that TARGET, such as blender, can hold; brdfkit export "
    "lists the targets.",
)
@click.option("--render", "rendered", is_flag=True, help="Path-trace the measurement and the fits.")
@click.option("--spectral", is_flag=True, help="Fit a weight for each measured wavelength.")
@scene_options
@render_options
@writing_options
def fit(
    files: tuple[str, ...],
    names: tuple[str, ...],
    how: dict[str, Any],
    mends: dict[str, bool],
    output: Path | None,
    workers: int | None,
    scheduler: str | None,
    judge: bool,
    exportable: str | None,
    rendered: bool,
    spectral: bool,
    console: Console,
    **pictures: Any,
) -> None:
    """Fit models to measured materials.

    FILE is a measured file, or the name of a material that brdfkit knows. The command prints the
    fits and compares their errors. After Ctrl-C, the finished fits are kept. If a model cannot be
    fitted, the command continues with the others, and its exit status is 2.

    With -m best, the command ranks all models and sums of two lobes by their errors at directions
    that were held out and by their pictures, recommends one with reasons, and fits it.

    Several FILEs are fitted by several processes; files that cannot be read are skipped. With -o,
    the command also writes a page and a table; when repeated, it continues where it was stopped.
    """
    from brdfkit.cli.many_files import fit_many_files
    from brdfkit.cli.rank_output import BEST, refuse_best
    from brdfkit.model import labels

    if not rendered:
        _refuse_picture_options(pictures)
    _refuse_models(files)
    models = list(dict.fromkeys(map(labels.load_files_in_label, names or labels.models())))
    for name in models:
        if name != BEST:
            labels.model(name)
    how |= {"seed": pictures["seed"], "spectral": spectral}
    ranked = _list_exportable_models(exportable, models)
    if len(files) > 1:
        refuse_best(models)
        _refuse_mends(mends)
        if rendered:
            raise BrdfkitError("--render shows one material; name one FILE, or leave it out.")
        with connect_client(scheduler) as client:
            fit_many_files(files, models, how, output, workers, judge, console, client)
    elif scheduler:
        raise BrdfkitError("--scheduler is for several FILEs; leave it out for one.")
    elif judge:
        raise BrdfkitError("--judge is for several FILEs; -m best judges all models of one FILE.")
    else:
        shown = pictures if rendered else None
        _fit_one_file(files[0], models, ranked, how, mends, output, shown, console)


def _list_exportable_models(target: str | None, names: list[str]) -> list[str] | None:
    """Return the labels of the models to rank for an export, or None for all models."""
    if target is None:
        return None
    from brdfkit.cli.rank_output import BEST
    from brdfkit.exporting.hold import list_held_models
    from brdfkit.exporting.targets import find_target

    if BEST not in names:
        raise BrdfkitError("--exportable chooses what -m best ranks; add -m best.")
    return list_held_models(find_target(target))


def _fit_one_file(
    file: str,
    names: list[str],
    ranked: list[str] | None,
    how: dict[str, Any],
    mends: dict[str, bool],
    output: Path | None,
    pictures: dict[str, Any] | None,
    console: Console,
) -> None:
    """Fit models to one file, path-trace them unless `pictures` is None, and print the results.

    `ranked`: labels of the models among which "best" is found, None for all; `pictures`: the
    arguments of `brdfkit.render`.
    """
    from brdfkit.cli.arguments import find_measured, use_results_folder
    from brdfkit.cli.rank_output import recommend_model
    from brdfkit.core.memory import require_memory
    from brdfkit.core.names import to_file_stem, to_fit_path
    from brdfkit.fitting.compare import compare
    from brdfkit.rendering.scene_input.loading import SIZE, require_scene

    with console.progress(f"read {file}"):
        material = find_measured(file, mends)
    names, ranking = recommend_model(names, material, how, console, ranked)
    if pictures:
        size = pictures["size"]
        require_scene(pictures["scene"], pictures["environment"])
        require_memory((size, size) if size else SIZE, 1 + len(names))
        output = output or Path(to_file_stem(material.name))

    errors = None  # errors of the pictures, if there are any
    with use_results_folder(output):
        _check_output_paths(output, names, rendered=pictures is not None)
        fits, failed, interrupted = _fit_each_model(names, material, how, output, console)
        paths = [to_fit_path(output, fit.name) for fit in fits] if output else []
        written = [path for path in paths if path.is_file()]
        if pictures and output and not interrupted:
            exr = output / "render.exr"
            picture = path_trace([material, *fits], SPP, console, **pictures)
            write_picture(picture, exr)
            errors, interrupted = picture.errors(), picture.spp < (picture.requested or 0)
            written += [exr, output / "render.png"]
    with console.progress("compare"):
        comparison = compare(material, fits, max_angle=how["max_angle"], spectral=how["spectral"])
    print_fits(
        material,
        fits,
        comparison,
        console,
        failed=failed,
        errors=errors,
        written=written,
        ranking=ranking,
    )
    for error in failed.values():
        print_message(error)
    if interrupted or failed:
        click.get_current_context().exit(find_exit_status() if interrupted else 2)


def _check_output_paths(folder: Path | None, names: Sequence[str], rendered: bool) -> None:
    """Raise `BrdfkitError` where a fit or a picture cannot be written to `folder`."""
    from brdfkit.cli.arguments import check_picture_path
    from brdfkit.core.files import require_writable
    from brdfkit.core.names import to_fit_path
    from brdfkit.model import labels

    if folder is not None:
        for name in names:
            require_writable(to_fit_path(folder, labels.model(name)().name))
        if rendered:
            check_picture_path(folder / "render.exr")


def _refuse_models(files: Sequence[str]) -> None:
    """Raise `BrdfkitError` where a model stands among the files, since it should follow -m."""
    from brdfkit.model import labels

    for file in files:
        if labels.is_label(file) and not Path(file).exists():
            raise BrdfkitError(f"{file} is a model, not a file: write -m {file}.")


def _refuse_mends(mends: Mapping[str, bool]) -> None:
    """Raise `BrdfkitError` for repairs of several files, which may need different ones."""
    for option in ("--" + name.replace("_", "-") for name in mends):
        raise BrdfkitError(
            f"{option} mends one FILE: write each one that needs it by brdfkit convert FILE "
            f"MENDED.csv {option}, and fit those."
        )


def _refuse_picture_options(pictures: Mapping[str, Any]) -> None:
    """Raise `BrdfkitError` where options of pictures are given without --render.

    --seed is no such option, as fits have a seed, too.
    """
    context = click.get_current_context()
    options = {parameter.name: parameter.opts[0] for parameter in context.command.params}
    for name in pictures:
        given = context.get_parameter_source(name) is ParameterSource.COMMANDLINE
        if given and name != "seed":
            raise BrdfkitError(f"{options[name]} is for pictures; add --render, or leave it out.")


def _fit_each_model(
    names: Sequence[str],
    material: Measured,
    how: Mapping[str, Any],
    output: Path | None,
    console: Console,
) -> tuple[list[Fit], dict[str, BrdfkitError], bool]:
    """Fit each model, and save each fit to the folder `output` as soon as it is finished.

    Returns the fits, best first, the errors of models that cannot be fitted, by name, and whether
    Ctrl-C ended the fits; the last fit is then unfinished. If all models fail, the first error is
    raised.
    """
    from brdfkit.core.names import to_fit_path
    from brdfkit.fitting.fit import fit as fit_model
    from brdfkit.materials.loading import save

    fits: list[Fit] = []
    failed: dict[str, BrdfkitError] = {}
    try:
        for number, name in enumerate(names, 1):
            try:
                with console.progress(f"fit {name} ({number} of {len(names)})") as progress:
                    fitted = fit_model(material, name, **how, progress=progress)
            except BrdfkitError as error:
                failed[name] = error
                continue
            if output is not None:
                save(fitted, to_fit_path(output, fitted.name))
            fits.append(fitted)
    except Interrupted as stop:
        print_message(
            f"interrupted; {len(fits)} of {len(names)} fits are finished, the last one is not."
        )
        return [*sorted(fits, key=lambda f: f.loss), stop.best], failed, True
    except KeyboardInterrupt:
        if not fits:
            raise
        print_message(f"interrupted; {len(fits)} of {len(names)} fits are finished.")
        return sorted(fits, key=lambda f: f.loss), failed, True
    if not fits:
        raise next(iter(failed.values()))
    return sorted(fits, key=lambda f: f.loss), failed, False
