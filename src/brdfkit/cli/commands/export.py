"""`brdfkit export`: writes a fitted material for another renderer."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Any

import click

from brdfkit.cli.console import Console
from brdfkit.cli.options import output_option, writing_options
from brdfkit.cli.settings import values_option
from brdfkit.core.errors import BrdfkitError


@click.command()
@click.argument("thing", required=False, metavar="[FIT|MODEL]")
@click.argument("target", required=False, metavar="[TARGET]")
@output_option(
    "File to write; its suffix is the target's. Default: the name of FIT, or of its material where "
    "FIT is named by its model."
)
@values_option
@click.option(
    "-a",
    "--accept-loss",
    is_flag=True,
    help="Write the file even if its ball differs visibly (ΔE > 2).",
)
@writing_options
def export(
    thing: str | None,
    target: str | None,
    output: Path | None,
    values: tuple[str, ...],
    accept_loss: bool,
    console: Console,
) -> None:
    """Write a fitted material for another renderer.

    FIT is a saved fit, such as paint/ggx.json; MODEL is the name of a model, whose values --set
    gives. What TARGET can hold is written exactly. Anything else is fitted to TARGET's own formula,
    and the command says what was lost. Without arguments, it lists the targets and what they hold.
    """
    from brdfkit.cli.arguments import find_material
    from brdfkit.exporting.export import export as export_material
    from brdfkit.exporting.targets import find_target, list_targets

    if thing is None:
        _print_targets(console)
        return
    if target is None:
        names = ", ".join(list_targets())
        raise BrdfkitError(f"Name a target to export {thing} to: {names}.")
    aim = find_target(target)
    material = find_material(thing, values)
    path = output or Path(aim.name_file(_name_material(thing, material)))
    # Short options, since comments in XML cannot have two hyphens in a row
    settings = [word for value in values for word in ("-p", value)]
    accepted = ["-a"] * accept_loss
    words = ["brdfkit", "export", thing, target, "-o", str(path), *settings, *accepted]
    with console.progress(f"export {thing}"):
        done = export_material(
            material, target, path, accept_loss=accept_loss, command=shlex.join(words)
        )
    if console.as_json:
        lost = {"log_error": done.log_error, "delta_e": done.delta_e, "changes": done.changes}
        console.print_json({"written": done.paths, "target": target, **lost})
    else:
        console.output.print(f"written: {done}")


def _name_material(thing: str, material: Any) -> str:
    """Return the name of a material: of its file, or of the data if the model names the file."""
    from brdfkit.core.names import to_file_stem, to_fit_path
    from brdfkit.regression import Fit

    name = Path(thing).name
    if isinstance(material, Fit) and name == to_fit_path("", material.model.label()).name:
        return to_file_stem(material.data)
    return Path(thing).stem


def _print_targets(console: Console) -> None:
    """Print a table of the targets and what each one holds."""
    from brdfkit.exporting.target import COLUMNS
    from brdfkit.exporting.targets import list_targets

    targets = list_targets().values()
    if console.as_json:
        console.print_json({t.name: {"file": t.suffix, **t.holds} for t in targets})
        return
    titles = [(t.name, t.suffix, t.title) for t in targets]
    console.print_table(["target", "file", "what it is"], titles)
    # The names of models are code in the documentation
    rows = [(t.name, *(t.holds[c].replace("`", "") for c in COLUMNS)) for t in targets]
    console.print_table(["target", *COLUMNS], rows)
    console.output.print("To export a fit: brdfkit export FIT TARGET -o FILE")
