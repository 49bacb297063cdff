"""`brdfkit svbrdf`: fits a model's parameter maps to photographs of a sample or an object."""

from __future__ import annotations

from pathlib import Path

import click

from brdfkit.cli.console import Console
from brdfkit.cli.errors import exit_interrupted
from brdfkit.cli.options import output_option, writing_options
from brdfkit.cli.settings import parse_settings
from brdfkit.core.interrupts import Interrupted


@click.command()
@click.argument("folder", type=click.Path(path_type=Path))
@click.option(
    "-m",
    "--model",
    default="ggx",
    show_default=True,
    metavar="NAME",
    help="The model whose parameters are fitted as maps.",
)
@click.option(
    "--resolution",
    type=click.IntRange(4, 8192),
    metavar="N",
    help="Texels along the longer side of a map of a flat sample. Default: as many as a "
    "photograph has pixels, at most 512.",
)
@click.option(
    "--anisotropic",
    is_flag=True,
    help="Fit two roughnesses and their directions at each texel of a flat sample.",
)
@click.option(
    "--fixed",
    multiple=True,
    metavar="NAME=VALUE",
    help="Keep a parameter at one value everywhere, as in f0=0.04; repeat it for more.",
)
@click.option(
    "--smoothness",
    type=float,  # `brdfkit.photographs.svbrdf` checks its range
    metavar="X",
    help="Allowed difference between neighbouring texels of a flat sample; smaller values give "
    "smoother maps. Default: chosen by photographs that are held out.",
)
@click.option(
    "--linearise",
    metavar="CODING",
    help="How the numbers of photographs are coded: linear, sRGB, gamma (2.2), or an exponent. "
    "Photographs with 8 bits need it.",
)
@click.option(
    "--hold-out",
    type=click.IntRange(2),
    metavar="N",
    help="Hold every N-th photograph out of the fit, and compare it with its prediction.",
)
@output_option("Folder for the maps, a scene and a report. Default: FOLDER/maps.")
@writing_options
def svbrdf(
    folder: Path,
    model: str,
    resolution: int | None,
    anisotropic: bool,
    fixed: tuple[str, ...],
    smoothness: float | None,
    linearise: str | None,
    hold_out: int | None,
    output: Path | None,
    console: Console,
) -> None:
    """Fit texture maps of a material to photographs of it.

    FOLDER holds photographs, each under one light, and a file that says where the lights are.

    Photographs of a flat sample have a file capture.toml with the places of the lights and the
    camera, which may move, like a phone with its flash. Photographs of an object by a camera that
    stands still may also come as folders of DiLiGenT or PSBox, from a dome (RTI, .lp), with a
    chrome ball, or with a table of light directions. An object's maps have the photographs' pixels.

    Ctrl-C keeps the maps so far; for an object, the same command then goes on from there. See
    docs/how_to/photographs.md and docs/how_to/photographs_of_objects.md.
    """
    from brdfkit.cli.arguments import use_results_folder
    from brdfkit.inverse.photographs import svbrdf as fit_maps
    from brdfkit.inverse.photographs.objects.unfinished import NAME as UNFINISHED
    from brdfkit.inverse.photographs.result.files import make_output_folder
    from brdfkit.model import labels

    values, output = parse_settings(fixed, "--fixed"), output or folder / "maps"
    interrupted = False
    with use_results_folder(output), console.progress("fit maps") as progress:
        make_output_folder(labels.model(labels.load_files_in_label(model)), output)
        try:
            maps = fit_maps(
                folder,
                model,
                resolution=resolution,
                anisotropic=anisotropic,
                fixed=values,
                smoothness=smoothness,
                linearise=linearise,
                hold_out=hold_out,
                checkpoint=output,
                progress=progress,
            )
        except Interrupted as stop:
            maps, interrupted = stop.best, True
        except KeyboardInterrupt:
            if not (output / UNFINISHED).is_file():
                raise
            maps = None
        written = [] if maps is None else maps.write(output)
    goes_on = "; the same command goes on from there" if (output / UNFINISHED).is_file() else ""
    if maps is None:
        exit_interrupted(f"there are no maps yet{goes_on}")
    if not console.as_json:
        console.output.print(str(maps), markup=False, highlight=False)
    if console.as_json:
        console.print_json({**maps.record(), "written": written})
    else:
        console.print_written(written)
    if interrupted:
        exit_interrupted(f"these are the maps so far, without standard errors{goes_on}")
