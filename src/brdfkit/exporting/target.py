"""`Target`: a program or format to export to, and `Held`: what it draws of a material."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.names import to_printable
from brdfkit.exporting.ggx_sum import GgxSum, to_ggx_sum
from brdfkit.exporting.loss import Drawable
from brdfkit.model import Model

ONE = "ggx:fresnel=coloured"
GGX_SUMS = ONE, f"{ONE}+{ONE}"  # what to fit to materials of other forms than a `GgxSum`
COLUMNS = "diffuse", "highlights", "anisotropy", "else"  # of the table of targets
# What targets hold, in words, that hold every `GgxSum`, and that hold a table of any material
GGX_SUM = {
    "diffuse": "Lambert",
    "highlights": "GGX, any number, any colour",
    "anisotropy": "yes",
    "else": "nothing",
}
TABLE = dict.fromkeys(COLUMNS, "any, in a table") | {"anisotropy": "yes"}


@dataclass(frozen=True)
class Held:
    """A material as a target draws it.

    `drawn`: the material that the target draws, with `eval`; `content`: what the target writes,
    such as a `GgxSum`; `changes`: what the target does not hold of the model, in words.
    """

    drawn: Drawable
    content: Any
    changes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Target:
    """A program or format, what it can hold, and how a material is written for it.

    `name`: the word by which users choose it; `title`: what it is, in a few words; `suffix`: the
    suffix of its file; `holds`: what it can hold, in words, by `COLUMNS`; `hold`: function that
    returns what the target draws of a model in linear sRGB, or None if it cannot hold the model's
    form; `write`: function that writes what `hold` returned to a path, with a comment of several
    lines, and returns the files; `candidates`: labels of models to fit to other materials;
    `spectral`: whether `hold` takes models whose weights are spectra, as they are; `any_form`:
    whether it holds models of any form, for example in a table; `ending`: what the default name of
    its file has at the end, if another target has the same suffix.
    """

    name: str
    title: str
    suffix: str
    holds: dict[str, str]
    hold: Callable[[Model], Held | None]
    write: Callable[[Held, Path, list[str]], list[Path]]
    candidates: tuple[str, ...] = GGX_SUMS
    spectral: bool = False
    any_form: bool = False
    ending: str = ""

    def name_file(self, name: str) -> str:
        """Return the default name of the file for a material of this name."""
        return f"{name}{self.ending}{self.suffix}"

    def check_path(self, path: str | Path) -> Path:
        """Return the path to write; raise `BrdfkitError` for another suffix, and a wrong name."""
        path = Path(path)
        shown = to_printable(path.name)
        if shown != path.name:  # files state their names
            raise BrdfkitError(
                f"{shown}: its name has control characters, or bytes that are no UTF-8; choose "
                "another name."
            )
        if path.suffix.lower() != self.suffix:
            stem = path.stem or "material"
            raise BrdfkitError(
                f"{path}: a material for {self.name} is written as {self.suffix}; choose "
                f"{stem}{self.suffix}."
            )
        return path


def hold_ggx_sum(model: Model) -> Held | None:
    """Return what a target draws that holds every `GgxSum`; None for other models."""
    content = to_ggx_sum(model)
    return None if content is None else Held(model, content)


def hold_nearest_sum(model: Model, content: GgxSum, changes: tuple[str, ...]) -> Held:
    """Return a target's nearest `GgxSum` to a model, with the `changes` that led to it."""
    return Held(content.to_model(), content, changes) if changes else Held(model, content)
