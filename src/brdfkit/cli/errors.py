"""Prints each error and warning of the command line as one sentence on standard error."""

from __future__ import annotations

import errno
import os
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from typing import Any, NoReturn

import click

from brdfkit.cli.outputs import record_writing, refuse_to_replace
from brdfkit.core.errors import BrdfkitError, no_such_error
from brdfkit.core.files import watch_writing
from brdfkit.core.interrupts import find_exit_status, is_stopped_by_signal, stop_on_signals
from brdfkit.core.names import to_printable

WRITE_ERRORS = errno.ENOSPC, errno.EDQUOT, errno.EIO  # no space, quota exceeded, device failed
FIT_OPTIONS = "--fixed", "--bound", "--isotropic", "--anisotropic"
LENGTH_LIMIT = 2000  # characters of a printed message


class Group(click.Group):
    """A click group that prints an error as one sentence and ends with exit status 2."""

    def make_context(
        self, info_name: str | None, args: list[str], *others: Any, **extra: Any
    ) -> Any:
        with translate_errors() if args else nullcontext():  # without args, click shows its help
            return super().make_context(info_name, args, *others, **extra)

    def invoke(self, ctx: click.Context) -> Any:
        for stream in (sys.stdout, sys.stderr):  # a terminal whose encoding lacks θ shows ?
            if hasattr(stream, "reconfigure"):
                stream.reconfigure(errors="replace")
        guard = watch_writing(refuse_to_replace, record_writing)
        with stop_on_signals(), translate_errors(), guard, warnings.catch_warnings():
            warnings.showwarning = lambda message, *_, **__: print_message(message)
            try:
                return super().invoke(ctx)
            finally:
                if sys.stdout:  # it is None where the shell closed it
                    sys.stdout.flush()  # here, where `translate_errors` catches errors


class FinalMessage(click.ClickException):
    """An exception that ends the program with one sentence and an exit status."""

    def __init__(self, message: str, exit_code: int = 2) -> None:
        super().__init__(message)
        self.exit_code = exit_code  # type: ignore[misc]  # click declares a class variable

    def show(self, file: Any = None) -> None:
        print_message(self.message)


@contextmanager
def translate_errors() -> Iterator[None]:
    """Turn errors that a user can cause, if the block raises them, into a `FinalMessage`.

    They are `BrdfkitError`, click's errors, failures to read a file or write the output, too little
    memory, Ctrl-C and SIGTERM, and any error that native code raises after one of these signals.
    """
    try:
        with _restore_interrupts():
            yield
    except BrdfkitError as error:
        raise FinalMessage(str(error)) from error
    except click.UsageError as error:
        command = error.ctx.command_path if error.ctx else "brdfkit"
        raise FinalMessage(f"{_describe_misuse(error)}; see {command} --help.") from error
    except OSError as error:
        if error.filename is not None:  # an error of a file, such as a too long name
            raise FinalMessage(
                f"{error.filename!s:.200}: {error.strerror}; name another."
            ) from error
        if error.errno not in WRITE_ERRORS:
            raise
        # Discard the output that is left, which Python would try to print again at exit
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        raise FinalMessage(
            f"the output cannot be written ({error.strerror}); make room."
        ) from error
    except MemoryError as error:
        raise FinalMessage("there is too little memory for this; make it smaller.") from error
    except KeyboardInterrupt as error:
        raise FinalMessage("interrupted.", find_exit_status()) from error


@contextmanager
def _restore_interrupts() -> Iterator[None]:
    """Raise KeyboardInterrupt instead of any error that native code raises after Ctrl-C."""
    try:
        yield
    except (click.exceptions.Exit, FinalMessage):
        raise
    except Exception as error:
        if is_stopped_by_signal():
            raise KeyboardInterrupt from error
        raise


def _describe_misuse(error: click.UsageError) -> str:
    """Return click's message without its full stop; for an unknown name, propose a known one."""
    message = error.format_message()
    command: Any = error.ctx and error.ctx.command
    if isinstance(error, click.NoSuchCommand):
        message = str(no_such_error("command", error.command_name, command.commands))
    elif isinstance(error, click.NoSuchOption) and error.ctx:
        if error.option_name in FIT_OPTIONS:
            message = (
                f"{error.option_name} is for brdfkit fit and report, and {error.ctx.info_name} "
                "fits nothing: name a saved fit, or set a model's parameters by --set"
            )
        else:
            parameters = command.get_params(error.ctx)
            options = [p.opts[-1] for p in parameters if isinstance(p, click.Option)]
            message = str(no_such_error("option", error.option_name, options))
    return message.rstrip(".")


def print_message(message: object) -> None:
    """Print one sentence on standard error, without its middle where it is very long."""
    text = to_printable(" ".join(str(message).split()))
    if len(text) > LENGTH_LIMIT:
        text = f"{text[: LENGTH_LIMIT // 2]} … {text[-LENGTH_LIMIT // 4 :]}"
    click.echo(f"brdfkit: {text}", err=True)


def exit_interrupted(message: str) -> NoReturn:
    """Print what was finished before Ctrl-C or SIGTERM, and end the command with its status."""
    print_message(f"interrupted; {message}.")
    click.get_current_context().exit(find_exit_status())
