"""Figures of matplotlib as files in memory."""

import io


def to_png(figure, dpi=100):
    """The bytes of a matplotlib `Figure` as a PNG."""
    png = io.BytesIO()
    figure.savefig(png, format="png", dpi=dpi)
    return png.getvalue()
