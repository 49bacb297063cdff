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

import numpy as np

# The table of half vectors; more would take seconds
ANISOTROPIC = {"azimuths": 24, "angles": 16, "cells": (60, 32), "points": 1}


def define(mi):
    """The class of `mi.BSDF` for the current variant."""
    import drjit as dr

    from brdfkit.errors import BrdfkitError
    from brdfkit.geometry.vectors import above_horizon
    from brdfkit.host import table_lookup
    from brdfkit.host.channels import channels
    from brdfkit.host.half_vector_table import Tabulated
    from brdfkit.model.lobes import Cosine
    from brdfkit.samples import Table

    COSINE, COSINE_SHARE = Cosine(), 0.1

    class MeasuredTable(mi.BSDF):
        def __init__(self, props):
            super().__init__(props)
            self.table, wavelengths = _table(props)
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
            """What `eval` looks up, in NumPy: negative cells count, a negative sum is 0."""
            return np.maximum(self.table.eval(wi, wo), 0)

        def sample(self, ctx, si, sample1, sample2, active=True):
            wi, active = above_horizon(si.wi, active)
            wo = dr.select(
                sample1 < COSINE_SHARE,
                COSINE.sample(wi, sample2),
                self.sampling.sample(wi, sample2),
            )
            value, pdf = self.value(ctx, si, wo, active), self.pdf(ctx, si, wo, active)
            active &= pdf > 0

            sample = dr.zeros(mi.BSDFSample3f)
            sample.wo = wo
            sample.pdf = dr.select(active, pdf, 0)
            sample.eta = 1.0
            sample.sampled_type = int(mi.BSDFFlags.GlossyReflection)
            weight = dr.select(active, value / dr.select(active, pdf, 1), 0)
            return sample, mi.depolarizer(weight)

        def eval(self, ctx, si, wo, active=True):
            return mi.depolarizer(self.value(ctx, si, wo, active))

        def value(self, ctx, si, wo, active):
            """BRDF times cosine, unpolarised."""
            active &= ctx.is_enabled(mi.BSDFFlags.GlossyReflection, 0)
            wi, active = above_horizon(si.wi, active)
            wo, active = above_horizon(wo, active)
            value = self.values.mean(table_lookup.corners(self.table, wi, wo), si)
            return dr.select(active, value * wo.z, 0)

        def pdf(self, ctx, si, wo, active=True):
            active &= ctx.is_enabled(mi.BSDFFlags.GlossyReflection, 0)
            wi, active = above_horizon(si.wi, active)
            wo, active = above_horizon(wo, active)
            pdf = COSINE_SHARE * COSINE.pdf(wi, wo)
            pdf += (1 - COSINE_SHARE) * self.sampling.pdf(wi, wo)
            return dr.select(active, pdf, 0)

        def eval_pdf(self, ctx, si, wo, active=True):
            return self.eval(ctx, si, wo, active), self.pdf(ctx, si, wo, active)

        def eval_diffuse_reflectance(self, si, active=True):
            wi, active = above_horizon(si.wi, active)
            albedo = self.albedo.mean(self.sampling.mixed(wi), si)
            return mi.Spectrum(dr.select(active, albedo, 0))

        def to_string(self):
            return f"MeasuredTable[shape = {self.table.shape}]"

    def _table(props):
        """The table, and its wavelengths [nm] where the variant is spectral and they are known."""
        if "filename" in props:
            from brdfkit.formats import load

            props = load(_located(props["filename"])).scene_dict()
        if "table" not in props:
            raise BrdfkitError("measured_table needs a filename (or the tensor table).")
        period = props.get("phi_d_period", np.pi)
        wavelengths = np.array(props["wavelengths"]) if "wavelengths" in props else None
        return Table(np.array(props["table"], float), float(period)), wavelengths

    def _located(name):
        """The file of that name as the scene finds it, beside its own; other names as they are."""
        file, hash_sign, sample = name.rpartition("#")
        for path, rest in ((name, ""), (file, hash_sign + sample)):
            found = str(mi.file_resolver().resolve(path))
            if os.path.isfile(found):
                return found + rest
        return name

    return MeasuredTable
