"""A measured BRDF, looked up: a table over half/difference coordinates (MERL's cells).

    {"type": "measured_table", "filename": "gold-metallic-paint.binary"}

takes any file that `brdfkit.load` reads, looked for beside the scene's own as a bitmap is;
`Measured.scene_dict()` hands over its table directly. Multilinear between the cells' centres, the
azimuths wrap; isotropic, or with the azimuth phi_h.
In spectral variants measured wavelengths stay what they are, and colours become smooth spectra.

Sampled by a table of the half vectors that the material itself has, and a share of cosine. The
diffuse reflectance (as in an albedo image) is the albedo at the incidence: nobody can tell which
part of a measurement is diffuse.
"""

import os
from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.errors import BrdfkitError
from brdfkit.geometry.vectors import above_horizon
from brdfkit.host.channels import channels
from brdfkit.host.frame import COSINE, COSINE_SHARE, frame
from brdfkit.host.half_vector_table import Tabulated
from brdfkit.host.table_lookup import corners
from brdfkit.samples import Table

# The table of half vectors; more would take seconds
ANISOTROPIC = {"azimuths": 24, "angles": 16, "cells": (60, 32), "points": 1}


def define(mi):
    """The class of `mi.BSDF` for the current variant."""

    class MeasuredTable(frame(mi)):
        def __init__(self, props):
            super().__init__(props)
            self.table, wavelengths = _table(mi, props)
            filled = self.table.filled
            self.values = channels(filled.reshape(-1, filled.shape[-1]), wavelengths)
            size = ANISOTROPIC if self.table.anisotropic else {}
            self.sampling = Tabulated(self.brdf, **size)
            self.albedo = channels(self.sampling.albedo, wavelengths)

            flags = mi.BSDFFlags
            anisotropic = flags.Anisotropic if self.table.anisotropic else flags.Empty
            self.m_components = [flags.GlossyReflection | flags.FrontSide | anisotropic]
            self.m_flags = self.m_components[0]

        def brdf(self, wi, wo):
            """What `value` looks up, in NumPy: negative cells count, a negative sum is 0."""
            return np.maximum(self.table.eval(wi, wo), 0)

        def at(self, ctx, si, wi, active):
            return Point(mi, self, si, wi, ctx.is_enabled(mi.BSDFFlags.GlossyReflection, 0))

        def eval_diffuse_reflectance(self, si, active=True):
            wi, active = above_horizon(si.wi, active)
            albedo = self.albedo.mean(self.sampling.mixed(wi), si)
            return mi.Spectrum(dr.select(active, albedo, 0))

        def to_string(self):
            return f"MeasuredTable[shape = {self.table.shape}]"

    return MeasuredTable


@dataclass(frozen=True, eq=False)
class Point:
    """The table at a point, seen from `wi`; `enabled`: whether the context asks for it."""

    mi: Any
    bsdf: Any
    si: Any
    wi: Any
    enabled: bool

    def draw(self, sample1, sample2):
        """An outgoing direction, and the number of the one component."""
        by_cosine = COSINE.sample(self.wi, sample2)
        by_table = self.bsdf.sampling.sample(self.wi, sample2)
        return dr.select(sample1 < COSINE_SHARE, by_cosine, by_table), self.mi.UInt32(0)

    def pdf(self, wo):
        """Density of `draw` per solid angle."""
        if not self.enabled:
            return self.mi.Float(0)
        pdf = COSINE_SHARE * COSINE.pdf(self.wi, wo)
        return pdf + (1 - COSINE_SHARE) * self.bsdf.sampling.pdf(self.wi, wo)

    def value(self, wo):
        """BRDF, looked up."""
        if not self.enabled:
            return self.mi.UnpolarizedSpectrum(0)
        return self.bsdf.values.mean(corners(self.bsdf.table, self.wi, wo), self.si)


def _table(mi, props):
    """The table, and its wavelengths [nm] where the variant is spectral and they are known."""
    if "filename" in props:
        from brdfkit.loading import load  # only here: listing the plugins should be quick

        props = load(_located(mi, props["filename"])).scene_dict()
    if "table" not in props:
        raise BrdfkitError("measured_table needs a filename (or the tensor table).")
    period = props.get("phi_d_period", np.pi)
    wavelengths = np.array(props["wavelengths"]) if "wavelengths" in props else None
    return Table(np.array(props["table"], float), float(period)), wavelengths


def _located(mi, name):
    """The file of that name as the scene finds it, beside its own; other names as they are."""
    file, hash_sign, sample = name.rpartition("#")
    for path, rest in ((name, ""), (file, hash_sign + sample)):
        found = str(mi.file_resolver().resolve(path))
        if os.path.isfile(found):
            return found + rest
    return name
