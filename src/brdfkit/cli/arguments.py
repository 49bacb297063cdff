"""Turns words of the command line into materials, parameter values and files to write."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

from brdfkit.cli.settings import parse_settings
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import make_folder, require_writable, write_safely
from brdfkit.materials import resolve
from brdfkit.materials.measured import Measured
from brdfkit.model import labels
from brdfkit.rendering.film import find_film_suffix
from brdfkit.rendering.montage import find_picture_suffix

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FIGURES = ".png", ".pdf", ".svg"


def find_material(name: str, settings: Iterable[str] = ()) -> Any:
    """Return the material of a name or file; `settings`, PARAMETER=VALUE, are for a model."""
    if not settings:
        return resolve.to_material(name)
    label = labels.load_files_in_label(name)
    if not labels.is_label(label):
        raise BrdfkitError(f"{name} is no model: --set works for models only.")
    values = parse_settings(settings, "--set", "VALUE", "R,G,B")
    for parameter in values:
        labels.model(label).parameter(parameter)
    return labels.model(label)(**values)


def find_measured(name: str, mends: Mapping[str, bool]) -> Measured:
    """Return the measured material of a name or file, after the repairs `mends`."""
    measured = resolve.to_measured(name)
    return measured.mend(**mends) if mends else measured


def refuse_mends(name: str, what: str, mends: Mapping[str, bool]) -> None:
    """Raise `BrdfkitError` if repairs, `mends`, are asked of `name`, which is no measurement.

    `what` says in the error what it is.
    """
    if mends:
        raise BrdfkitError(
            f"{name} is {what}: --mirror-azimuth and --divide-by-cos are for measured samples only."
        )


@contextmanager
def use_results_folder(path: Path | None) -> Iterator[None]:
    """Make the folder `path`, unless it is None; remove it after the block if it is empty."""
    if path is None:
        yield
        return
    new = [p for p in (path, *path.parents) if not p.exists()]
    try:
        make_folder(path)
        yield
    finally:
        for p in new:
            with suppress(OSError):  # rmdir removes only empty folders
                p.rmdir()


def check_picture_path(name: str | Path) -> Path:
    """Check, before a long rendering, that a picture can be written; return its path."""
    path = Path(name)
    find_picture_suffix(path)
    require_writable(path)
    require_writable(path.with_suffix(".png"))
    return path


def check_film_path(name: str | Path) -> Path:
    """Check, before a long rendering, that a film can be written; return its path."""
    path = Path(name)
    find_film_suffix(path)
    require_writable(path)
    return path


def check_figure_path(name: str | Path) -> Path:
    """Check that a matplotlib figure can be written; return its path."""
    path = Path(name)
    if path.suffix.lower() not in FIGURES:
        raise BrdfkitError(f"{path}: this picture is written as {', '.join(FIGURES)}; choose one.")
    require_writable(path)
    return path


def write_figure(figure: Figure, path: Path) -> None:
    """Write a matplotlib figure to `path`, completely or not at all."""
    with write_safely(path) as temporary:
        figure.savefig(temporary, dpi=130)
