"""`brdfkit complete`: makes a full table of a material that was measured at few directions."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from brdfkit.cli.console import Console
from brdfkit.cli.options import mend_options, output_option, prior_option, writing_options


@click.command()
@click.argument("file", metavar="FILE|NAME")
@prior_option
@click.option(
    "--noise",
    type=float,
    metavar="SHARE",
    help="Relative standard deviation of a value. Default: the file's standard errors, or the "
    "scatter of repeated directions, or 0.05.",
)
@click.option(
    "--alignment",
    type=float,
    default=0.0,
    metavar="DEGREES",
    show_default=True,
    help="Angle by which the measured directions may be off.",
)
@click.option(
    "--aperture",
    type=float,
    default=0.0,
    metavar="DEGREES",
    show_default=True,
    help="Half angle of the cone over which the instrument averages.",
)
@mend_options
@output_option(
    "File to write; its suffix chooses the format. Standard errors and evidence are kept in .npz. "
    "Default: nothing is written."
)
@writing_options
def complete(
    file: str, output: Path | None, mends: dict[str, bool], console: Console, **how: Any
) -> None:
    """Complete a material that was measured at few directions.

    A prior, what materials have in common, tells what a few values, or a part of the hemisphere,
    imply everywhere else. The result is a full table. The command prints which share of it was
    measured, inferred from measured values or guessed, how wide its 95 % intervals are, and its
    albedo. brdfkit plan says which directions to measure.
    """
    from brdfkit.cli.arguments import find_measured
    from brdfkit.core.files import require_writable
    from brdfkit.materials.completion import complete as complete_material
    from brdfkit.materials.completion.summary import describe_completion
    from brdfkit.materials.loading import save

    if output:
        require_writable(output)
    with console.progress(f"complete {file}"):
        completed = complete_material(find_measured(file, mends), **how)
        rows = describe_completion(completed)
    if output:
        save(completed, output)
    written = [output] if output else []
    unlike, dimmed = map(completed.info.get, ("unlike", "dimmed"))
    if console.as_json:
        warnings = {"unlike": unlike, "dimmed": dimmed}
        console.print_json({"name": completed.name, **rows, **warnings, "written": written})
        return
    console.output.print(completed.name, style="bold")
    console.print_table(["", ""], list(rows.items()))
    if unlike:
        console.output.print(f"! unlike every material of the prior: {unlike}")
    if dimmed:
        console.output.print(f"! dimmed: {dimmed}")
    console.print_written(written)
