"""Quick exports: these tests are not about the quality of fits."""

import pytest

from brdfkit.exporting import hold, loss, tables
from brdfkit.exporting.targets import openmaterial, radiance
from brdfkit.materials.formats.rgl.encoding import Resolution


@pytest.fixture(autouse=True)
def few_values(monkeypatch):
    """Fits to few values, small balls, and tables of few cells."""
    monkeypatch.setattr(loss, "SIDE", 16)
    monkeypatch.setattr(hold, "TABLE_SHAPES", ((16, 8, 8), (6, 12, 6, 6)))
    monkeypatch.setattr(hold, "LOSS", "cbrt")
    monkeypatch.setattr(radiance, "DEPTHS", (4,))
    monkeypatch.setattr(radiance, "ANISOTROPIC_DEPTH", 3)
    monkeypatch.setattr(
        tables, "SIZES", (Resolution(0, 6, 1, 32, 16), Resolution(3, 5, 16, 32, 12))
    )
    monkeypatch.setattr(openmaterial, "THETA", (0, 30, 60, 85))
