"""Formats albedos for tables: the mean over the channels, marked if a fit's albedo is wrong."""

import math

from brdfkit.core.documents import Cell
from brdfkit.core.documents.parts import BAD
from brdfkit.regression.light import (
    LARGEST_ALBEDO,
    WRONG_FACTOR,
    Albedo,
    factor_between,
    format_share,
)

# Tables show all angles of an `Albedo` but the last, a grazing one that no measurement determines
ANGLES_SHOWN = 3
UNKNOWN = (math.nan,) * ANGLES_SHOWN


def mean_albedos(albedo: Albedo | None) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return the albedos of a fit and of its data at the angles shown, averaged over channels.

    They are nan where unknown, and in fits of earlier versions, whose `albedo` is None.
    """
    if albedo is None:
        return UNKNOWN, UNKNOWN
    fit, measured = (means[:ANGLES_SHOWN] for means in albedo.means())
    return fit, measured


def is_wrong(albedo: float, measured: float = math.nan) -> bool:
    """Return whether an albedo is above 1, or far from the measured one; False for nan."""
    return albedo > LARGEST_ALBEDO or factor_between(albedo, min(measured, 1.0)) > WRONG_FACTOR


def format_albedo(albedo: float) -> str:
    """Return an albedo as text; a dash for nan.

    >>> format_albedo(0.3521), format_albedo(0.01201)
    ('0.35', '0.012')
    """
    return "-" if math.isnan(albedo) else format_share(albedo)


def make_albedo_cell(albedo: float, measured: float = math.nan) -> Cell:
    """Return a table's cell with an albedo, marked if it is far from the `measured` one."""
    return Cell(format_albedo(albedo), BAD if is_wrong(albedo, measured) else "")


def describe_albedo(albedo: Albedo) -> str:
    """Return the albedos of a fit and its data in one line."""
    angles = ", ".join(f"{angle:g}°" for angle in albedo.theta_i[:ANGLES_SHOWN])
    fit, measured = (", ".join(map(format_albedo, means)) for means in mean_albedos(albedo))
    return f"albedo at {angles}: {fit}; measured: {measured}"
