"""What is checked: a material with its Mitsuba BSDF; and how a check says what it found."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from brdfkit.geometry.directions import from_angles
from brdfkit.measured import Measured
from brdfkit.model import Model

# Incidence of every statistical check [degrees], up to grazing, at an azimuth off the axes
INCIDENCES = (0, 30, 60, 75, 85)
AZIMUTH = 0.5

checks: dict[str, Any] = {}


@dataclass(frozen=True)
class Finding:
    """What one check found: whether it passed, and the figure by which."""

    check: str
    passed: bool
    figure: str


def checked(function):
    """Make `function(subject) -> (passed, figure)` a check, named as the function."""
    checks[function.__name__.replace("_", " ")] = function
    return function


@dataclass(frozen=True, eq=False)
class Subject:
    """Anything with `.eval(wi, wo)` and `.scene_dict()`: a model, a fit, a measured material."""

    thing: Any

    @property
    def model(self):
        """The `Model` with its values, None for a measured material."""
        model = getattr(self.thing, "model", self.thing)
        return model if isinstance(model, Model) else None

    @cached_property
    def formula(self):
        """What the BSDF should compute: anything with `.eval(wi, wo)`.

        That of samples is a table of what `eval` finds between them.
        """
        if isinstance(self.thing, Measured) and not self.thing.is_table:
            table = self.thing.rgb.table
            channels = self.thing.rgb.channels
            return Measured.from_table(table.values, table.phi_d_period, channels)
        return self.thing

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
        return si

    def plugin_eval(self, wi, wo):
        """BRDF times cosine (n, channels) of the Mitsuba BSDF, float32."""
        import mitsuba as mi

        wo = mi.Vector3f(np.asarray(wo, np.float32).T)
        value = self.bsdf.eval(mi.BSDFContext(), self.interaction(wi), wo)
        return np.array(value).T.astype(float)


def incidences():
    """(degrees, direction) of the incidences that are tested."""
    return [(degrees, from_angles(np.radians(degrees), AZIMUTH)) for degrees in INCIDENCES]


def random_pairs(n, seed, max_degrees=89.0):
    """Direction pairs, evenly over angles, so that grazing ones are not rare; half of them near
    the mirror direction, where lobes are."""
    rng = np.random.default_rng(seed)
    theta = rng.uniform(0, np.radians(max_degrees), (2, n))
    phi = rng.uniform(-np.pi, np.pi, (2, n))
    near = np.arange(n) % 2 == 0
    theta[1, near] = np.clip(theta[0] + rng.normal(0, 0.1, n), 0, np.radians(max_degrees))[near]
    phi[1, near] = (phi[0] + np.pi + rng.normal(0, 0.1, n))[near]
    return from_angles(theta[0], phi[0]), from_angles(theta[1], phi[1])
