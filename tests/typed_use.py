"""The public names as a type checker sees them: `make lint` runs mypy over this file."""

from typing import assert_type

import brdfkit as bk


def everything() -> None:
    """Each verb once, with what it gives."""
    assert_type(bk.__version__, str)
