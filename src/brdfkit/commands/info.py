"""`brdfkit info`: prints and draws the audit of a measured material."""

from dataclasses import asdict, fields
from pathlib import Path

import click

from brdfkit.commands._options import output_options
from brdfkit.errors import BrdfkitError


@click.command()
@click.argument("file", required=False)
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    help="Picture to write: a slice, the lobes and the albedo; .png, .pdf or .svg.",
)
@output_options
def info(file, output, console):
    """Audit a measured material.

    Prints what FILE holds (angles, coverage, reciprocity, noise, albedo and more), and what is
    doubtful. FILE is a measured file, or the name of a material that brdfkit knows. Without FILE,
    lists the materials that come with brdfkit; `brdfkit data` lists public ones.
    """
    from brdfkit.auditing import audit
    from brdfkit.catalogue import shipped
    from brdfkit.commands._targets import figure_file, write_figure
    from brdfkit.materials import measured_material

    if file is None and output:
        raise BrdfkitError("--output draws a measurement: name a FILE.")
    if file is None:
        _print_materials(shipped.materials(), console)
        return
    output = output and figure_file(output)
    with console.progress(f"read {file}"):
        material = measured_material(file)
    with console.progress("audit"):
        found = audit(material)
    if output:
        with console.progress("draw"):
            write_figure(found.picture(), output)
    print_audit(found, [output] if output else [], console)


def print_audit(found, written, console):
    """Print an audit: what was measured, and what is doubtful; then the files `written`."""
    if console.as_json:
        console.json(record(found, written))
        return
    notes = [(key.replace("_", " "), str(value)) for key, value in found.data.info.items()]
    console.out.print(found.name, style="bold")
    console.table(["", ""], list(found.rows().items()), notes)
    for finding in found.findings():
        console.out.print(f"! {finding}")
    console.list_written(written)


def record(found, written):
    """An audit for JSON, with the files `written`."""
    return {
        **{f.name: getattr(found, f.name) for f in fields(found) if f.name != "data"},
        "findings": found.findings(),
        "info": found.data.info,
        "written": written,
    }


def _print_materials(materials, console):
    if console.as_json:
        console.json({name: asdict(m) for name, m in materials.items()})
        return
    rows = [(name, m.title, m.licence) for name, m in materials.items()]
    console.table(["material", "what it is", "licence"], rows)
    console.out.print("Use a name where a file is asked for: brdfkit fit NAME")
