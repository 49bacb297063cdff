"""The subject of the checks of a material: its formula and its Mitsuba BSDF in the current variant.

Spectral variants are checked at fixed wavelengths. The expected values of a model there are its
lobes in double precision, times its weights as Mitsuba's textures give them at the wavelengths.
"""

import sys
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from brdfkit.checks.variants import WAVELENGTHS, columns, in_variant, weights_of
from brdfkit.core.geometry.directions import from_angles
from brdfkit.materials.measured import Measured
from brdfkit.mitsuba_bridge.bsdf.from_dictionary import BsdfMaterial
from brdfkit.model import Model
from brdfkit.model.evaluation import lobe_values

# Angles of incidence of every statistical check [degrees], and an azimuth off the axes
INCIDENCES = (0, 30, 60, 75, 85)
AZIMUTH = 0.5


@dataclass(frozen=True, eq=False)
class Subject:
    """Anything with `.eval(wi, wo)` and `.scene_dict()`: a model, a fit, a measured material, a
    BSDF of Mitsuba's."""

    thing: Any

    @property
    def model(self):
        """The `Model` with its values, None for a measured material."""
        model = getattr(self.thing, "model", self.thing)
        return model if isinstance(model, Model) else None

    @property
    def is_single(self):
        """Whether `values` come from a BSDF of Mitsuba's, in single precision."""
        return isinstance(self.thing, BsdfMaterial)

    @property
    def source(self):
        """The file of the model's class; in a notebook, the name of the class. None where there is
        no model."""
        if self.model is None:
            return None
        module = sys.modules[type(self.model).__module__]
        return Path(getattr(module, "__file__", None) or type(self.model).__name__)

    def values(self, wi, wo):
        """Expected BRDF values (n, channels of the variant), without cosine, in double precision.

        `wi`, `wo`: (n, 3), above the surface.
        """
        if isinstance(self.thing, Measured):
            return in_variant(self.rendered.eval(wi, wo), self.rendered)
        if self.model is None:
            return self.thing.eval(wi, wo)
        plain, squared = lobe_values(self.model, wi, wo)
        values = plain @ self.weights + squared @ self.weights**2
        return np.maximum(values, 0) if self.model.signed() else values

    @property
    def rendered(self):
        """The measured material as it is rendered in the current variant."""
        import mitsuba as mi

        return (self.thing if mi.is_spectral else self.thing.rgb).rendered

    @cached_property
    def weights(self):
        """The model's weights (lobes, channels of the variant)."""
        return weights_of(self.bsdf, self.model)

    @cached_property
    def bsdf(self):
        """The Mitsuba BSDF in the current variant."""
        import mitsuba as mi

        return mi.load_dict(self.thing.scene_dict(), parallel=False)

    def interaction(self, wi):
        """A surface interaction seen from directions `wi`, (3,) or (n, 3)."""
        import drjit as dr
        import mitsuba as mi

        wi = np.atleast_2d(np.asarray(wi, np.float32))
        si = dr.zeros(mi.SurfaceInteraction3f, len(wi))
        si.wi = mi.Vector3f(wi.T)
        si.sh_frame = mi.Frame3f([0, 0, 1])
        si.n = mi.Normal3f(0, 0, 1)
        if mi.is_spectral:
            si.wavelengths = WAVELENGTHS
        return si

    def plugin_eval(self, wi, wo):
        """BRDF times cosine (n, channels of the variant) of the Mitsuba BSDF, float32."""
        import mitsuba as mi

        wo = mi.Vector3f(np.asarray(wo, np.float32).T)
        value = self.bsdf.eval(mi.BSDFContext(), self.interaction(wi), wo)
        return columns(value, len(wi)).T


def incidences():
    """The angles of incidence that are checked, as a list of (degrees, direction)."""
    return [(degrees, from_angles(np.radians(degrees), AZIMUTH)) for degrees in INCIDENCES]


def random_pairs(n, seed, max_degrees=89.0):
    """Random direction pairs, two arrays (n, 3), uniform in the angles: many are grazing.

    Every second pair is near the mirror direction, where lobes are.
    """
    rng = np.random.default_rng(seed)
    theta = rng.uniform(0, np.radians(max_degrees), (2, n))
    phi = rng.uniform(-np.pi, np.pi, (2, n))
    near = np.arange(n) % 2 == 0
    theta[1, near] = np.clip(theta[0] + rng.normal(0, 0.1, n), 0, np.radians(max_degrees))[near]
    phi[1, near] = (phi[0] + np.pi + rng.normal(0, 0.1, n))[near]
    return from_angles(theta[0], phi[0]), from_angles(theta[1], phi[1])
