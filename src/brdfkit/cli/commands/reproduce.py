"""`brdfkit reproduce`: checks the claims of a thesis, and writes a page about them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from brdfkit.cli.cluster import connect_client, scheduler_option
from brdfkit.cli.console import Console
from brdfkit.cli.errors import exit_interrupted
from brdfkit.cli.options import output_option, writing_options

if TYPE_CHECKING:
    from brdfkit.theses import Reproduction


@click.command()
@click.argument("name", required=False)
@output_option(
    "Folder for the page, NAME.md, and its figures. Default: the current folder.", default=Path(".")
)
@click.option(
    "--data",
    type=click.Path(path_type=Path),
    metavar="FOLDER",
    help="Folder of the measurements. Default: the variable BRDFKIT_DATA.",
)
@click.option(
    "--tables",
    type=click.Path(path_type=Path),
    metavar="FOLDER",
    help="Folder of tables that were transcribed from theses. Default: the folder thesis beside "
    "that of the measurements.",
)
@click.option(
    "--part",
    "parts",
    multiple=True,
    metavar="PART",
    help="Check only this part, such as table_9_1; repeat it for more.",
)
@scheduler_option()
@writing_options
def reproduce(
    name: str | None,
    output: Path,
    data: Path | None,
    tables: Path | None,
    parts: tuple[str, ...],
    scheduler: str | None,
    console: Console,
) -> None:
    """Check the claims of a thesis by repeating its experiments.

    The command writes a page that says for each claim whether it is confirmed, with the printed
    figures beside the repeated ones. Without NAME, it lists the theses. The measurements are
    third-party files; if one is missing, the command names its source. After Ctrl-C, the parts that
    are finished are kept.
    """
    from brdfkit.cli.arguments import use_results_folder
    from brdfkit.theses import list_theses
    from brdfkit.theses import reproduce as reproduce_thesis

    if name is None:
        titles = list_theses()
        if console.as_json:
            console.print_json(titles)
        else:
            console.print_table(["thesis", "title"], list(titles.items()))
        return
    with (
        connect_client(scheduler) as client,
        use_results_folder(output),
        console.progress(f"reproduce {name}") as progress,
    ):
        result = reproduce_thesis(
            name,
            path=output,
            data=data,
            tables=tables,
            parts=list(parts) or None,
            client=client,
            progress=progress,
        )
    _print_claims(result, console)
    if result.unfinished:
        exit_interrupted(f"not finished: {', '.join(result.unfinished)}")


def _print_claims(result: Reproduction, console: Console) -> None:
    """Print the verdicts on the claims, and the files that were written."""
    from brdfkit.theses.claims import describe_counts

    if console.as_json:
        console.print_json(result)
        return
    rows = [(c.verdict, c.says, c.where, c.printed, c.ours) for c in result.claims]
    title = f"{result.name}: {describe_counts(result.claims)}"
    console.print_table(["verdict", "claim", "where", "printed", "ours"], rows, title=title)
    console.print_written(result.written)
