"""`brdfkit info`: prints and draws the audit of a measured material, or of an environment map."""

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
    help="Picture to write, .png, .pdf or .svg: a slice, the lobes and the albedo; or the map.",
)
@output_options
def info(file, output, console):
    """Audit a measurement or an environment map.

    Prints what FILE holds (angles, coverage, reciprocity, noise, albedo and more; of a map, its
    brightness and where its light comes from), and what is doubtful. FILE is a measured file, a map
    (.exr, .hdr), or the name of one that brdfkit knows. Without FILE, lists what comes with
    brdfkit; `brdfkit data` lists what is public.
    """
    from brdfkit.auditing import audit
    from brdfkit.catalogue import shipped
    from brdfkit.commands._targets import figure_file, write_figure
    from brdfkit.environments import audit_environment
    from brdfkit.environments.map_files import looks_like_map
    from brdfkit.materials import measured_material

    if file is None and output:
        raise BrdfkitError("--output draws a measurement or a map: name a FILE.")
    if file is None:
        _print_shipped(shipped.materials(), shipped.environments(), console)
        return
    output = output and figure_file(output)
    is_map = looks_like_map(file)
    with console.progress(f"read {file}"):
        material = file if is_map else measured_material(file)
    with console.progress("audit"):
        found = audit_environment(material) if is_map else audit(material)
    if output:
        with console.progress("draw"):
            write_figure(found.picture(), output)
    print_audit(found, [output] if output else [], console)


def print_audit(found, written, console):
    """Print an audit: what was measured, and what is doubtful; then the files `written`."""
    if console.as_json:
        console.json(record(found, written))
        return
    notes = [(key.replace("_", " "), str(value)) for key, value in _notes(found).items()]
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
        "info": _notes(found),
        "written": written,
    }


def _notes(found):
    """The notes of a measured file; a map has none."""
    return getattr(found.data, "info", {})


def _print_shipped(materials, environments, console):
    if console.as_json:
        console.json({name: asdict(m) for name, m in (materials | environments).items()})
        return
    kinds = {"material": materials, "environment map": environments}
    for kind, things in kinds.items():
        rows = [(name, m.title, m.licence) for name, m in things.items()]
        console.table([kind, "what it is", "licence"], rows)
    console.out.print("Use a name where a file is asked for: brdfkit fit NAME, --envmap NAME")
