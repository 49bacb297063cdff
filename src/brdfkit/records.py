"""Results as plain data, for `--json` and for the tables."""

import math
from dataclasses import fields, is_dataclass

import numpy as np


def plain(value):
    """`value` as JSON knows it: NumPy's numbers as Python's, null for what is not finite."""
    if is_dataclass(value):
        value = {f.name: getattr(value, f.name) for f in fields(value)}
    if isinstance(value, dict):
        return {str(key): plain(v) for key, v in value.items()}
    if isinstance(value, list | tuple):
        return [plain(v) for v in value]
    if isinstance(value, np.ndarray | np.generic):
        return plain(value.tolist())
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return value if isinstance(value, str | int | None) else str(value)


def parameters(model):
    """The parameters of a model by name."""
    return {
        name: {
            "default": p.default,
            "bounds": p.bounds,
            "follows": p.follows,
            "linear": p.linear,
            "meaning": p.meaning,
        }
        for name, p in model.parameters.items()
    }


def choices(option):
    """The choices of an option in words."""
    if option.choices is None:
        return "any"
    if isinstance(option.default, int):
        return f"{min(option.choices)} to {max(option.choices)}"
    return ", ".join(map(str, option.choices))


def example(model, option):
    """The label of a model with another choice."""
    declared = model.options[option]
    if declared.choices is None:
        return declared.default
    after = declared.choices.index(declared.default) + 1
    other = declared.choices[after % len(declared.choices)]
    return f"{model.type_name()}:{option}={other}"


def audit(found, written):
    """What is in a measured material."""
    return {
        **{f.name: getattr(found, f.name) for f in fields(found) if f.name != "data"},
        "findings": found.findings(),
        "info": found.data.info,
        "written": written,
    }


def collection(found):
    """A public collection, with where its files lie or are to be had."""
    here = found.here()
    files = {
        name: {"file": listed.file, "bytes": listed.bytes or None, "url": listed.url or None}
        for name, listed in found.files.items()
    }
    for name, file in here.items():
        files.setdefault(name, {"file": file.name})["path"] = file
    texts = {f.name: getattr(found, f.name) for f in fields(found) if f.name != "files"}
    return {**texts, "folder": found.folder, "files": files}


def fit(found, comparison, psnr):
    """A fit, with its errors under every loss and the PSNR of its picture, if there is one."""
    return {
        "model": found.name,
        "parameters": found.values,
        "loss": found.loss_name,
        "error": found.loss,
        "errors": comparison.errors[found.name],
        "psnr": psnr.get(found.name),
        "at_bounds": found.at_bounds,
        "notes": found.notes,
        "evaluations": found.evaluations,
        "samples": found.samples,
        "seconds": found.seconds,
        "message": found.message,
    }


def report(checked):
    """What the checks of one material found."""
    findings = [
        {"check": f.check, "passed": bool(f.passed), "figure": f.figure} for f in checked.findings
    ]
    return {"name": checked.name, "passed": bool(checked), "findings": findings}
