"""`brdfkit convert`: writes a material in another file format, or a map in another convention."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click

from brdfkit.cli.console import Console
from brdfkit.cli.options import mend_options, writing_options
from brdfkit.cli.settings import values_option
from brdfkit.core.errors import BrdfkitError


@click.command()
@click.argument("thing", metavar="FILE|NAME|FIT|MAP")
@click.argument("output", type=click.Path(path_type=Path))
@values_option
@mend_options
@click.option("--source", metavar="CONVENTION", help="Convention of MAP. Default: mitsuba.")
@click.option("--target", metavar="CONVENTION", help="Convention of OUTPUT. Default: mitsuba.")
@click.option(
    "--turn", type=float, metavar="DEGREES", help="Turn the light of a map anticlockwise."
)
@click.option("--mirror", is_flag=True, help="Exchange left and right of a map.")
@click.option(
    "--height",
    type=int,
    metavar="N",
    help="Rows of pixels of the new map. Default: as many as keep the size of a pixel.",
)
@writing_options
def convert(
    thing: str,
    output: Path,
    values: tuple[str, ...],
    mends: dict[str, bool],
    console: Console,
    **options: Any,
) -> None:
    """Convert a material or an environment map.

    A material is written in the format that belongs to the suffix of OUTPUT. The command prints
    what the format cannot hold. Models and fits are evaluated at the direction pairs of a table.

    A MAP is an .exr or .hdr file, and its OUTPUT an .exr file. A CONVENTION is the name of a
    program, such as blender, or of a layout, such as cross or angular. The axes that point right,
    up and ahead may follow a layout, as in latlong:+x+y-z. An unknown name lists all conventions.
    """
    from brdfkit.cli.arguments import find_material, find_measured, refuse_mends
    from brdfkit.core.files import require_writable
    from brdfkit.lighting import environments
    from brdfkit.lighting.environments.map_files import looks_like_map
    from brdfkit.materials.converting import convert as convert_material

    require_writable(output)
    given = {name: value for name, value in options.items() if value not in (None, False)}
    if looks_like_map(thing):
        refuse_mends(thing, "an environment map", mends)
        if values:
            raise BrdfkitError(f"{thing} is an environment map: --set works for models only.")
        with console.progress(f"convert {thing}"):
            path = environments.convert(thing, output, **given)
        _print_conversion(path, (), path, console)
        return
    if given:
        raise BrdfkitError(
            f"{thing} is no environment map, .exr or .hdr: --source, --target, --turn, --mirror "
            "and --height are for maps only."
        )
    with console.progress(f"convert {thing}"):
        material = find_measured(thing, mends) if mends else find_material(thing, values)
        conversion = convert_material(material, output)
    _print_conversion(conversion.path, conversion.changes, conversion, console)


def _print_conversion(path: Path, changes: Sequence[str], text: object, console: Console) -> None:
    """Print the written file and what the conversion changed, as JSON or as `text` for people."""
    if console.as_json:
        console.print_json({"written": path, "changes": changes})
    else:
        console.output.print(f"written: {text}")
