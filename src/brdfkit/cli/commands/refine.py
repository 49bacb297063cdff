"""`brdfkit refine`: finds parameters of a scene from photographs of it."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from brdfkit.cli.console import Console
from brdfkit.cli.errors import exit_interrupted
from brdfkit.cli.options import output_option, seed_option, writing_options
from brdfkit.cli.settings import parse_settings
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.interrupts import Interrupted

if TYPE_CHECKING:
    from brdfkit.inverse.scenes import Refinement


@click.command()
@click.argument("scene", metavar="SCENE.xml|FIT|NAME")
@click.argument("pictures", nargs=-1, required=True, metavar="PICTURE...")
@click.option(
    "--parameter",
    "parameters",
    multiple=True,
    metavar="NAME[=LOW,HIGH]",
    help="Search this parameter of the scene, named as by mitsuba.traverse, as in "
    "ball.bsdf.alpha_u or lamp.to_world, the lamp's place; repeat it for more. Default: all of "
    "brdfkit's models.",
)
@click.option(
    "--lights",
    multiple=True,
    metavar="PICTURE=LAMP[,LAMP]",
    help="The lamps of the scene that burned in a picture; all others are off in it. PICTURE is "
    "the file's name without its suffix. Repeat it for each picture. Default: all lamps burn in "
    "all pictures.",
)
@click.option(
    "--camera",
    "cameras",
    multiple=True,
    metavar="PICTURE=SENSOR",
    help="The id of the sensor that took a picture. Default: the only sensor, or the one with the "
    "picture's name, or else the sensors in their order.",
)
@click.option(
    "--mask",
    multiple=True,
    metavar="PICTURE=FILE",
    help="A picture that is white where the pixels of PICTURE count.",
)
@click.option(
    "--starts",
    type=click.IntRange(min=1),
    metavar="N",
    help="Points where searches begin; 1 is the scene's own values, which takes the shortest "
    "time. Default: 9 to 33, by the number of parameters.",
)
@click.option("--steps", type=click.IntRange(min=1), metavar="N", help="Most steps. Default: 30.")
@click.option(
    "--smoothness",
    type=float,  # `brdfkit.refine` checks its range
    metavar="X",
    help="Smoothness of textures and volumes; larger is smoother. Default: by held-out pixels.",
)
@click.option(
    "--spp",
    type=click.IntRange(min=4),
    default=1024,
    show_default=True,
    metavar="N",
    help="Most samples per pixel; 128 are a good beginning.",
)
@click.option(
    "--accept-8-bit", is_flag=True, help="Accept pictures with 8 bits, and invert their sRGB curve."
)
@seed_option
@output_option("Folder for the values, the fits and pictures to compare. Default: none is written.")
@writing_options
def refine(
    scene: str,
    pictures: tuple[str, ...],
    parameters: tuple[str, ...],
    lights: tuple[str, ...],
    cameras: tuple[str, ...],
    mask: tuple[str, ...],
    output: Path | None,
    console: Console,
    **how: Any,
) -> None:
    """Find parameters of a scene from photographs of it.

    SCENE.xml has what is known: shapes, cameras and lamps, and a guess of the rest. PICTURE is a
    linear photograph (OpenEXR) by each of its sensors, or with --lights any number of them, each
    under its own lamps. The command changes the parameters until rendered pictures match the
    photographs, and prints the values with their standard errors. Clipped pixels do not count. See
    docs/how_to/material_from_a_photograph.md.

    \b
    brdfkit refine dome.xml left.exr right.exr --parameter ball.bsdf.alpha_u \\
        --lights left=lamp_1 --lights right=lamp_2
    """
    from brdfkit.cli.arguments import use_results_folder
    from brdfkit.inverse.scenes import refine as search

    how["lights"] = _parse_words(lights, "--lights", "PICTURE=LAMP[,LAMP]", split=True) or None
    how["cameras"] = _parse_words(cameras, "--camera", "PICTURE=SENSOR") or None
    how["mask"] = _parse_words(mask, "--mask", "PICTURE=FILE") or None
    how["parameters"] = _parse_parameters(parameters) or None
    interrupted = False
    with use_results_folder(output), console.progress("refine") as progress:
        try:
            result = search(scene, _name_pictures(pictures), progress=progress, **how)
        except Interrupted as stop:
            result, interrupted = stop.best, True
        written = _write(result, output) if output else []
    if console.as_json:
        console.print_json({**_make_record(result), "written": written})
    else:
        console.output.print(str(result), markup=False, highlight=False)
        console.print_written(written)
        if not written:
            console.output.print("Nothing was saved; -o FOLDER keeps the values.")
    if interrupted:
        exit_interrupted("these are the best values so far")


def _name_pictures(files: Iterable[str]) -> dict[str, str]:
    """Return the files of pictures by their names without folder and suffix."""
    named: dict[str, str] = {}
    for file in files:
        name = Path(file).stem
        if name in named:
            raise BrdfkitError(f"{named[name]} and {file} have the same name; rename one of them.")
        named[name] = file
    return named


def _parse_words(
    words: Iterable[str], option: str, form: str, split: bool = False
) -> dict[str, Any]:
    """Return the words NAME=VALUE behind an `option` as a dictionary; `split` values at commas."""
    values: dict[str, Any] = {}
    for word in words:
        name, _, text = word.partition("=")
        if not name or not text:
            raise BrdfkitError(f"{option} {word!r} should read {form}; repeat {option} for more.")
        values[name] = [*values.get(name, []), *text.split(",")] if split else text
    return values


def _parse_parameters(words: Iterable[str]) -> dict[str, tuple[float, float] | None]:
    """Return the bounds of parameters by their names, from words NAME or NAME=LOW,HIGH."""
    return {
        name: bounds
        for word in words
        for name, bounds in (
            parse_settings([word], "--parameter", "LOW,HIGH") if "=" in word else {word: None}
        ).items()
    }


def _make_record(result: Refinement) -> dict[str, Any]:
    """Return what JSON says of a `Refinement`."""
    names = (
        *("values", "standard_errors", "intervals", "loss", "converged", "message"),
        *("at_bounds", "notes", "names", "steps", "samples", "seconds"),
    )
    return {name: getattr(result, name) for name in names}


def _write(result: Refinement, folder: Path) -> list[Path]:
    """Write the values, the fits of brdfkit's models and a comparison for each picture."""
    import json

    from brdfkit.core.files import write_safely
    from brdfkit.core.json_values import to_json
    from brdfkit.core.names import to_file_stem
    from brdfkit.materials.loading import save

    written = [folder / "refined.json"]
    with write_safely(written[0]) as temporary:
        text = json.dumps(to_json(_make_record(result)), indent=2)
        temporary.write_text(text + "\n", encoding="utf-8")
    for owner, fit in result.fits.items():
        written.append(folder / f"{to_file_stem(owner)}.json")
        save(fit, written[-1])
    for name in result.names:
        written.append(folder / f"look_{to_file_stem(name)}.png")
        result.look(name).write(written[-1])
    return written
