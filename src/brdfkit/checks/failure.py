"""What to say where a check cannot run: a plugin's own lines went wrong."""

import traceback
from pathlib import Path

# What words of Dr.Jit mean to who writes a plugin
HINTS = {
    "'bool'": "no if on values, but dr.select",
    "'ndarray'": "no function of NumPy, but that of dr",
}


def described(error, path):
    """The line of the plugin's file (`Path`) where `error` came from, and its last words."""
    frames = traceback.extract_tb(error.__traceback__)
    lines = [f.lineno for f in frames if Path(f.filename) == path]
    place = f"{path.name}, line {lines[-1]}" if lines else path.name
    # Mitsuba puts a plugin's traceback into the message
    words = [line.strip() for line in str(error).splitlines() if line.strip()]
    reason = words[-1].rstrip(".") if words else type(error).__name__
    hint = "".join(f"{hint}: " for word, hint in HINTS.items() if word in reason)
    return f"{place}: {hint}{reason}"
