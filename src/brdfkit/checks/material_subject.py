"""The subject of checks of a material: its formula and its Mitsuba BSDF in the current variant.

Spectral variants are checked at fixed wavelengths. There, the expected values of a model are its
lobes in double precision, times its weights from Mitsuba's textures at these wavelengths.
"""

import sys
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from brdfkit.checks.variants import (
    WAVELENGTHS,
    read_weights,
    to_channels,
    to_variant_channels,
)
from brdfkit.core.array_types import FloatArray, MitsubaObject
from brdfkit.core.geometry.directions import from_angles
from brdfkit.materials.measured import Measured
from brdfkit.mitsuba_bridge.bsdf.from_dictionary import BsdfMaterial
from brdfkit.model import Model
from brdfkit.model.evaluation import compute_lobe_values

# Angles of incidence of the statistical checks [degrees], and an azimuth [rad] beside the axes
INCIDENCES = (0, 30, 60, 75, 85)
AZIMUTH = 0.5


@dataclass(frozen=True, eq=False)
class Subject:
    """A material to check: a model, a fit, a measured material, or a BSDF of Mitsuba.

    `material`: any object with `eval(wi, wo)` and `scene_dict()`.
    """

    material: Any

    @property
    def model(self) -> Model | None:
        """The `Model` with its values, None for a measured material."""
        model = getattr(self.material, "model", self.material)
        return model if isinstance(model, Model) else None

    @property
    def is_single_precision(self) -> bool:
        """Whether `values` come from a BSDF of Mitsuba, in single precision."""
        return isinstance(self.material, BsdfMaterial)

    @property
    def source(self) -> Path | None:
        """The file of the model's class, or the name of a class that a notebook defines.

        None if there is no model.
        """
        if self.model is None:
            return None
        module = sys.modules[type(self.model).__module__]
        return Path(getattr(module, "__file__", None) or type(self.model).__name__)

    def values(self, wi: FloatArray, wo: FloatArray) -> FloatArray:
        """Return the expected BRDF (n, channels of the variant) [sr⁻¹], in double precision.

        `wi`, `wo`: directions (n, 3) above the surface.
        """
        if isinstance(self.material, Measured):
            return to_variant_channels(self.rendered.eval(wi, wo), self.rendered)
        if self.model is None:
            return self.material.eval(wi, wo)
        plain, squared = compute_lobe_values(self.model, wi, wo)
        values = plain @ self.weights + squared @ self.weights**2
        return np.maximum(values, 0) if self.model.has_signed_weights() else values

    @property
    def rendered(self) -> Measured:
        """The measured material as it is rendered in the current variant."""
        import mitsuba as mi

        return (self.material if mi.is_spectral else self.material.rgb).rendered

    @cached_property
    def weights(self) -> FloatArray:
        """The model's weights (lobes, channels of the variant)."""
        assert self.model is not None
        return read_weights(self.bsdf, self.model)

    @cached_property
    def bsdf(self) -> MitsubaObject:
        """The Mitsuba BSDF in the current variant."""
        import mitsuba as mi

        return mi.load_dict(self.material.scene_dict(), parallel=False)

    def interaction(self, wi: FloatArray) -> MitsubaObject:
        """Return a `mi.SurfaceInteraction3f` with the incident directions `wi`, (3,) or (n, 3)."""
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

    def plugin_eval(self, wi: FloatArray, wo: FloatArray) -> FloatArray:
        """Return BRDF times cosine (n, channels of the variant) of the Mitsuba BSDF, in float32."""
        import mitsuba as mi

        outgoing = mi.Vector3f(np.asarray(wo, np.float32).T)
        value = self.bsdf.eval(mi.BSDFContext(), self.interaction(wi), outgoing)
        return to_channels(value, len(wi)).T


def incidences() -> list[tuple[float, FloatArray]]:
    """Return the angles of incidence to check, as a list of (degrees, direction)."""
    return [(degrees, from_angles(np.radians(degrees), AZIMUTH)) for degrees in INCIDENCES]


def random_pairs(n: int, seed: int, max_degrees: float = 89.0) -> tuple[FloatArray, FloatArray]:
    """Return random pairs of directions, two arrays (n, 3), uniform in angles: many are grazing.

    Every second pair is close to a pair of mirror directions, where most lobes have their peak.
    """
    rng = np.random.default_rng(seed)
    theta = rng.uniform(0, np.radians(max_degrees), (2, n))
    phi = rng.uniform(-np.pi, np.pi, (2, n))
    near = np.arange(n) % 2 == 0
    theta[1, near] = np.clip(theta[0] + rng.normal(0, 0.1, n), 0, np.radians(max_degrees))[near]
    phi[1, near] = (phi[0] + np.pi + rng.normal(0, 0.1, n))[near]
    return from_angles(theta[0], phi[0]), from_angles(theta[1], phi[1])
