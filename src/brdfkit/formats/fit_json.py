"""A fit, as brdfkit saves it: JSON with the model, its values and how they were found."""

import json
from dataclasses import fields

import brdfkit
from brdfkit import registry
from brdfkit.errors import BrdfkitError
from brdfkit.fitting.result import Fit

NAME = "brdfkit fit"
SUFFIXES = (".json",)
KEY = "brdfkit"


def sniff(head):
    """JSON that begins with brdfkit's version."""
    return head.lstrip().startswith(b"{") and f'"{KEY}"'.encode() in head[:200]


def read(source):
    """The `Fit` that `write` wrote."""
    try:
        record = json.loads(source.data)
        model = record["model"]
        found = record["fit"]
        values = dict(record["parameters"])
        known = {f.name for f in fields(Fit)} - {"model"}
        rest = {name: found[name] for name in known if name in found}
    except (ValueError, KeyError, TypeError, RecursionError):
        raise source.error("is no fit that brdfkit saved, or is damaged; fit it again") from None
    try:
        for name in ("at_bounds", "notes"):
            rest[name] = tuple(rest.get(name, ()))
        return Fit(model=registry.model_with_values(model, values), **rest)
    except (BrdfkitError, TypeError) as error:
        raise source.error(f"cannot be restored ({str(error).rstrip('.')}); fit it again") from None


def write(fit, stream):
    """Write a `Fit` into a binary stream."""
    if not isinstance(fit, Fit):
        raise BrdfkitError(
            f"the format {NAME} holds a fit, not a {type(fit).__name__}; choose another suffix."
        )
    record = {
        KEY: brdfkit.__version__,
        "model": fit.model.label(),
        "parameters": fit.values,
        "fit": {f.name: getattr(fit, f.name) for f in fields(fit) if f.name != "model"},
    }
    stream.write(json.dumps(record, indent=2).encode() + b"\n")
