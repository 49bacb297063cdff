"""Path-traces, writes and prints the pictures of `brdfkit render` and `brdfkit fit --render`."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from brdfkit.cli.console import Console
from brdfkit.cli.errors import print_message
from brdfkit.core.interrupts import find_exit_status

if TYPE_CHECKING:
    from brdfkit.images.tone_mapping import ToneMapping
    from brdfkit.rendering import Rendering
    from brdfkit.rendering.film import Film


def path_trace(things: Any, default_spp: int | None, console: Console, **how: Any) -> Rendering:
    """Path-trace `things` side by side with a progress bar; `how` are arguments of `render`.

    Without `spp` and noise floor in `how`, a pixel has `default_spp` samples, or the scene's own
    number if that is None.
    """
    from brdfkit.rendering.render_materials import render

    with console.progress("render") as progress:
        spp = how["spp"] or (default_spp if how["noise_floor"] is None else None)
        return render(things, **how | {"spp": spp}, progress=progress)


def write_picture(picture: Rendering, path: Path, tone: ToneMapping | str = "range") -> None:
    """Write a rendering to a file; print a message if it was interrupted or is too noisy."""
    picture.tone_mapped(tone).write(path)
    if picture.spp < (picture.requested or 0):
        print_message(
            f"interrupted; rendered with {picture.spp} of {picture.requested} samples per pixel."
        )
    elif picture.shortfall:
        print_message(picture.shortfall)


def write_result(result: Rendering | Film, path: Path, tone: ToneMapping, console: Console) -> None:
    """Write a picture or film to a file, print its figures, and end an interrupted command."""
    from brdfkit.rendering.film import Film

    if isinstance(result, Film):
        done = _write_film(result, path, tone, console)
    else:
        write_picture(result, path, tone)
        _print_picture(result, path, console)
        done = result.spp
    if done < (result.requested or 0):
        click.get_current_context().exit(find_exit_status())


def _print_picture(picture: Rendering, path: Path, console: Console) -> None:
    """Print the noise, the errors and the files of a rendering."""
    written = [path]
    if path.suffix.lower() == ".exr":
        written += [path.with_suffix(".png")]
    if console.as_json:
        console.print_json(
            {
                "pictures": list(picture.pictures),
                "psnr": picture.psnr(),
                "errors": picture.errors(),
                "spp": picture.spp,
                "seconds": picture.seconds,
                "written": written,
            }
        )
    else:
        if picture.differences:
            console.output.print(picture.head)
            console.print_image_errors(picture.errors())
        else:  # a noise floor that was not reached is reported by `write_picture`
            console.output.print(str(replace(picture, requested_noise_floor=None)))
        console.print_written(written)


def _write_film(film: Film, path: Path, tone: ToneMapping, console: Console) -> int:
    """Write a film to a file, print its length and path, and return its number of frames."""
    replace(film, tone_mapping=tone).write(path)
    count, requested = len(film.frames), film.requested
    if count < requested:
        print_message(f"interrupted; the film has {count} of {requested} frames.")
    if console.as_json:
        counts = {"frames": count, "requested": requested, "spp": film.spp, "seconds": film.seconds}
        console.print_json(counts | {"written": [path]})
    else:
        console.output.print(str(film))
        console.print_written([path])
    return count
