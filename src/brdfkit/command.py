"""What the commands share: how errors are told, and options."""

import functools
import sys
import warnings

import click

from brdfkit.errors import BrdfkitError

LARGEST_SEED = 2**31 - 1


class Group(click.Group):
    """Tells errors that are meant for people in one sentence, with exit status 2."""

    def invoke(self, ctx):
        for stream in (sys.stdout, sys.stderr):  # a terminal may not know θ: ? stands for it
            if hasattr(stream, "reconfigure"):
                stream.reconfigure(errors="replace")
        try:
            with warnings.catch_warnings():
                warnings.showwarning = _say_warning
                return super().invoke(ctx)
        except BrdfkitError as error:
            say(error)
            ctx.exit(2)
        except click.UsageError as error:
            at = error.ctx.command_path if error.ctx else ctx.command_path
            say(f"{error.format_message().rstrip('.')}; see {at} --help.")
            ctx.exit(2)
        except KeyboardInterrupt:
            say("interrupted.")
            ctx.exit(130)


def say(message):
    """One sentence for people, on stderr."""
    click.echo(f"brdfkit: {message}", err=True)


def _say_warning(message, *_args, **_kwargs):
    say(message)


def output_options(command):
    """The options of every command that prints a result; it gets a `console`."""

    @click.option("--json", "as_json", is_flag=True, help="Print the result as JSON.")
    @click.option("-q", "--quiet", is_flag=True, help="No progress, no tables: only errors.")
    @functools.wraps(command)
    def with_output(*args, as_json, quiet, **kwargs):
        from brdfkit.console import Console

        return command(*args, console=Console(as_json, quiet), **kwargs)

    return with_output


def render_options(command):
    """The options of every command that renders."""
    positive = click.IntRange(min=1)
    seeds = click.IntRange(0, LARGEST_SEED)
    for option in (
        click.option("--seed", default=0, type=seeds, metavar="N", help="Seed of the samples."),
        _number("--size", 512, positive, "Side of a picture [pixels]."),
        _number("--spp", 64, positive, "Samples per pixel."),
    ):
        command = option(command)
    return command


def values_option(command):
    """The option that sets parameters of models."""
    option = click.option(
        "-p",
        "--set",
        "values",
        multiple=True,
        metavar="PARAMETER=VALUE",
        help="A parameter of the models named, a number or R,G,B; repeat it.",
    )
    return option(command)


def _number(name, default, kind, meaning):
    return click.option(
        name, default=default, type=kind, metavar="N", show_default=True, help=meaning
    )
