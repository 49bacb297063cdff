"""Memory of `brdfkit view` while random actions change the view.

python benchmarks/view_memory.py [SECONDS] [SIDE]

The volume is `smoke` with SIDE³ voxels, by default 64³. Each action is a message as the page sends
it: a drag, a slider, a choice, another size, undo. Every 10 seconds a line says how many actions
there were, how much memory the process has, and how many kernels were compiled or read so far.
"""

import random
import sys
import time
from typing import Any

import psutil

import brdfkit as bk
from brdfkit.viewing.controls import Control
from brdfkit.viewing.session import Session
from brdfkit.viewing.volumes.application import VolumeApplication

SECONDS, SIDE = 120, 64
INTERVAL = 10  # seconds between two lines
DRAG = 8  # pictures of a drag
SIZES = 256, 320, 384, 512


def draw_value(control: Control, dice: random.Random) -> Any:
    """Return a random value of a control."""
    if control.kind == "choice":
        return dice.choice(control.choices)[0]
    if control.kind == "flag":
        return dice.random() < 0.5
    if control.kind == "colour":
        return f"#{dice.randrange(1 << 24):06x}"
    if control.log:
        return control.low * (control.high / control.low) ** dice.random()
    return dice.uniform(control.low, control.high)


def draw_messages(session: Session, dice: random.Random) -> list[dict[str, Any]]:
    """Return the messages of a random action."""
    kind = dice.choice(["drag", "drag", "set", "set", "set", "resize", "undo", "redo", "reset"])
    if kind == "resize":
        return [{"type": kind, "width": dice.choice(SIZES), "height": dice.choice(SIZES)}]
    if kind in ("undo", "redo", "reset"):
        return [{"type": kind}]
    control = dice.choice(list(session.application.states.controls.values()))
    values = [draw_value(control, dice) for _ in range(DRAG if kind == "drag" else 1)]
    messages = [{"type": "set", "changes": {control.name: v}, "moving": True} for v in values]
    return [*messages[:-1], messages[-1] | {"moving": False}]


def act(session: Session, dice: random.Random) -> None:
    """Do a random action, and render as many pictures as the page would show."""
    for message in draw_messages(session, dice):
        session.handle(message)
        if session.has_work():
            session.work()
        session.handle({"type": "shown", "number": session.number})


def main() -> None:
    """Print a line every `INTERVAL` seconds."""
    import drjit as dr  # after brdfkit, which chooses LLVM

    numbers = [int(word) for word in sys.argv[1:]]
    seconds, side = [*numbers, SECONDS, SIDE][:2] if len(numbers) != 1 else (numbers[0], SIDE)
    session = Session(VolumeApplication(bk.volumes.load("smoke", size=side), "smoke"))
    session.handle({"type": "hello", "width": 512, "height": 512, "state": None})
    dice, process = random.Random(0), psutil.Process()
    start, actions, kernels = time.monotonic(), 0, 0
    with dr.scoped_set_flag(dr.JitFlag.KernelHistory, True):
        for line in range(seconds // INTERVAL):
            while time.monotonic() - start < (line + 1) * INTERVAL:
                dr.kernel_history_clear()
                act(session, dice)
                actions += 1
                history = dr.kernel_history((dr.KernelType.JIT,))
                kernels += sum(not kernel["cache_hit"] for kernel in history)
            passed, memory = time.monotonic() - start, process.memory_info().rss / 1e6
            print(f"{passed:5.0f} s: {actions:6d} actions, {memory:6.0f} MB, {kernels:5d} kernels")


if __name__ == "__main__":
    main()
