"""A measured BRDF, looked up: a table over half/difference coordinates (MERL's cells).

    {"type": "measured_table", "filename": "gold-metallic-paint.binary"}

takes any file that `brdfkit.load` reads, also one beside the scene's file, as for a bitmap;
`Measured.scene_dict()` passes its table directly. Values are interpolated multilinearly between the
cells' centres, and periodically in the azimuths. A table is isotropic, or has an axis for the
azimuth phi_h.
In spectral variants measured wavelengths are kept, and colours become smooth spectra.

Directions are drawn from a table of the material's own half vectors, and a share of them by the
cosine. The diffuse reflectance (as in an albedo image) is the albedo at the incidence: nobody can
tell which part of a measurement is diffuse.
"""

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.mitsuba_bridge.bsdf.half_vector_table import HalfVectorTable
from brdfkit.mitsuba_bridge.bsdf.measured_base import measured_frame
from brdfkit.mitsuba_bridge.bsdf.table_lookup import corners
from brdfkit.mitsuba_bridge.channels import channels
from brdfkit.mitsuba_bridge.properties.conversions import resolve_file
from brdfkit.model.samples import Table

# The size of the table of half vectors; a larger one would take seconds
ANISOTROPIC = {"azimuths": 24, "angles": 16, "cells": (60, 32), "points": 1}


def define(mi):
    """The class of `mi.BSDF` for the current variant."""

    class MeasuredTable(measured_frame(mi)):
        def __init__(self, props):
            super().__init__(props)
            self.table, wavelengths = _table(props)
            cells = self.table.filled_values
            self.values = channels(cells.reshape(-1, cells.shape[-1]), wavelengths)
            size = ANISOTROPIC if self.table.anisotropic else {}
            half_vectors = HalfVectorTable(self.look_up, **size)
            self.albedos = channels(half_vectors.albedo, wavelengths)
            self.draw_by(half_vectors, self.table.anisotropic)

        def look_up(self, wi, wo):
            """`brdf` in NumPy. Cells may be negative; a negative mean of cells becomes 0."""
            return np.maximum(self.table.eval(wi, wo), 0)

        def brdf(self, wi, wo, si):
            return self.values.mean(corners(self.table, wi, wo), si)

        def albedo(self, wi, si):
            return self.albedos.mean(self.sampling.incidences(wi), si)

        def to_string(self):
            return f"MeasuredTable[shape = {self.table.shape}]"

    return MeasuredTable


def example():
    """A table of brdfkit's own, for the checks."""
    from brdfkit.core import catalogue  # only here: listing the plugins should be quick

    return {"type": "measured_table", "filename": str(catalogue.path("plaster"))}


def _table(props):
    """The `Table`, and its wavelengths [nm], None where the channels are colours."""
    if "filename" in props:
        from brdfkit.materials.loading import load  # only here: listing the plugins should be quick

        measured = load(resolve_file(props["filename"]))
        props = getattr(measured, "tabulated", measured).scene_dict()
    if "table" not in props:
        raise BrdfkitError("measured_table needs a filename (or the tensor table).")
    period = props.get("phi_d_period", np.pi)
    wavelengths = np.array(props["wavelengths"]) if "wavelengths" in props else None
    return Table(np.array(props["table"], float), float(period)), wavelengths
