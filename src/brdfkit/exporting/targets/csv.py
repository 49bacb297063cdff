"""CSV: the values at the cells of a table over half and difference angles, for any program."""

from pathlib import Path
from tempfile import TemporaryDirectory

from brdfkit.exporting.filling import write_text
from brdfkit.exporting.hold import sample_on_grid
from brdfkit.exporting.target import Held, Target
from brdfkit.materials.loading import save
from brdfkit.model import Model


def hold(model: Model) -> Held:
    """Return the model itself, whose values at the cells are exact."""
    return Held(model, model)


def write(held: Held, path: Path, comment: list[str]) -> list[Path]:
    """Write the table, with the comment above it."""
    with TemporaryDirectory(prefix="brdfkit-") as folder:
        table = Path(folder, "table.csv")
        save(sample_on_grid(held.content), table)
        text = table.read_text(encoding="utf-8")
    write_text(path, "".join(f"# {line}\n" for line in comment) + text)
    return [path]


TARGET = Target(
    name="csv",
    title="Directions and values, a row for each",
    suffix=".csv",
    holds={
        "diffuse": "any",
        "highlights": "any; exact at the cells",
        "anisotropy": "yes",
        "else": "any",
    },
    hold=hold,
    write=write,
    any_form=True,
)
