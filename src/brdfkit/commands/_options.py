"""Options that several commands have."""

import functools
from math import isfinite
from pathlib import Path

import click

import brdfkit

SPP = 64  # samples per pixel


class Decibels(click.ParamType):
    """A number above 0, with or without dB behind it."""

    name = "dB"

    def convert(self, value, param, ctx):
        try:
            found = float(str(value).lower().removesuffix("db"))
        except ValueError:
            found = 0.0
        if not (found > 0 and isfinite(found)):
            self.fail(f"{value!r} is no noise floor; give one like 45dB.", param, ctx)
        return found


def output_options(command):
    """Adds --json and --quiet to a command that prints a result; it gets a `Console` instead."""

    @click.option("--json", "as_json", is_flag=True, help="Print the result as JSON.")
    @click.option("-q", "--quiet", is_flag=True, help="Print errors only, and JSON if asked for.")
    @functools.wraps(command)
    def with_output(*args, as_json, quiet, **kwargs):
        from brdfkit.commands._console import Console

        return command(*args, console=Console(as_json, quiet), **kwargs)

    return with_output


def render_options(command):
    """Adds --spp, --until, --size and --seed to a command that renders."""
    count = {"type": click.IntRange(min=1), "metavar": "N"}
    seed = {"type": click.IntRange(min=0), "metavar": "N"}
    size = "Side of a picture [pixels]. Default: 512, or what a scene file has."
    until = "Add samples until the noise floor, as a PSNR, is so high: 45dB is hardly seen."
    for option in (
        click.option("--seed", default=0, show_default=True, help="Seed of the samples.", **seed),
        click.option("--size", help=size, **count),
        click.option("--until", type=Decibels(), metavar="DECIBELS", help=until),
        click.option(
            "--spp",
            help=f"Samples per pixel; with --until the most. Default: {SPP}, or what it takes.",
            **count,
        ),
    ):
        command = option(command)
    return command


def scene_option(command):
    """Adds --scene to a command that renders materials."""
    # by the names of their files: to import the scenes takes a second
    folder = Path(brdfkit.__file__).with_name("rendering") / "scenes"
    names = ", ".join(sorted(file.stem for file in folder.glob("[!_]*.py")))
    option = click.option(
        "--scene",
        default="ball",
        show_default=True,
        metavar="SCENE",
        help=f"What shows the material: {names}; a mesh of yours, .obj or .ply; or FILE.xml#ID, a "
        "scene, and in it the BSDF to replace, which need not be named if it is 'material'.",
    )
    return option(command)


def values_option(command):
    """Adds --set, for the parameters of models."""
    option = click.option(
        "-p",
        "--set",
        "values",
        multiple=True,
        metavar="PARAMETER=VALUE",
        help="Set a parameter of the models to a number or R,G,B; repeat it for more.",
    )
    return option(command)
