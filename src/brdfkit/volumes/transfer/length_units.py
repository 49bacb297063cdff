"""Units of length, by the names that files give them."""

METRES = {
    "m": 1.0,
    "cm": 1e-2,
    "mm": 1e-3,
    **dict.fromkeys(("µm", "μm", "um", "micron", "microns"), 1e-6),
    "nm": 1e-9,
}


def ratio(unit, other):
    """How many of the `other` unit one `unit` is; None where one of them is unknown.

    >>> ratio("mm", "µm")
    1000.0
    """
    if unit == other:
        return 1.0
    if unit not in METRES or other not in METRES:
        return None
    return round(METRES[unit] / METRES[other], 12)
