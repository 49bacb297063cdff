"""What the commands share: how errors are told, and options."""

import functools
import sys
import warnings
from contextlib import contextmanager, nullcontext

import click

from brdfkit.errors import BrdfkitError


class Group(click.Group):
    """Tells errors that are meant for people in one sentence, with exit status 2."""

    def make_context(self, info_name, args, *others, **extra):
        with told() if args else nullcontext():  # without any click shows the help
            return super().make_context(info_name, args, *others, **extra)

    def invoke(self, ctx):
        for stream in (sys.stdout, sys.stderr):  # a terminal may not know θ: ? stands for it
            if hasattr(stream, "reconfigure"):
                stream.reconfigure(errors="replace")
        with told(), warnings.catch_warnings():
            warnings.showwarning = _say_warning
            return super().invoke(ctx)


class Told(click.ClickException):
    """Ends the program with one sentence."""

    def __init__(self, message, exit_code=2):
        super().__init__(message)
        self.exit_code = exit_code

    def show(self, file=None):
        say(self.message)


@contextmanager
def told():
    """Turns errors for people, those of click too, and Ctrl-C into `Told`."""
    try:
        yield
    except BrdfkitError as error:
        raise Told(str(error)) from error
    except click.UsageError as error:
        command = error.ctx.command_path if error.ctx else "brdfkit"
        message = error.format_message().rstrip(".")
        raise Told(f"{message}; see {command} --help.") from error
    except KeyboardInterrupt as error:
        raise Told("interrupted.", 130) from error


def say(message):
    """One sentence for people, on stderr."""
    click.echo(f"brdfkit: {' '.join(str(message).split())}", err=True)


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
