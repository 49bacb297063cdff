"""Formats the albedos of fits for tables, with a mark on those that are wrong."""

import math

from brdfkit.core.documents import Cell
from brdfkit.core.documents.parts import BAD
from brdfkit.regression.albedo import (
    LARGEST_ALBEDO,
    WRONG_FACTOR,
    Albedo,
    compute_factor_between,
    format_light_share,
)

# Tables show only the first angles of an `Albedo`: few measurements determine the last, grazing one
ANGLES_SHOWN = 3
UNKNOWN = (math.nan,) * ANGLES_SHOWN


def average_albedos_over_channels(
    albedo: Albedo | None,
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return the albedos of a fit and of its data, averaged over channels, for a row of a table.

    There is one value for each of the first `ANGLES_SHOWN` angles of incidence, NaN where it is
    unknown. Fits that earlier versions saved have the `albedo` None; all their values are NaN.
    """
    if albedo is None:
        return UNKNOWN, UNKNOWN
    fit, measured = (means[:ANGLES_SHOWN] for means in albedo.average_channels())
    return fit, measured


def is_wrong_albedo(albedo: float, measured: float = math.nan) -> bool:
    """Return whether an albedo is above 1 or far from the `measured` one; False if it is NaN."""
    return (
        albedo > LARGEST_ALBEDO or compute_factor_between(albedo, min(measured, 1.0)) > WRONG_FACTOR
    )


def format_albedo(albedo: float) -> str:
    """Return an albedo as text, or a dash if it is NaN.

    >>> format_albedo(0.3521), format_albedo(0.01201)
    ('0.35', '0.012')
    """
    return "-" if math.isnan(albedo) else format_light_share(albedo)


def make_albedo_cell(albedo: float, measured: float = math.nan) -> Cell:
    """Return a cell for a table with an albedo, marked as bad if `is_wrong_albedo` says so."""
    return Cell(format_albedo(albedo), BAD if is_wrong_albedo(albedo, measured) else "")


def describe_albedo(albedo: Albedo) -> str:
    """Return a line of text with the albedos of a fit and of its data at a few angles."""
    angles = ", ".join(f"{angle:g}°" for angle in albedo.theta_i[:ANGLES_SHOWN])
    fit, measured = (
        ", ".join(map(format_albedo, means)) for means in average_albedos_over_channels(albedo)
    )
    return f"albedo at {angles}: {fit}; measured: {measured}"
