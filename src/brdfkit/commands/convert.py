"""`brdfkit convert`: a material in another file format."""

from pathlib import Path

import click

from brdfkit.commands._options import output_options, values_option


@click.command()
@click.argument("thing", metavar="FILE|NAME|FIT")
@click.argument("output", type=click.Path(path_type=Path))
@values_option
@output_options
def convert(thing, output, values, console):
    """Write a material in the file format of OUTPUT's suffix.

    Tells what that format cannot hold. A model or a fit is evaluated over the hemispheres.
    """
    from brdfkit.commands._targets import material, other_file
    from brdfkit.converting import convert as convert_thing

    output = other_file(output, thing)
    with console.progress(f"convert {thing}"):
        done = convert_thing(material(thing, values), output)
    if console.as_json:
        console.json({"written": done.path, "changes": done.changes})
    else:
        console.out.print(f"written: {done}")
