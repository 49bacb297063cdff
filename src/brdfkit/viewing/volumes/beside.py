"""Opens what is dropped beside a volume: environment maps, and transfer functions."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from brdfkit.viewing import kinds
from brdfkit.viewing.application import no_use_error

if TYPE_CHECKING:
    from brdfkit.viewing.application import Message
    from brdfkit.viewing.session import Session

    Application = Any  # `VolumeApplication`, which imports this file


def open_beside(application: Application, session: Session, kind: str, path: Path) -> list[Message]:
    """Open a file of a kind beside the volume; raise `BrdfkitError` if it has no use there."""
    if kind == kinds.ENVIRONMENT:
        return _open_environment(application, session, path)
    if kind == kinds.TRANSFER:
        return _open_transfer(application, session, path)
    raise no_use_error(path.name, "a mesh shows a material")


def _open_environment(application: Application, session: Session, path: Path) -> list[Message]:
    """Light the volume by an environment map; it replaces an older one of its name."""
    application.add_environment(path)
    session.change({"light.environment": path.name})
    session.forget_samples()
    return [session.describe_view()]


def _open_transfer(application: Application, session: Session, path: Path) -> list[Message]:
    """Show the volume with a transfer function, brdfkit's or the bumps of the program VPT."""
    bumps = read_vpt_bumps(path)
    if bumps is not None:
        session.change({"transfer.mode": "bumps2d", "transfer.bumps": bumps})
        return [session.describe_state()]
    application.states.functions.add(path)
    session.change({"transfer.preset": path.name})
    session.forget_samples()
    return [session.describe_view()]


def read_vpt_bumps(path: Path) -> list[dict[str, Any]] | None:
    """Read the bumps that the program VPT [Lesar 2018] saved, or None for another file.

    Such a file is a list of {position: {x, y}, size: {x, y}, color: {r, g, b, a}}, from 0 to 1.
    """
    try:
        records = json.loads(path.read_bytes())
        if not isinstance(records, list):
            return None
        return [
            {
                **{"x": r["position"]["x"], "y": r["position"]["y"]},
                **{"sx": r["size"]["x"], "sy": r["size"]["y"], "a": r["color"]["a"]},
                "colour": "#" + "".join(_to_hex(r["color"][c]) for c in "rgb"),
            }
            for r in records
        ]
    except (ValueError, RecursionError, TypeError, KeyError):
        return None


def _to_hex(component: float) -> str:
    """Return a colour's component as two hexadecimal digits; VPT keeps it from 0 to 1."""
    return f"{round(255 * min(max(component, 0), 1)):02x}"
