"""Describes an error that a plugin's own code raised during a check: where, and what to do."""

import traceback
from pathlib import Path

# Words in an error of Dr.Jit's → what the plugin's author should write
HINTS = {
    "'bool'": "write dr.select in place of `if` on values",
    "'ndarray'": "write functions of dr in place of NumPy's",
}


def describe(error, path):
    """`error` in words: the plugin's file (`Path`) and the line that raised it, and the reason."""
    frames = traceback.extract_tb(error.__traceback__)
    lines = [f.lineno for f in frames if Path(f.filename) == path]
    place = f"{path.name}, line {lines[-1]}" if lines else path.name
    # Mitsuba puts a plugin's traceback into the message
    words = [line.strip() for line in str(error).splitlines() if line.strip()]
    reason = words[-1].rstrip(".") if words else type(error).__name__
    reason = reason.removeprefix("BrdfkitError: ")
    hint = "".join(f"{hint}: " for word, hint in HINTS.items() if word in reason)
    return f"{place}: {hint}{reason}"
