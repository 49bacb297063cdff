"""Connects a command to the Dask scheduler that --scheduler names."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import click

from brdfkit.core.errors import BrdfkitError

TIMEOUT = 10  # seconds within which the scheduler has to answer


def scheduler_option(scope: str = "") -> Callable[[Any], Any]:
    """Return the option --scheduler; `scope` says in the help when it applies, such as "Here: "."""
    return click.option(
        "--scheduler",
        metavar="ADDRESS",
        help=f"{scope}Address of a Dask scheduler, such as tcp://node:8786, whose workers compute "
        "instead of this machine; they need the same paths and the same brdfkit.",
    )


@contextmanager
def connect_client(address: str | None) -> Iterator[Any]:
    """Yield a client of the scheduler at an address, or None without one.

    Raises `BrdfkitError` if the package distributed is missing, or if no scheduler answers.
    """
    if address is None:
        yield None
        return
    try:
        from distributed import Client
    except ImportError:
        raise BrdfkitError(
            "--scheduler needs the package distributed; pip install 'brdfkit[cluster]' brings it."
        ) from None
    try:
        client = Client(address, timeout=TIMEOUT)
    except (OSError, ValueError) as error:
        raise BrdfkitError(
            f"{address}: no Dask scheduler answers there ({str(error).splitlines()[0]}); start one "
            "by 'dask scheduler', and workers by 'dask worker ADDRESS'."
        ) from None
    with client:
        yield client
