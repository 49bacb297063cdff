"""Gives a value the derivatives of another one."""

from typing import Any

import drjit as dr

from brdfkit.core.array_types import JitColour


def replace_grad(value: JitColour, source: JitColour) -> Any:
    """Return the array `value` with the derivatives of `source`, as `dr.replace_grad` does.

    Dr.Jit's type stub wrongly declares that its function returns None. Neither may be a plain
    number, as in Mitsuba's scalar variants: Dr.Jit crashes.
    """
    replace: Any = dr.replace_grad
    return replace(value, source)
