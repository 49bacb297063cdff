"""The subject of the checks of a material: its formula, and its BSDF in Mitsuba's current variant.

Spectral variants are checked at fixed wavelengths. For a model, the expected values there are its
lobes in double precision, times the weights that Mitsuba's textures have at these wavelengths.
"""

import sys
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from brdfkit.checks.variants import (
    WAVELENGTHS,
    convert_to_variant_channels,
    read_weights,
    stack_channels,
)
from brdfkit.core.array_types import FloatArray, MitsubaObject
from brdfkit.core.geometry.directions import from_angles
from brdfkit.materials.measured import Measured
from brdfkit.mitsuba_bridge.bsdf.from_dictionary import BsdfMaterial
from brdfkit.model import Model
from brdfkit.model.evaluation import compute_fixed_values, compute_lobe_values

# Angles of incidence [degrees] of the statistical checks, and their azimuth [rad], off the axes
INCIDENCES = (0, 30, 60, 75, 85)
AZIMUTH = 0.5


@dataclass(frozen=True, eq=False)
class Subject:
    """A material to check: a model, a fit, a measured material, or a BSDF of Mitsuba.

    `material` is any object with the methods `eval(wi, wo)` and `scene_dict()`.
    """

    material: Any

    @property
    def model(self) -> Model | None:
        """The `Model` of the material or of the fit, None for a measured material."""
        model = getattr(self.material, "model", self.material)
        return model if isinstance(model, Model) else None

    @property
    def is_single_precision(self) -> bool:
        """Whether the expected values come from a BSDF of Mitsuba, in single precision."""
        return isinstance(self.material, BsdfMaterial)

    @property
    def source(self) -> Path | None:
        """The file that defines the model's class, None if there is no model.

        For a class that a notebook defines, it is the name of the class.
        """
        if self.model is None:
            return None
        module = sys.modules[type(self.model).__module__]
        return Path(getattr(module, "__file__", None) or type(self.model).__name__)

    def eval_expected(self, wi: FloatArray, wo: FloatArray) -> FloatArray:
        """Return the expected BRDF (n, channels) [sr⁻¹], computed without Mitsuba's BSDF.

        `wi` and `wo` are directions (n, 3) above the surface; the channels are those of Mitsuba's
        current variant.
        """
        if isinstance(self.material, Measured):
            return convert_to_variant_channels(self.rendered.eval(wi, wo), self.rendered)
        if self.model is None:
            return self.material.eval(wi, wo)
        plain, squared = compute_lobe_values(self.model, wi, wo)
        values = plain @ self.weights + squared @ self.weights**2
        values = values + compute_fixed_values(self.model, wi, wo)
        return np.maximum(values, 0) if self.model.has_signed_weights() else values

    @property
    def rendered(self) -> Measured:
        """The measured material in the form in which it is rendered in the current variant."""
        import mitsuba as mi

        return (self.material if mi.is_spectral else self.material.rgb).rendered

    @cached_property
    def weights(self) -> FloatArray:
        """The model's weights (lobes, channels) in the channels of the current variant."""
        assert self.model is not None
        return read_weights(self.bsdf, self.model)

    @cached_property
    def bsdf(self) -> MitsubaObject:
        """The BSDF that Mitsuba makes of the material in the current variant."""
        import mitsuba as mi

        return mi.load_dict(self.material.scene_dict(), parallel=False)

    def make_interaction(self, wi: FloatArray) -> MitsubaObject:
        """Make a `mi.SurfaceInteraction3f` with the incident directions `wi`, (3,) or (n, 3)."""
        import drjit as dr
        import mitsuba as mi

        wi = np.atleast_2d(np.asarray(wi, np.float32))
        si: MitsubaObject = dr.zeros(mi.SurfaceInteraction3f, len(wi))
        si.wi = mi.Vector3f(wi.T)
        si.sh_frame = mi.Frame3f(mi.Vector3f(0, 0, 1))
        si.n = mi.Normal3f(0, 0, 1)
        if mi.is_spectral:
            si.wavelengths = WAVELENGTHS
        return si

    def eval_plugin(self, wi: FloatArray, wo: FloatArray) -> FloatArray:
        """Return the BRDF times the cosine (n, channels), computed by Mitsuba's BSDF in float32."""
        import mitsuba as mi

        outgoing = mi.Vector3f(np.asarray(wo, np.float32).T)
        value = self.bsdf.eval(mi.BSDFContext(), self.make_interaction(wi), outgoing)
        return stack_channels(value, len(wi)).T


def list_incidences() -> list[tuple[float, FloatArray]]:
    """Return the incident directions of the checks, as a list of (degrees, direction (3,))."""
    return [(degrees, from_angles(np.radians(degrees), AZIMUTH)) for degrees in INCIDENCES]


def draw_direction_pairs(
    n: int, seed: int, max_degrees: float = 89.0
) -> tuple[FloatArray, FloatArray]:
    """Draw random pairs of directions, two arrays (n, 3), for comparing values of BRDFs.

    Polar angles are uniform, so that many directions are grazing. Every second pair is close to a
    pair of mirror directions, where most lobes have their peak.
    """
    rng = np.random.default_rng(seed)
    theta = rng.uniform(0, np.radians(max_degrees), (2, n))
    phi = rng.uniform(-np.pi, np.pi, (2, n))
    near = np.arange(n) % 2 == 0
    theta[1, near] = np.clip(theta[0] + rng.normal(0, 0.1, n), 0, np.radians(max_degrees))[near]
    phi[1, near] = (phi[0] + np.pi + rng.normal(0, 0.1, n))[near]
    return from_angles(theta[0], phi[0]), from_angles(theta[1], phi[1])
