"""The command line. Everything heavy is imported when a command runs: `--help` is instant."""

import functools
import sys
import warnings
from pathlib import Path

import click

from brdfkit import __version__
from brdfkit.errors import BrdfkitError


class Group(click.Group):
    """Turns errors that are meant for people into one sentence and exit status 2."""

    def invoke(self, ctx):
        warnings.showwarning = _say_warning
        try:
            return super().invoke(ctx)
        except BrdfkitError as error:
            click.echo(f"brdfkit: {error}", err=True)
            ctx.exit(2)
        except KeyboardInterrupt:
            click.echo("brdfkit: interrupted.", err=True)
            ctx.exit(130)


def _say_warning(message, *_args, **_kwargs):
    click.echo(f"brdfkit: {message}", err=True)


@click.group(cls=Group, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, "-V", "--version", prog_name="brdfkit")
def main():
    """Fit BRDF models to measured materials, and path-trace both.

    \b
    brdfkit fit copper.astm -m ward -m ggx --render -o copper
    brdfkit render car_paint -o paint.png
    """


def output_options(command):
    """The options of every command that prints a result."""

    @click.option("--json", "as_json", is_flag=True, help="Print the result as JSON.")
    @click.option("-q", "--quiet", is_flag=True, help="No progress, no tables: only errors.")
    @functools.wraps(command)
    def with_output(*args, as_json, quiet, **kwargs):
        from brdfkit.console import Console

        return command(*args, console=Console(as_json, quiet), **kwargs)

    return with_output


def render_options(command):
    """The options of every command that renders."""
    for option in (
        click.option("--seed", default=0, show_default=True, help="Seed of the samples."),
        click.option("--size", default=512, show_default=True, help="Side of a picture [pixels]."),
        click.option("--spp", default=64, show_default=True, help="Samples per pixel."),
    ):
        command = option(command)
    return command


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
    """What is in a measured FILE; without FILE, the materials that brdfkit brings."""
    from brdfkit import catalogue
    from brdfkit.targets import measured

    if file is None:
        console.materials(catalogue.materials())
    else:
        console.measured(measured(file))


@main.command()
@click.argument("file")
@click.option("-m", "--model", "names", multiple=True, help="A model; repeat it. Default: all.")
@click.option("--loss", default="log", show_default=True, help="cosine, log or cbrt.")
@click.option("-o", "--output", type=click.Path(path_type=Path), help="Folder for the results.")
@click.option("--render", "rendered", is_flag=True, help="Path-trace the measurement and the fits.")
@click.option("--max-angle", default=80.0, show_default=True, help="Use angles below [degrees].")
@render_options
@output_options
def fit(file, names, loss, output, rendered, max_angle, spp, size, seed, console):
    """Fit models to a measured FILE (or a material that brdfkit brings)."""
    from brdfkit import registry
    from brdfkit.comparing import compare
    from brdfkit.files import folder
    from brdfkit.fitting import fit as fit_model
    from brdfkit.formats import save
    from brdfkit.targets import measured

    for name in names:
        registry.model(name)
    material = measured(file)
    if output is None and rendered:
        output = Path(material.name)
    if output is not None:
        folder(output)

    fits = []
    try:
        for name in names or registry.models():
            with console.progress(f"fit {name}") as progress:
                found = fit_model(
                    name, material, loss, max_angle=max_angle, seed=seed, progress=progress
                )
            fits.append(found)
            if output is not None:
                save(found, output / f"{name}.json")
    except KeyboardInterrupt:
        if not fits:
            raise
        click.echo(f"brdfkit: interrupted; kept {len(fits)} of the fits.", err=True)
        rendered = False

    fits.sort(key=lambda f: f.loss)
    written = [output / f"{f.name}.json" for f in fits] if output else []
    psnr = {}
    if rendered:
        picture = _render([material, *fits], output / "render.exr", spp, size, seed, console)
        psnr = picture.psnr()
        written += [output / "render.exr", output / "render.png"]
    console.fits(material, fits, compare(material, fits, max_angle), psnr, written)


@main.command()
@click.argument("things", nargs=-1, required=True, metavar="FIT|NAME|FILE|SCENE.xml...")
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    help="Picture to write, .exr (with a .png beside it) or .png. Default: NAME.png.",
)
@click.option(
    "-p",
    "--set",
    "values",
    multiple=True,
    metavar="PARAMETER=VALUE",
    help="A parameter of the models named; repeat it.",
)
@render_options
@output_options
def render(things, output, values, spp, size, seed, console):
    """Path-trace saved fits, models by name, measured files, or a Mitsuba scene.

    Several THINGS are rendered side by side; the first is the reference of the differences.
    """
    from brdfkit.rendering import render_scene
    from brdfkit.targets import material

    scenes = [t for t in things if t.lower().endswith(".xml")]
    if scenes:
        if len(things) > 1 or values:
            raise BrdfkitError("A scene is rendered alone and as it is: name one SCENE.xml.")
        output = output or Path(scenes[0]).with_suffix(".png").name
        with console.progress("render") as progress:
            picture = render_scene(scenes[0], spp=spp, seed=seed, progress=progress)
        picture.write(output)
    else:
        found = [material(thing, values) for thing in things]
        output = output or Path(f"{found[0].name}.png")
        picture = _render(found, output, spp, size, seed, console)
    console.rendering(picture, Path(output))


@main.command()
@click.argument("things", nargs=-1, required=True, metavar="NAME|FILE.py|FIT|FILE...")
@click.option(
    "-p",
    "--set",
    "values",
    multiple=True,
    metavar="PARAMETER=VALUE",
    help="A parameter of the models named; repeat it.",
)
@output_options
def check(things, values, console):
    """Check that models sample, conserve energy and differentiate as they should."""
    from brdfkit.checks import check as check_thing
    from brdfkit.targets import to_check

    reports = []
    for thing in (t for name in things for t in to_check(name, values)):
        with console.progress(f"check {thing.name}") as progress:
            reports.append(check_thing(thing, progress=progress))
    console.reports(reports)
    sys.exit(0 if all(reports) else 1)


def _render(things, output, spp, size, seed, console):
    from brdfkit.files import require_writable
    from brdfkit.rendering import render as render_things

    require_writable(output)
    with console.progress("render") as progress:
        picture = render_things(things, spp=spp, size=size, seed=seed, progress=progress)
    picture.write(output)
    return picture
