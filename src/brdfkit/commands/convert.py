"""`brdfkit convert`: writes a material in another file format."""

from pathlib import Path

import click

from brdfkit.commands._options import output_options, values_option


@click.command()
@click.argument("thing", metavar="FILE|NAME|FIT")
@click.argument("output", type=click.Path(path_type=Path))
@values_option
@output_options
def convert(thing, output, values, console):
    """Write a material in another format.

    The suffix of OUTPUT names the format. What the format cannot hold is printed. A model or a fit
    is evaluated at the direction pairs of a table.
    """
    from brdfkit.commands._targets import material, other_file
    from brdfkit.verbs.convert import convert as convert_thing

    output = other_file(output, thing)
    with console.progress(f"convert {thing}"):
        done = convert_thing(material(thing, values), output)
    if console.as_json:
        console.json({"written": done.path, "changes": done.changes})
    else:
        console.out.print(f"written: {done}")
