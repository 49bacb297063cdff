"""The reference of the command line: a page of every command, from click's own descriptions.

The pages are written to `docs/commands/`, which git ignores.
"""

from pathlib import Path

from brdfkit.cli import main
from extensions._pages import refresh

FOLDER = Path(__file__).parents[1] / "commands"


def setup(app):
    app.connect("builder-inited", lambda _: refresh(FOLDER, pages()))


def pages():
    """File name → text of all pages."""
    return {"index.rst": index()} | {f"{name}.rst": page(name) for name in main.commands}


def index():
    title = "The command line"
    rows = [
        f"   * - :doc:`brdfkit {name} <{name}>`\n     - {command.get_short_help_str(100)}"
        for name, command in main.commands.items()
    ]
    table = ".. list-table::\n   :widths: 25 75\n\n" + "\n".join(rows)
    toctree = ".. toctree::\n   :hidden:\n   :glob:\n\n   *"
    return f"{title}\n{'=' * len(title)}\n\n{table}\n\n{toctree}\n"


def page(name):
    command = main.commands[name].callback
    return f".. click:: {command.__module__}:{name}\n   :prog: brdfkit {name}\n   :nested: full\n"
