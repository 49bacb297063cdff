"""The command line. Everything heavy is imported when a command runs: `--help` is instant."""

from pathlib import Path

import click

from brdfkit import __version__
from brdfkit.command import Group, output_options, render_options, say, values_option
from brdfkit.errors import BrdfkitError


@click.group(cls=Group, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, "-V", "--version", prog_name="brdfkit")
def main():
    """Fit BRDF models to measured materials, and path-trace both.

    \b
    brdfkit fit copper.astm -m ward -m ggx --render -o copper
    brdfkit render car_paint -o paint.png
    """


@main.command()
@click.argument("name", required=False)
@output_options
def models(name, console):
    """List the models, or show the page of one."""
    from brdfkit import registry

    if name is None:
        console.models(registry.models())
    else:
        console.model(registry.model(name))


@main.command()
@click.argument("file", required=False)
@output_options
def info(file, console):
    """Show what is in a measured FILE; without it, list the materials that brdfkit brings."""
    from brdfkit import catalogue
    from brdfkit.targets import measured

    if file is None:
        console.materials(catalogue.materials())
    else:
        with console.progress(f"read {file}"):
            material = measured(file)
        console.measured(material)


@main.command()
@click.argument("file")
@click.option("-m", "--model", "names", multiple=True, metavar="NAME", help=MODEL)
@click.option("--loss", default="log", show_default=True, metavar="NAME", help=LOSS)
@click.option("-o", "--output", type=click.Path(path_type=Path), help="Folder for the results.")
@click.option("--render", "rendered", is_flag=True, help="Path-trace the measurement and the fits.")
@click.option("--max-angle", default=80.0, show_default=True, help="Use angles below [degrees].")
@render_options
@output_options
def fit(file, names, loss, output, rendered, max_angle, spp, size, seed, console):
    """Fit models to a measured FILE, or to a material that brdfkit brings."""
    from brdfkit import registry
