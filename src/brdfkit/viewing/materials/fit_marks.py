"""Describes a fit for the page: how good it is, and marks at the fitted values of the sliders."""

from __future__ import annotations

import re
from typing import Any

import numpy as np

from brdfkit.regression import Fit
from brdfkit.viewing.materials.audit_panel import to_greek
from brdfkit.viewing.materials.parameter_state import CHANNELS, PREFIX

# What notes tell scripts and commands to do; the page has no such control, or the audit has it
HINTS = re.compile(
    r"(; a constraint prevents it)?: AlbedoAtMost.*"
    r"|, which mirror_azimuth=True.* mends|; if they are, divide_by_cos=True.* mends them"
)


def describe_fit(fit: Fit | None) -> dict[str, Any]:
    """Return the message "fit": how good a fit is, and its values by the control's name.

    Without a fit the message is empty.
    """
    if fit is None:
        return {"type": "fit", "text": "", "notes": [], "marks": {}}
    seconds = f"{fit.seconds:.1f} s" if fit.seconds else ""
    texts = [f"{fit.loss_name} loss {fit.loss:.4g}", f"{fit.samples:,} samples", seconds]
    text = ", ".join(filter(None, texts))
    notes = [to_greek(HINTS.sub("", note)) for note in fit.notes]
    return {"type": "fit", "text": text, "notes": notes, "marks": make_marks(fit)}


def make_marks(fit: Fit) -> dict[str, list[float | None]]:
    """Return the fitted values and their standard errors, None if unknown, by control's name."""
    errors: dict[str, Any] = {} if fit.wavelengths else fit.standard_errors
    fitted = fit.rgb
    marks: dict[str, list[float | None]] = {}
    for name, parameter in fitted.parameters.items():
        value, error = getattr(fitted, name), errors.get(name, np.nan)
        if parameter.linear:
            pairs = zip(np.broadcast_to(value, 3), np.broadcast_to(error, 3), strict=True)
            named = {f"{name}.{c}": pair for c, pair in zip(CHANNELS, pairs, strict=True)}
        else:
            named = {name: (value, error)}
        for key, (number, own) in named.items():
            marks[PREFIX + key] = [float(number), float(own) if np.isfinite(own) else None]
    return marks
