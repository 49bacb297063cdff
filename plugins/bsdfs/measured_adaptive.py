"""Adaptive parameterisation: a measured BRDF of the RGL database, in the layout of its file.

    {"type": "measured_adaptive", "filename": "paper_white_rgb.bsdf"}

The plugin reads a `.bsdf` file, whose path may be relative to the scene's file;
`Measured.scene_dict()` passes the arrays of a file directly. The BRDF equals Mitsuba's own
`measured`, but is available in every variant, for files with colours and with spectra. In spectral
variants measured wavelengths are kept, and colours become smooth spectra. Negative values, which
come from colours out of gamut, become 0.

A file stores the BRDF f times cosθ_o, where θ_o is the angle between the outgoing direction and the
normal: this product stays finite up to the horizon. The values lie on a unit square, which is
warped to the normals that are visible from the incident direction. Outgoing directions are drawn by
the luminance on the square and this warp. A fiftieth of them are drawn in proportion to the cosine,
because the density of the others may be 0. Albedo images show the albedo, linear between the
incident directions of the file, because nobody can tell which part of a measurement is diffuse.

[Dupuy & Jakob 2018]; https://rgl.epfl.ch/materials
"""

from typing import Any

import numpy as np

from brdfkit.core.array_types import JitColour, JitVector, MitsubaModule, MitsubaObject
from brdfkit.core.errors import BrdfkitError
from brdfkit.mitsuba_bridge.bsdf.adaptive_lookup import AdaptiveLookup
from brdfkit.mitsuba_bridge.bsdf.measured_base import define_measured_bsdf
from brdfkit.mitsuba_bridge.channels import make_channels
from brdfkit.mitsuba_bridge.properties.conversions import resolve_file

ARRAYS = "phi_i", "theta_i", "ndf", "sigma", "vndf", "density"
FLAGS = "isotropic", "parts", "divided"
COSINE_SHARE = 0.02


def define(mi: MitsubaModule) -> type:
    """Return the plugin's class for Mitsuba's current variant: a `mi.BSDF`."""

    Base: MitsubaObject = define_measured_bsdf(mi)

    class MeasuredAdaptive(Base):
        def __init__(self, props: MitsubaObject) -> None:
            super().__init__(props)
            props = _read_rgl_arrays(props)
            stored: dict[str, Any] = {name: np.array(props[name], np.float32) for name in ARRAYS}
            self.lookup = AdaptiveLookup(**stored, **{name: props[name] for name in FLAGS})
            wavelengths = np.array(props["wavelengths"]) if "wavelengths" in props else None
            self.values, self.albedos = (
                make_channels(np.array(props[name]).reshape(-1, props[name].shape[-1]), wavelengths)
                for name in ("values", "albedo")
            )
            self.set_sampling(self.lookup, not props["isotropic"], COSINE_SHARE)
            self.shape = props["values"].shape

        def brdf(self, wi: JitVector, wo: JitVector, si: MitsubaObject) -> JitColour:
            return self.values.average_rows(self.lookup.find_corners(wi, wo), si)

        def albedo(self, wi: JitVector, si: MitsubaObject) -> JitColour:
            return self.albedos.average_rows(self.lookup.find_incidences(wi), si)

        def to_string(self) -> str:
            return f"MeasuredAdaptive[shape = {self.shape}]"

    return MeasuredAdaptive


def _read_rgl_arrays(props: MitsubaObject) -> MitsubaObject:
    """Return the arrays and flags of an RGL file: `props` itself, or read from its filename."""
    if "filename" in props:
        from brdfkit.materials.loading import load  # imported here, since the import is slow

        name, props = props["filename"], load(resolve_file(props["filename"])).scene_dict()
        if "density" not in props:
            raise BrdfkitError(f"{name} is no RGL file; give it to measured_table.")
    if "density" not in props:
        raise BrdfkitError("measured_adaptive needs a filename.")
    return props
