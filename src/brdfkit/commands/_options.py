"""Options that several commands have."""

import functools

import click


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
    """Adds --spp, --size and --seed to a command that renders."""
    for name, default, least, meaning in (
        ("--seed", 0, 0, "Seed of the samples."),
        ("--size", 512, 1, "Side of a picture [pixels]."),
        ("--spp", 64, 1, "Samples per pixel."),
    ):
        kind = click.IntRange(min=least)
        option = click.option(
            name, default=default, type=kind, metavar="N", show_default=True, help=meaning
        )
        command = option(command)
    return command


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
