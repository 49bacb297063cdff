"""Adaptive parameterisation: a measured BRDF of the RGL database, looked up as its file stores it.

    {"type": "measured_adaptive", "filename": "paper_white_rgb.bsdf"}

takes a `.bsdf` file, also one beside the scene's file, as for a bitmap; `Measured.scene_dict()`
passes the arrays of its file directly. The BRDF is that of Mitsuba's own `measured`, but in every
variant, for files with colours and with spectra. In spectral variants measured wavelengths are
kept, and colours become smooth spectra. Negative values, of colours out of gamut, become 0.

A file stores f cosθ_o, finite up to the horizon, over a unit square that is warped to the normals
that are visible from wi. Directions are drawn by the file's luminance over the square and this
warp; a fiftieth of them are drawn by the cosine, as either may be 0. The diffuse reflectance (as in
an albedo image) is the albedo, linear between the file's incidences: nobody can tell which part of
a measurement is diffuse.

[Dupuy & Jakob 2018]; https://rgl.epfl.ch/materials
"""

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.mitsuba_bridge.bsdf.adaptive_lookup import AdaptiveLookup
from brdfkit.mitsuba_bridge.bsdf.measured_base import measured_frame
from brdfkit.mitsuba_bridge.channels import channels
from brdfkit.mitsuba_bridge.properties.conversions import resolve_file

ARRAYS = "phi_i", "theta_i", "ndf", "sigma", "vndf", "density"
FLAGS = "isotropic", "parts", "divided"
COSINE_SHARE = 0.02


def define(mi):
    """The class of `mi.BSDF` for the current variant."""

    class MeasuredAdaptive(measured_frame(mi)):
        def __init__(self, props):
            super().__init__(props)
            props = _read(props)
            arrays = {name: np.array(props[name], np.float32) for name in ARRAYS}
            self.lookup = AdaptiveLookup(**arrays, **{name: props[name] for name in FLAGS})
            wavelengths = np.array(props["wavelengths"]) if "wavelengths" in props else None
            self.values, self.albedos = (
                channels(np.array(props[name]).reshape(-1, props[name].shape[-1]), wavelengths)
                for name in ("values", "albedo")
            )
            self.draw_by(self.lookup, not props["isotropic"], COSINE_SHARE)
            self.shape = props["values"].shape

        def brdf(self, wi, wo, si):
            return self.values.mean(self.lookup.corners(wi, wo), si)

        def albedo(self, wi, si):
            return self.albedos.mean(self.lookup.incidences(wi), si)

        def to_string(self):
            return f"MeasuredAdaptive[shape = {self.shape}]"

    return MeasuredAdaptive


def _read(props):
    """The arrays and flags of an RGL file: `props`, or those of the file that they name."""
    if "filename" in props:
        from brdfkit.materials.loading import load  # only here: listing the plugins should be quick

        name, props = props["filename"], load(resolve_file(props["filename"])).scene_dict()
        if "density" not in props:
            raise BrdfkitError(f"{name} is no RGL file; give it to measured_table.")
    if "density" not in props:
        raise BrdfkitError("measured_adaptive needs a filename.")
    return props
