"""glTF: a ball with a metallic-roughness material and extensions of Khronos, as `.glb`.

The material is one of the model `gltf`, which other materials are fitted to. Viewers differ from
the formula: three.js adds light that facets scatter several times (a metal of the roughness 0.4 is
brighter by 4 % in the median), and approximates (1 - V·H)⁵ (7 % of a plastic's highlight at 50°).
Below a coloured highlight it darkens each channel of the diffuse term by its own F instead of by
the largest (a green felt whose F₀ is 0.25, 0.5, 0.04: 23 % more blue). x is the tangent along u.
"""

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from brdfkit.core.array_types import FloatArray
from brdfkit.exporting.filling import write_bytes
from brdfkit.exporting.glb import make_glb
from brdfkit.exporting.target import Held, Target
from brdfkit.model import Model
from brdfkit.model.microfacet import schlick

COAT_F0 = 0.04

# The validator wants tangents only where a texture needs them. This pixel keeps the strength of the
# anisotropy, and turns it by the angle of 128 from the middle, 127.5, which the material turns back
PIXEL, ANGLE = (255, 128, 255), math.atan2(128 / 255 * 2 - 1, 1)


@dataclass(frozen=True)
class Drawn:
    """A model `gltf` as viewers draw its file.

    A coat darkens the base by the direction of view alone. The model itself darkens it by the
    geometric mean for both directions, which is reciprocal. A coloured highlight darkens the
    diffuse term by its largest channel at all angles.
    """

    model: Any

    @property
    def name(self) -> str:
        """The name of the model."""
        return self.model.name

    def eval(self, wi: FloatArray, wo: FloatArray) -> NDArray[np.float64]:
        """Return the BRDF [sr⁻¹] (n, channels) for directions to light and viewer, (n, 3) each."""
        base = self.model.changed(clearcoat=0.0).eval(wi, wo)
        black = dict.fromkeys(("base_color", "metallic"), 0.0)
        if is_coloured(self.model):
            black = {"diffuse_color": 0.0}
            base = base + self._compute_change_of_diffuse_term(wi, wo)
        coat = self.model.changed(specular=0.0, **black).eval(wi, wo)
        passing = 1 - self.model.clearcoat * schlick(COAT_F0, wo[:, 2:])
        return np.asarray(base * passing + coat)

    def _compute_change_of_diffuse_term(self, wi: FloatArray, wo: FloatArray) -> FloatArray:
        """Return what a file's diffuse term is more than the model's, without a coat."""
        model = self.model
        share = (1 - np.linalg.norm(wi + wo, axis=1, keepdims=True) / 2) ** 5
        peak = np.max(model.specular_color)
        own = np.asarray(model.diffuse_color) * (1 - model.specular * share)
        drawn = compute_base_colour(model) * (1 - model.specular * (peak + (1 - peak) * share))
        return (drawn - own) / np.pi


def hold(model: Model) -> Held | None:
    """Return the model itself if it is `gltf`, with the coat of viewers."""
    if model.type_name() != "gltf":
        return None
    changes = ("the coat darkens the base by the view alone",) if model.clearcoat else ()
    if is_coloured(model):
        changes = (*changes, "a coloured highlight darkens the base a little otherwise")
    return Held(Drawn(model) if changes else model, model, changes)


def is_coloured(model: Any) -> bool:
    """Return whether a `gltf` has a coloured highlight in place of metalness."""
    return bool(model.highlights == "coloured")


def compute_base_colour(model: Any) -> FloatArray:
    """Return the base colour of a `gltf` with a coloured highlight, at most 1."""
    passing = 1 - model.specular * np.max(model.specular_color)
    colour = np.asarray(model.diffuse_color) / np.maximum(passing, 1e-6)
    return np.asarray(np.minimum(colour, 1.0))


def write(held: Held, path: Path, comment: list[str]) -> list[Path]:
    """Write the ball and its material."""
    pixel = PIXEL if held.content.anisotropy else None
    material = make_material(held.content, path.stem)
    return [write_bytes(path, make_glb(material, comment, pixel))]


def make_material(model: Any, name: str) -> dict[str, Any]:
    """Return the material of the file, without extensions that change nothing."""
    coloured = is_coloured(model)
    base_colour = compute_base_colour(model) if coloured else model.base_color
    extensions: dict[str, dict[str, Any]] = {}
    if coloured:  # the colour is a factor of F₀ = 0.04, that of the usual index 1.5
        factors = np.broadcast_to(model.specular_color, 3) / 0.04
        specular = {"specularFactor": model.specular, "specularColorFactor": factors.tolist()}
        extensions["KHR_materials_specular"] = specular
    else:
        if model.ior != 1.5 and model.specular > 0:
            extensions["KHR_materials_ior"] = {"ior": model.ior}
        if model.specular != 1 and model.metallic < 1:
            extensions["KHR_materials_specular"] = {"specularFactor": model.specular}
    if model.anisotropy:
        extensions["KHR_materials_anisotropy"] = {
            "anisotropyStrength": abs(model.anisotropy),
            "anisotropyRotation": math.pi / 2 * (model.anisotropy < 0) - ANGLE,
            "anisotropyTexture": {"index": 0},
        }
    if model.clearcoat:
        extensions["KHR_materials_clearcoat"] = {
            "clearcoatFactor": model.clearcoat,
            "clearcoatRoughnessFactor": model.clearcoat_roughness,
        }
    material: dict[str, Any] = {
        "name": name,
        "pbrMetallicRoughness": {
            "baseColorFactor": [*np.broadcast_to(base_colour, 3).tolist(), 1.0],
            "metallicFactor": 0.0 if coloured else model.metallic,
            "roughnessFactor": model.roughness,
        },
    }
    return material | ({"extensions": extensions} if extensions else {})


TARGET = Target(
    name="gltf",
    title="glTF 2.0: a ball for web pages and engines",
    suffix=".glb",
    holds={
        "diffuse": "Lambert × (1 - F)",
        "highlights": "`gltf`: one GGX, white or coloured, and a coat",
        "anisotropy": "yes",
        "else": "coat",
    },
    hold=hold,
    write=write,
    candidates=("gltf", "gltf:highlights=coloured"),
)
