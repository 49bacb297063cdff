"""`brdfkit convert`: writes a material in another file format, or a map in another convention."""

from pathlib import Path

import click

from brdfkit.cli.options import mend_options, values_option, writing_options
from brdfkit.core.errors import BrdfkitError


@click.command()
@click.argument("thing", metavar="FILE|NAME|FIT|MAP")
@click.argument("output", type=click.Path(path_type=Path))
@values_option
@mend_options
@click.option("--source", metavar="CONVENTION", help="Of MAP. Default: mitsuba.")
@click.option("--target", metavar="CONVENTION", help="Of OUTPUT, a map. Default: mitsuba.")
@click.option("--turn", type=float, metavar="DEGREES", help="Turn a map's light, anticlockwise.")
@click.option("--mirror", is_flag=True, help="Exchange left and right of a map.")
@click.option("--height", type=int, help="Rows of a map; default: pixels stay as large.")
@writing_options
def convert(thing, output, values, mends, console, **how):
    """Convert a material or an environment map.

    A material is written in the format that the suffix of OUTPUT names. What the format cannot hold
    is printed. A model or a fit is evaluated at the direction pairs of a table.

    A MAP is .exr or .hdr; then OUTPUT is .exr. A CONVENTION is the name of a program, such as
    blender, or of a layout, such as cross or angular, if need be with the axes of the world that
    are right, up and ahead in it, as latlong:+x+y-z. A name that is none lists them all.
    """
    from brdfkit.cli.arguments import material, measured_material, refuse_mends
    from brdfkit.core.files import require_writable
    from brdfkit.lighting import environments
    from brdfkit.lighting.environments.map_files import looks_like_map
    from brdfkit.materials.converting import convert as convert_thing

    require_writable(output)
    given = {name: value for name, value in how.items() if value not in (None, False)}
    if looks_like_map(thing):
        refuse_mends(thing, "an environment map", mends)
        if values:
            raise BrdfkitError(f"{thing} is an environment map: --set works for models only.")
        with console.progress(f"convert {thing}"):
            path = environments.convert(thing, output, **given)
        _print(path, (), path, console)
        return
    if given:
        raise BrdfkitError(
            f"{thing} is no environment map, .exr or .hdr: --source, --target, --turn, --mirror "
            "and --height are for maps only."
        )
    with console.progress(f"convert {thing}"):
        source = measured_material(thing, mends) if mends else material(thing, values)
        done = convert_thing(source, output)
    _print(done.path, done.changes, done, console)


def _print(path, changes, text, console):
    """Print the file that was written, and what changed."""
    if console.as_json:
        console.json({"written": path, "changes": changes})
    else:
        console.out.print(f"written: {text}")
