"""Measured table: a measured BRDF, as a table over half and difference angles like MERL's.

    {"type": "measured_table", "filename": "gold-metallic-paint.binary"}

The plugin reads any file that `brdfkit.load` reads, whose path may be relative to the scene's file;
`Measured.scene_dict()` passes the table directly. Values are interpolated linearly along each axis
between the centres of the cells, and periodically in the azimuths. A table is isotropic, or has an
axis for the azimuth phi_h of the half vector. In spectral variants measured wavelengths are kept,
and colours become smooth spectra.

Outgoing directions are drawn from a table of half vectors, made for the material, and a share of
them in proportion to the cosine. Albedo images show the albedo at the angle of incidence, because
nobody can tell which part of a measurement is diffuse.
"""

from hashlib import blake2b
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray, JitColour, JitVector, MitsubaModule, MitsubaObject
from brdfkit.core.errors import BrdfkitError
from brdfkit.mitsuba_bridge.bsdf.half_vector_table import (
    HalfVectorTable,
    ReflectedShares,
    integrate_shares,
)
from brdfkit.mitsuba_bridge.bsdf.measured_base import define_measured_bsdf
from brdfkit.mitsuba_bridge.bsdf.table_lookup import find_corners
from brdfkit.mitsuba_bridge.channels import make_channels
from brdfkit.mitsuba_bridge.properties.conversions import resolve_file
from brdfkit.model.samples import Table

# Size of the table to draw half vectors of anisotropic materials; larger ones take seconds to make
ANISOTROPIC: dict[str, Any] = {"azimuths": 24, "angles": 16, "cells": (60, 32), "points": 1}
KEPT = 8  # number of materials whose shares are kept for the next scene; of one, 0.4 or 3 MB

_kept: dict[tuple[Any, ...], ReflectedShares] = {}


def define(mi: MitsubaModule) -> type:
    """Return the plugin's class for Mitsuba's current variant: a `mi.BSDF`."""

    Base: MitsubaObject = define_measured_bsdf(mi)

    class MeasuredTable(Base):
        def __init__(self, props: MitsubaObject) -> None:
            super().__init__(props)
            self.table, wavelengths = _read_table(props)
            cells = self.table.filled_values
            self.values = make_channels(cells.reshape(-1, cells.shape[-1]), wavelengths)
            shares = _find_shares(self.table)
            self.albedos = make_channels(shares.albedo, wavelengths)
            self.set_sampling(HalfVectorTable(shares), self.table.anisotropic)

        def brdf(self, wi: JitVector, wo: JitVector, si: MitsubaObject) -> JitColour:
            return self.values.average_rows(find_corners(self.table, wi, wo), si)

        def albedo(self, wi: JitVector, si: MitsubaObject) -> JitColour:
            return self.albedos.average_rows(self.sampling.find_incidences(wi), si)

        def to_string(self) -> str:
            return f"MeasuredTable[shape = {self.table.shape}]"

    return MeasuredTable


def example() -> dict[str, Any]:
    """Return a BSDF of plaster, a measured material that brdfkit includes, to test the plugin."""
    from brdfkit.core import catalogue  # imported here, since the import is slow

    return {"type": "measured_table", "filename": str(catalogue.find_material_file("plaster"))}


def _find_shares(table: Table) -> ReflectedShares:
    """Return the shares of light by which directions are drawn; integrate them only once."""
    values = np.ascontiguousarray(table.values)
    key = blake2b(values.data).digest(), values.shape, table.phi_d_period
    shares = _kept.get(key)
    if shares is None:
        if len(_kept) >= KEPT:
            _kept.pop(next(iter(_kept)), None)
        size = ANISOTROPIC if table.anisotropic else {}
        shares = integrate_shares(lambda wi, wo: np.maximum(table.eval(wi, wo), 0), **size)
        _kept[key] = shares
    return shares


def _read_table(props: MitsubaObject) -> tuple[Table, FloatArray | None]:
    """Read the `Table` and its wavelengths [nm], None for RGB channels, from the properties."""
    if "filename" in props:
        from brdfkit.materials.loading import load  # imported here, since the import is slow

        measured = load(resolve_file(props["filename"]))
        props = getattr(measured, "tabulated", measured).scene_dict()
    if "table" not in props:
        raise BrdfkitError("measured_table needs a filename (or the tensor table).")
    period = props.get("phi_d_period", np.pi)
    wavelengths = np.array(props["wavelengths"]) if "wavelengths" in props else None
    return Table(np.array(props["table"], float), float(period)), wavelengths
