"""`brdfkit svbrdf`: fits a model's parameter maps to photographs of a flat sample."""

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
    help="Texels along the longer side of a map. Default: as many as a photograph "
    "has pixels, at most 512.",
)
@click.option(
    "--anisotropic", is_flag=True, help="Fit two roughnesses and their directions at each texel."
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
    help="Allowed difference between neighbouring texels; smaller values give smoother maps. "
    "Default: chosen by photographs that are held out.",
)
@click.option(
    "--accept-8-bit",
    is_flag=True,
    help="Accept photographs with 8 bits, and invert their sRGB curve.",
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
    accept_8_bit: bool,
    output: Path | None,
    console: Console,
) -> None:
    """Fit texture maps of a material to photographs of it.

    FOLDER holds linear photographs of a flat sample (OpenEXR), each lit by one point light or
    flash, and the file capture.toml with the positions of the camera and the lights. The camera may
    move, like a phone with its flash. See docs/how_to/photographs.md.
    """
    from brdfkit.cli.arguments import use_results_folder
    from brdfkit.inverse.photographs import svbrdf as fit_maps
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
                accept_8_bit=accept_8_bit,
                progress=progress,
            )
        except Interrupted as stop:
            maps, interrupted = stop.best, True
        written = maps.write(output)
    if not console.as_json:
        console.output.print(str(maps), markup=False, highlight=False)
    if console.as_json:
        names = ("smoothness", "residual", "held_out", "predicted", "notes", "seconds")
        console.print_json({**{name: getattr(maps, name) for name in names}, "written": written})
    else:
        console.print_written(written)
    if interrupted:
        exit_interrupted("these are the maps so far, without standard errors")
