"""Albedos as tables show them: the mean over the channels, with a mark where a fit's are wrong."""

import math

from brdfkit.core.documents import Cell
from brdfkit.core.documents.parts import BAD
from brdfkit.regression.light import ALL, WRONG, Albedo, factor_between, format_share

# How many angles of an `Albedo` are shown: all but the grazing one, which no measurement tells
SHOWN = 3
UNKNOWN = (math.nan,) * SHOWN


def mean_albedos(albedo: Albedo | None) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """The mean over the channels of the light of a fit, and of its data, at the angles shown.

    nan where it is not known; everywhere in fits of earlier versions, whose `albedo` is None.
    """
    if albedo is None:
        return UNKNOWN, UNKNOWN
    fit, measured = (means[:SHOWN] for means in albedo.means())
    return fit, measured


def is_wrong(albedo: float, measured: float = math.nan) -> bool:
    """Whether more light is reflected than arrives, or too much or little beside the measured.

    Of nan nothing is known to be wrong.
    """
    return albedo > ALL or factor_between(albedo, min(measured, 1.0)) > WRONG


def format_albedo(albedo: float) -> str:
    """An albedo as text; a dash for nan.

    >>> format_albedo(0.3521), format_albedo(0.01201)
    ('0.35', '0.012')
    """
    return "-" if math.isnan(albedo) else format_share(albedo)


def albedo_cell(albedo: float, measured: float = math.nan) -> Cell:
    """The cell of an albedo, marked where it is wrong beside the `measured` one."""
    return Cell(format_albedo(albedo), BAD if is_wrong(albedo, measured) else "")


def albedo_line(albedo: Albedo) -> str:
    """The light of a fit and its data in a line."""
    angles = ", ".join(f"{angle:g}°" for angle in albedo.theta_i[:SHOWN])
    fit, measured = (", ".join(map(format_albedo, means)) for means in mean_albedos(albedo))
    return f"albedo at {angles}: {fit}; measured: {measured}"
