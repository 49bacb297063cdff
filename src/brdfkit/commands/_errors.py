"""How the command line tells errors: in one sentence."""

import errno
import os
import sys
import warnings
from contextlib import contextmanager, nullcontext

import click

from brdfkit.commands._stopping import status, stoppable
from brdfkit.errors import BrdfkitError, no_such
from brdfkit.names import printable

NO_ROOM = errno.ENOSPC, errno.EDQUOT, errno.EIO  # where standard output is a file


class Group(click.Group):
    """Tells errors that are meant for people in one sentence, with exit status 2."""

    def make_context(self, info_name, args, *others, **extra):
        with told() if args else nullcontext():  # without any click shows the help
            return super().make_context(info_name, args, *others, **extra)

    def invoke(self, ctx):
        for stream in (sys.stdout, sys.stderr):  # a terminal may not know θ: ? stands for it
            if hasattr(stream, "reconfigure"):
                stream.reconfigure(errors="replace")
        with told(), stoppable(), warnings.catch_warnings():
            warnings.showwarning = _say_warning
            try:
                return super().invoke(ctx)
            finally:
                _flush()


class Told(click.ClickException):
    """Ends the program with one sentence."""

    def __init__(self, message, exit_code=2):
        super().__init__(message)
        self.exit_code = exit_code

    def show(self, file=None):
        say(self.message)


@contextmanager
def told():
    """Turns errors for people and of click, a lost output, Ctrl-C and SIGTERM into `Told`."""
    try:
        yield
    except BrdfkitError as error:
        raise Told(str(error)) from error
    except click.UsageError as error:
        command = error.ctx.command_path if error.ctx else "brdfkit"
        raise Told(f"{_misused(error)}; see {command} --help.") from error
    except OSError as error:
        if error.errno not in NO_ROOM or error.filename:
            raise
        _drop_output()
        raise Told(f"the output cannot be written ({error.strerror}); make room.") from error
    except KeyboardInterrupt as error:
        raise Told("interrupted.", status()) from error


def _misused(error):
    """What click found wrong, an unknown name in the words that brdfkit has for all of them."""
    message = error.format_message()
    if isinstance(error, click.NoSuchCommand):
        message = str(no_such("command", error.command_name, error.ctx.command.commands))
    elif isinstance(error, click.NoSuchOption):
        parameters = error.ctx.command.get_params(error.ctx)
        options = [p.opts[-1] for p in parameters if isinstance(p, click.Option)]
        message = str(no_such("option", error.option_name, options))
    return message.rstrip(".")


def _flush():
    if sys.stdout:  # None, where it was closed
        sys.stdout.flush()


def _drop_output():
    """What could not be printed: or Python would try once more as it ends."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def say(message):
    """One sentence for people, on stderr."""
    click.echo(f"brdfkit: {printable(' '.join(str(message).split()))}", err=True)


def _say_warning(message, *_args, **_kwargs):
    say(message)
