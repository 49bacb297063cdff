"""Prints errors and warnings of the command line: one sentence on standard error."""

import errno
import os
import sys
import warnings
from contextlib import contextmanager, nullcontext

import click

from brdfkit.cli.outputs import refuse_to_replace, remember
from brdfkit.core.errors import BrdfkitError, no_such
from brdfkit.core.files import watch_writing
from brdfkit.core.interrupts import exit_status, is_stopped, stop_on_signals
from brdfkit.core.names import to_printable

NO_ROOM = errno.ENOSPC, errno.EDQUOT, errno.EIO  # writing to standard output, a file, failed
OF_FITS = "--fixed", "--bound", "--isotropic", "--anisotropic"
LONGEST = 2000  # characters of a sentence


class Group(click.Group):
    """Prints errors for people as one sentence, and ends with exit status 2."""

    def make_context(self, info_name, args, *others, **extra):
        with tell_errors() if args else nullcontext():  # without args click shows the help
            return super().make_context(info_name, args, *others, **extra)

    def invoke(self, ctx):
        for stream in (sys.stdout, sys.stderr):  # where a terminal does not know θ it shows ?
            if hasattr(stream, "reconfigure"):
                stream.reconfigure(errors="replace")
        guard = watch_writing(refuse_to_replace, remember)
        with stop_on_signals(), tell_errors(), guard, warnings.catch_warnings():
            warnings.showwarning = _say_warning
            try:
                return super().invoke(ctx)
            finally:
                _flush()


class LastWords(click.ClickException):
    """Ends the program with one sentence and an exit status."""

    def __init__(self, message, exit_code=2):
        super().__init__(message)
        self.exit_code = exit_code

    def show(self, file=None):
        say(self.message)


@contextmanager
def tell_errors():
    """Within the block, what should end the program with a sentence becomes `LastWords`.

    That is: errors for people, errors of click, a file or an output that fails, too little memory,
    Ctrl-C and SIGTERM, and any error that one of these two became.
    """
    try:
        with _stops_as_such():
            yield
    except BrdfkitError as error:
        raise LastWords(str(error)) from error
    except click.UsageError as error:
        command = error.ctx.command_path if error.ctx else "brdfkit"
        raise LastWords(f"{_describe_misuse(error)}; see {command} --help.") from error
    except OSError as error:
        if error.filename is not None:  # a name that is too long, for one
            raise LastWords(f"{error.filename!s:.200}: {error.strerror}; name another.") from error
        if error.errno not in NO_ROOM:
            raise
        _drop_output()
        raise LastWords(f"the output cannot be written ({error.strerror}); make room.") from error
    except MemoryError as error:
        raise LastWords("there is too little memory for this; make it smaller.") from error
    except KeyboardInterrupt as error:
        raise LastWords("interrupted.", exit_status()) from error


@contextmanager
def _stops_as_such():
    """Within the block, an error after Ctrl-C, which native code made of it, is Ctrl-C again."""
    try:
        yield
    except (click.exceptions.Exit, LastWords):
        raise
    except Exception as error:
        if is_stopped():
            raise KeyboardInterrupt from error
        raise


def _describe_misuse(error):
    """click's message, without its full stop; for unknown names the message of `no_such`."""
    message = error.format_message()
    if isinstance(error, click.NoSuchCommand):
        message = str(no_such("command", error.command_name, error.ctx.command.commands))
    elif isinstance(error, click.NoSuchOption) and error.option_name in OF_FITS:
        message = (
            f"{error.option_name} is for brdfkit fit and report, and {error.ctx.info_name} fits "
            "nothing: name a fit that they saved, or set a model's parameters by --set"
        )
    elif isinstance(error, click.NoSuchOption):
        parameters = error.ctx.command.get_params(error.ctx)
        options = [p.opts[-1] for p in parameters if isinstance(p, click.Option)]
        message = str(no_such("option", error.option_name, options))
    return message.rstrip(".")


def _flush():
    """Write out what was printed: where this fails, it should fail within `tell_errors`."""
    if sys.stdout:  # None, where it was closed
        sys.stdout.flush()


def _drop_output():
    """Forget what could not be printed: else Python would try again as it ends."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def say(message):
    """Print one sentence for people on standard error; what a file makes too long is cut."""
    text = to_printable(" ".join(str(message).split()))
    if len(text) > LONGEST:
        text = f"{text[: LONGEST // 2]} … {text[-LONGEST // 4 :]}"
    click.echo(f"brdfkit: {text}", err=True)


def _say_warning(message, *_args, **_kwargs):
    say(message)
