"""Results as plain data, for JSON."""

import math
from dataclasses import fields, is_dataclass

import numpy as np


def round_numbers(value, digits):
    """JSON's types with numbers of so many digits."""
    if isinstance(value, dict):
        return {key: round_numbers(v, digits) for key, v in value.items()}
    if isinstance(value, list):
        return [round_numbers(v, digits) for v in value]
    return float(f"{value:.{digits}g}") if isinstance(value, float) else value


def to_json(value):
    """`value` in JSON's types: NumPy's numbers as Python's, numbers that are not finite as null."""
    if is_dataclass(value):
        value = {f.name: getattr(value, f.name) for f in fields(value)}
    if isinstance(value, dict):
        return {str(key): to_json(v) for key, v in value.items()}
    if isinstance(value, list | tuple):
        return [to_json(v) for v in value]
    if isinstance(value, np.ndarray | np.generic):
        return to_json(value.tolist())
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return value if isinstance(value, str | int | None) else str(value)
