"""`brdfkit gallery`: draws a picture with a ball of each material in a folder."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click

from brdfkit.cli.console import Console
from brdfkit.cli.errors import exit_interrupted, print_message
from brdfkit.cli.options import output_option, writing_options
from brdfkit.core.errors import BrdfkitError

SIZE = 160  # pixels of a ball's picture
# What the picture says below a name, by the class of the material
KINDS = {"Measured": "measured", "Fit": "fitted", "BsdfMaterial": "Mitsuba's"}


@click.command()
@click.argument("things", nargs=-1, required=True, metavar="FOLDER|FILE|NAME...")
@output_option("Picture to write, .png.", default="gallery.png", show_default=True)
@click.option(
    "--size",
    type=click.IntRange(32, 1024),
    metavar="N",
    default=SIZE,
    show_default=True,
    help="Side of the picture of each ball [pixels].",
)
@writing_options
def gallery(things: tuple[str, ...], output: Path, size: int, console: Console) -> None:
    """Show a ball of each material, with its name, in one picture.

    From a FOLDER, each file that holds a measured material or a saved fit is shown; the command
    lists files that it skips. If a FILE or a NAME itself cannot be read, the exit status is 2. The
    balls are previews without noise, lit by the environment map studio. After Ctrl-C, the picture
    has the balls that are finished.
    """
    from brdfkit.cli.arguments import check_figure_path
    from brdfkit.core.files import write_safely

    if output.suffix.lower() != ".png":
        raise BrdfkitError(f"{output}: a gallery is written as .png; choose that.")
    output = check_figure_path(output)
    names = _list_material_names(things, output)
    balls, skipped, interrupted = _draw_balls(names, size, console)
    if balls:
        from brdfkit.rendering.contact_sheet import draw_contact_sheet

        sheet = draw_contact_sheet(balls)
        with write_safely(output) as temporary:
            sheet.save(temporary, "PNG")
    written = [output] if balls else []
    if console.as_json:
        console.print_json({"materials": list(balls), "skipped": skipped, "written": written})
    else:
        console.print_written(written)
    for name, reason in skipped.items():
        print_message(f"skipped {reason}" if name in reason else f"skipped {name}: {reason}")
    if interrupted:
        exit_interrupted(f"{len(balls)} of {len(names)} balls are finished")
    if not balls or set(skipped) & set(things):
        click.get_current_context().exit(2)


def _list_material_names(things: Sequence[str], output: Path) -> list[str]:
    """Return the names of materials: `things`, or the files in folders, except the `output`."""
    names: list[str] = []
    for thing in things:
        if not Path(thing).is_dir():
            names.append(thing)
            continue
        files = sorted(path for path in Path(thing).iterdir() if path.is_file())
        names += [str(p) for p in files if p.name[0] != "." and p.resolve() != output.resolve()]
    if not names:
        raise BrdfkitError(f"{', '.join(things)}: the folder is empty; name one with files.")
    return list(dict.fromkeys(names))


def _draw_balls(
    names: Sequence[str], size: int, console: Console
) -> tuple[dict[str, tuple[Any, str]], dict[str, str], bool]:
    """Draw a ball of each material.

    Returns the pictures and kinds by the materials' names, the errors by the names of those that
    cannot be read, and whether Ctrl-C ended the drawing.
    """
    from brdfkit.core.names import make_unique
    from brdfkit.materials.resolve import to_material
    from brdfkit.rendering.previewing.preview import preview

    balls: dict[str, tuple[Any, str]] = {}
    skipped: dict[str, str] = {}
    try:
        with console.progress(f"draw {len(names)} balls") as progress:
            for done, name in enumerate(names, 1):
                try:
                    material = to_material(name)
                    (picture,) = preview(material, size=size).pictures.values()
                    kind = KINDS.get(type(material).__name__, "model")
                    balls[make_unique(material.name, balls)] = picture, kind
                except BrdfkitError as error:
                    skipped[name] = str(error)
                progress(done, len(names))
    except KeyboardInterrupt:
        return balls, skipped, True
    return balls, skipped, False
