"""Runs the program `brdfkit`, as `python -m brdfkit` where it is not on the PATH."""

import os
import signal
import sys
from types import FrameType


def main(name: str | None = None) -> None:
    """Run the command line, whose usage calls the program `name`.

    Ctrl-C while the commands are imported ends the program at once, without a traceback.
    """
    # The threads of NumPy's OpenBLAS sleep as soon as they have nothing to do. By default they spin
    # for some 25 ms after each product, which is a sixth of the processor time of a small fit
    os.environ.setdefault("OPENBLAS_THREAD_TIMEOUT", "4")
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _exit_interrupted)
    from brdfkit.cli import main as run

    if signal.getsignal(signal.SIGINT) is _exit_interrupted:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    sys.exit(run(prog_name=name))


def _exit_interrupted(number: int, _frame: FrameType | None) -> None:
    """End the program with the message and the status of a command that Ctrl-C ended."""
    os.write(2, b"brdfkit: interrupted.\n")  # to standard error, which `print` may be using
    os._exit(128 + number)


if __name__ == "__main__":
    main("python -m brdfkit")
