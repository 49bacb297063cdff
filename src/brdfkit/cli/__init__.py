"""The program `brdfkit`; each file in `commands/` holds one of its commands."""

import importlib
import pkgutil

import click

from brdfkit import __version__
from brdfkit.cli import commands
from brdfkit.cli.errors import Group


@click.group("brdfkit", cls=Group, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, "-V", "--version", prog_name="brdfkit")
def main() -> None:
    """Fit BRDF models to measured materials, and path-trace both.

    \b
    brdfkit info copper.astm -o copper.png
    brdfkit fit copper.astm -m ward -m ggx --render -o copper
    brdfkit render car_paint -o paint.png
    """


for _name in sorted(file.name for file in pkgutil.iter_modules(commands.__path__)):
    main.add_command(getattr(importlib.import_module(f"{commands.__name__}.{_name}"), _name))
