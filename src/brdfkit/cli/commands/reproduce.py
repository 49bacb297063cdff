"""`brdfkit reproduce`: runs the claims of a thesis and writes a page of them."""

from pathlib import Path

import click

from brdfkit.cli.errors import say
from brdfkit.cli.options import writing_options
from brdfkit.core.interrupts import exit_status


@click.command()
@click.argument("name", required=False)
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    default=Path("."),
    help="Folder for the page, NAME.md, and its figures. Default: this one.",
)
@click.option(
    "--data",
    type=click.Path(path_type=Path),
    metavar="FOLDER",
    help="Folder of the measurements. Default: that which BRDFKIT_DATA names.",
)
@click.option(
    "--tables",
    type=click.Path(path_type=Path),
    metavar="FOLDER",
    help="Folder of tables transcribed from theses. Default: thesis, beside the measurements.",
)
@click.option(
    "--part",
    "parts",
    multiple=True,
    metavar="PART",
    help="Run only this part, as table_9_1; repeat it for more.",
)
@writing_options
def reproduce(name, output, data, tables, parts, console):
    """Run the claims of a thesis again.

    Writes a page that says of each claim whether it is confirmed, with the printed figures beside
    ours. Without NAME, lists the theses. The measurements are third-party files: where one is
    missing, its source is named. Ctrl-C keeps the parts that are finished.
    """
    from brdfkit.cli.arguments import results_folder
    from brdfkit.theses import list_theses
    from brdfkit.theses import reproduce as run

    if name is None:
        _print_theses(list_theses(), console)
        return
    with results_folder(output), console.progress(f"reproduce {name}") as progress:
        found = run(
            name,
            path=output,
            data=data,
            tables=tables,
            parts=list(parts) or None,
            progress=progress,
        )
    _print(found, console)
    if found.unfinished:
        say(f"interrupted; not finished: {', '.join(found.unfinished)}.")
        click.get_current_context().exit(exit_status())


def _print_theses(found, console):
    if console.as_json:
        console.json(found)
        return
    console.table(["thesis", "title"], list(found.items()))


def _print(found, console):
    from brdfkit.theses.claims import count_verdicts

    if console.as_json:
        console.json(found)
        return
    rows = [(c.verdict, c.says, c.where, c.printed, c.ours) for c in found.claims]
    title = f"{found.name}: {len(rows)} claims: {count_verdicts(found.claims)}"
    console.table(["verdict", "claim", "where", "printed", "ours"], rows, title=title)
    console.list_written(found.written)
