"""`GgxSum`: a diffuse term and highlights of `ggx`, the form that most renderers hold exactly.

    f = k_d / π + Σ_j D_j G₂_j / (4 (N·L)(N·V)) [k₀_j + (k₉₀_j - k₀_j) (1 - V·H)⁵]

k_d, k₀ and k₉₀ are colours in linear sRGB; D_j and G₂_j have the widths α_u and α_v. The models
`lambert` and `ggx` have this form, with both kinds of its option `fresnel`, and so have their sums.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from brdfkit.model import Model, labels

Colour = tuple[float, float, float]
BLACK: Colour = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class GgxLobe:
    """One highlight: the widths along x and y, and the strengths at normal and grazing incidence.

    `alpha_u`, `alpha_v`: widths of the slopes, above 0; `f0`, `f90`: colours k₀ and k₉₀ in linear
    sRGB, at least 0.
    """

    alpha_u: float
    alpha_v: float
    f0: Colour
    f90: Colour

    @property
    def is_anisotropic(self) -> bool:
        """Whether the highlight is elliptic."""
        return self.alpha_u != self.alpha_v


@dataclass(frozen=True)
class GgxSum:
    """A diffuse term and highlights; `diffuse` is its albedo k_d, a colour in linear sRGB."""

    diffuse: Colour
    lobes: tuple[GgxLobe, ...]

    @property
    def is_anisotropic(self) -> bool:
        """Whether a highlight is elliptic, so that the tangent of the surface matters."""
        return any(lobe.is_anisotropic for lobe in self.lobes)

    def to_model(self) -> Model:
        """Return the material as a model: `lambert`, `ggx:fresnel=coloured` or a sum of these."""
        part = "ggx:fresnel=coloured"
        names = "+".join([part] * len(self.lobes)) or "lambert"
        values: dict[str, Any] = {"diffuse_reflectance": self.diffuse}
        for number, lobe in enumerate(self.lobes, 1):
            prefix = f"ggx_{number}_" if len(self.lobes) > 1 else ""
            widths = {"alpha_u": lobe.alpha_u, "alpha_v": lobe.alpha_v}
            strengths = {"f0_reflectance": lobe.f0, "f90_reflectance": lobe.f90}
            values |= {prefix + name: value for name, value in (widths | strengths).items()}
        return labels.model(names)(**values)

    def without_black_lobes(self) -> GgxSum:
        """Return the material without highlights whose strengths are 0."""
        return replace(self, lobes=tuple(j for j in self.lobes if any(j.f0) or any(j.f90)))


def to_ggx_sum(model: Model) -> GgxSum | None:
    """Return a model with linear sRGB weights as a `GgxSum`, or None if it has another form.

    >>> to_ggx_sum(labels.model("lambert")(diffuse_reflectance=0.5))
    GgxSum(diffuse=(0.5, 0.5, 0.5), lobes=())
    >>> to_ggx_sum(labels.model("ward")()) is None
    True
    """
    parts = _list_parts(model)
    if any(name not in ("lambert", "ggx") for name, _ in parts):
        return None
    diffuse = to_colour(getattr(model, "diffuse_reflectance", 0.0))
    lobes = tuple(_to_lobe(model, prefix) for name, prefix in parts if name == "ggx")
    return GgxSum(diffuse, lobes).without_black_lobes()


def _list_parts(model: Model) -> list[tuple[str, str]]:
    """Return the type of each model of a sum, and the prefix of its parameters."""
    if model.type_name() != "mixture":
        return [(model.type_name(), "")]
    summands: Any = type(model)
    return [(part.type_name(), prefix) for prefix, part, _ in summands.list_summands()]


def _to_lobe(model: Model, prefix: str) -> GgxLobe:
    """Return the highlight of a `ggx` whose parameters begin with `prefix`."""
    values = {name: getattr(model, prefix + name, None) for name in ("alpha_u", "alpha_v")}
    if prefix + "f0" in model.parameters:
        f90 = to_colour(getattr(model, prefix + "specular_reflectance"))
        f0 = to_colour(np.multiply(f90, getattr(model, prefix + "f0")))
    else:
        f0 = to_colour(getattr(model, prefix + "f0_reflectance"))
        f90 = to_colour(getattr(model, prefix + "f90_reflectance"))
    return GgxLobe(**{name: float(value or 0) for name, value in values.items()}, f0=f0, f90=f90)


def to_colour(value: Any) -> Colour:
    """Return a weight, a number or one for each of R, G, B, as a colour."""
    red, green, blue = np.broadcast_to(np.asarray(value, float), 3).tolist()
    return red, green, blue
