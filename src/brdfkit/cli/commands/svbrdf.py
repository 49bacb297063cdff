"""`brdfkit svbrdf`: maps of a flat sample, from photographs under known lights."""

from pathlib import Path

import click

from brdfkit.cli.errors import say
from brdfkit.cli.options import writing_options
from brdfkit.cli.settings import parse_settings
from brdfkit.core.interrupts import Interrupted, exit_status


@click.command()
@click.argument("folder", type=click.Path(path_type=Path))
@click.option(
    "-m",
    "--model",
    default="ggx",
    show_default=True,
    metavar="NAME",
    help="The model whose parameters have maps.",
)
@click.option(
    "--resolution",
    type=click.IntRange(4, 8192),
    metavar="N",
    help="Texels along the longer side. Default: as many as pixels, at most 512.",
)
@click.option(
    "--anisotropic", is_flag=True, help="Widths along two directions, and which these are."
)
@click.option(
    "--fixed",
    multiple=True,
    metavar="NAME=VALUE",
    help="A parameter that is alike everywhere, as f0=0.04; may be repeated.",
)
@click.option(
    "--smoothness",
    type=float,  # its bound is that of the library
    metavar="X",
    help="How much neighbours may differ: less is smoother. Default: by lights held out.",
)
@click.option(
    "--accept-8-bit", is_flag=True, help="Accept pictures of 8 bits, and invert the sRGB curve."
)
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    help="The folder of the maps, a scene and a report. Default: FOLDER/maps.",
)
@writing_options
def svbrdf(
    folder, model, resolution, anisotropic, fixed, smoothness, accept_8_bit, output, console
):
    """Fit maps to the photographs in FOLDER.

    FOLDER holds linear photographs of a flat sample, OpenEXR, each under one point light or flash,
    and the file capture.toml, which says where the camera and the lights were; the camera may move,
    as a phone does with its flash. See docs/how_to/photographs.md.
    """
    from brdfkit.cli.arguments import results_folder
    from brdfkit.inverse.photographs import svbrdf as fit_maps
    from brdfkit.inverse.photographs.result.files import check_folder
    from brdfkit.model import labels

    values, output = parse_settings(fixed, "--fixed"), output or folder / "maps"
    interrupted = False
    with results_folder(output), console.progress("fit maps") as progress:
        check_folder(labels.model(labels.load_files(model)), output)
        try:
            found = fit_maps(
                folder,
                model,
                resolution=resolution,
                anisotropic=anisotropic,
                fixed=values,
                smoothness=smoothness,
                accept_8_bit=accept_8_bit,
                progress=progress,
            )
        except Interrupted as stop:
            found, interrupted = stop.best, True
        written = found.write(output)
    if not console.as_json:
        console.out.print(str(found), markup=False, highlight=False)
    if console.as_json:
        said = ("smoothness", "residual", "held_out", "predicted", "notes", "seconds")
        console.json({**{name: getattr(found, name) for name in said}, "written": written})
    else:
        console.list_written(written)
    if interrupted:
        say("interrupted; these are the maps so far, without standard errors.")
        click.get_current_context().exit(exit_status())
