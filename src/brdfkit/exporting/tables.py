"""What targets draw that hold tables of values instead of formulas."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

from brdfkit.exporting.target import Held
from brdfkit.materials.loading import load, save
from brdfkit.materials.measured import Measured
from brdfkit.model import Model


def hold_table(model: Model, material: Model | Measured, suffix: str, words: str) -> Held:
    """Return what a program draws of a table of the `model` in one of brdfkit's own formats.

    `material` is what is written: the model, or samples of it; `suffix` chooses the format; `words`
    say what the table loses. The content is the bytes of the file.
    """
    with TemporaryDirectory(prefix="brdfkit-") as folder:
        file = Path(folder, f"{model.type_name()}{suffix}")
        save(material, file)
        drawn, content = load(file), file.read_bytes()
    return Held(drawn, content, (words,))
