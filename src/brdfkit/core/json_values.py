"""Converts results to the types that JSON has."""

import math
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np


def round_numbers(value: Any, digits: int) -> Any:
    """Round the floats in JSON data to a number of significant digits."""
    if isinstance(value, dict):
        return {key: round_numbers(v, digits) for key, v in value.items()}
    if isinstance(value, list):
        return [round_numbers(v, digits) for v in value]
    return float(f"{value:.{digits}g}") if isinstance(value, float) else value


def to_json(value: Any) -> Any:
    """Convert dataclasses, arrays and NumPy numbers to JSON's types; NaN and infinity to None."""
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
