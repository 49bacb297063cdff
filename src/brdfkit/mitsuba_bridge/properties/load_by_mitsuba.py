"""Loads scenes and plugins by Mitsuba; what it refuses becomes one sentence."""

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import is_utf8
from brdfkit.core.jit.threads import two_threads

OURS = "BrdfkitError: "


def load_by_mitsuba(function, source, name):
    """The object that a `function` of Mitsuba's, such as `load_dict`, makes of `source`.

    Raises `BrdfkitError`, which names it `name`, where Mitsuba cannot; a sentence of a plugin of
    ours stands for itself.
    """
    if isinstance(source, str) and not is_utf8(source):
        raise BrdfkitError(f"{name}: its path is no UTF-8, as Mitsuba needs it; rename the file.")
    try:
        with two_threads():
            return function(source, parallel=False)
    except (MemoryError, IndexError, OverflowError) as error:  # of a size that no file has
        raise BrdfkitError(
            f"{name}: Mitsuba cannot load it: it states a size for which there is no memory."
        ) from error
    except BrdfkitError:
        raise
    except (RuntimeError, TypeError, ValueError) as error:
        said = str(error)
        if isinstance(error, UnicodeDecodeError):  # a damaged file's bytes are in the message
            said = error.object.decode(errors="replace")
        if "KeyboardInterrupt" in said:  # Ctrl-C in a plugin that is written in Python
            raise KeyboardInterrupt from None
        lines = [line.strip() for line in said.splitlines() if line.strip()]
        # a plugin written in Python reports its whole traceback: people need its last line only
        reason = lines[-1] if any("Traceback" in line for line in lines) else " ".join(lines)
        if OURS in reason:
            reason = reason.partition(OURS)[2]
            raise BrdfkitError(f"{name}: {reason.removeprefix(f'{name}: ')}") from error
        raise BrdfkitError(f"{name}: Mitsuba cannot load it ({reason.rstrip('.')}).") from error
