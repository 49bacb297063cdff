"""`brdfkit prior`: makes a prior of a folder of measured materials, for brdfkit complete."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from brdfkit.cli.console import Console
from brdfkit.cli.options import output_option, writing_options

if TYPE_CHECKING:
    from brdfkit.materials.completion.prior_folder import FolderPrior


@click.command()
@click.argument("folder", type=click.Path(path_type=Path))
@click.option(
    "--terms",
    metavar="TEXT",
    help="Terms of use of the files, which every result repeats. Default: those of a LICENSE or "
    "README in FOLDER.",
)
@click.option(
    "--with-models/--without-models",
    default=True,
    show_default=True,
    help="Count random materials of models as well, by 30 %.",
)
@output_option("File to write, .npz. Default: FOLDER.npz, in the current folder.")
@writing_options
def prior(
    folder: Path, terms: str | None, with_models: bool, output: Path | None, console: Console
) -> None:
    """Make a prior of a folder of measured materials.

    brdfkit complete and brdfkit plan take it as --prior. FOLDER needs at least 30 isotropic
    materials that brdfkit reads. They should resemble those that are to be completed. The command
    names the files that it leaves out. The prior keeps the checksums of its files and their terms
    of use, which brdfkit complete prints.
    """
    from brdfkit.core.files import require_writable
    from brdfkit.materials.completion.prior_file import require_npz, write_prior
    from brdfkit.materials.completion.prior_folder import make_folder_prior

    path = output or Path(f"{folder.resolve().name}.npz")
    require_npz(path)
    require_writable(path)
    with console.progress(f"prior {folder}") as progress:
        made = make_folder_prior(folder, terms=terms, with_models=with_models, progress=progress)
    write_prior(made.prior, path)
    _print_prior(made, path, console)


def _print_prior(made: FolderPrior, path: Path, console: Console) -> None:
    """Print what a prior was made from, and which files were left out."""
    known = made.prior
    low, high = known.wavelengths
    if console.as_json:
        record = {
            "name": known.name,
            "materials": known.materials,
            "wavelengths": known.wavelengths,
            "terms": known.terms,
            "sources": known.sources,
            "skipped": made.skipped,
            "written": [path],
        }
        console.print_json(record)
        return
    console.output.print(f"{known.name}: {known.materials} materials, {low:g} to {high:g} nm")
    for name, reason in made.skipped.items():
        console.output.print(f"! {name} is left out: {reason}", markup=False)
    for term in known.terms:
        console.output.print(f"terms: {term}", markup=False)
    console.print_written([path])
