"""glTF: a ball with a metallic-roughness material and extensions of Khronos, as `.glb`.

The material is one of the model `gltf`, which other materials are fitted to. Viewers differ from
the formula: three.js adds light that facets scatter several times (a metal of the roughness 0.4 is
brighter by 4 % in the median), and approximates (1 - V·H)⁵ (7 % of a plastic's highlight at 50°). x
is the tangent along u.
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
class CoatedBase:
    """A model `gltf` whose coat darkens the base by the direction of view alone, as viewers do.

    The model itself darkens it by the geometric mean for both directions, which is reciprocal.
    """

    model: Any

    @property
    def name(self) -> str:
        """The name of the model."""
        return self.model.name

    def eval(self, wi: FloatArray, wo: FloatArray) -> NDArray[np.float64]:
        """Return the BRDF [sr⁻¹] (n, channels) for directions to light and viewer, (n, 3) each."""
        base = self.model.changed(clearcoat=0.0).eval(wi, wo)
        coat = self.model.changed(base_color=0.0, metallic=0.0, specular=0.0).eval(wi, wo)
        passing = 1 - self.model.clearcoat * schlick(COAT_F0, wo[:, 2:])
        return np.asarray(base * passing + coat)


def hold(model: Model) -> Held | None:
    """Return the model itself if it is `gltf`, with the coat of viewers."""
    if model.type_name() != "gltf":
        return None
    if not model.clearcoat:
        return Held(model, model)
    return Held(CoatedBase(model), model, ("the coat darkens the base by the view alone",))


def write(held: Held, path: Path, comment: list[str]) -> list[Path]:
    """Write the ball and its material."""
    pixel = PIXEL if held.content.anisotropy else None
    material = make_material(held.content, path.stem)
    return [write_bytes(path, make_glb(material, comment, pixel))]


def make_material(model: Any, name: str) -> dict[str, Any]:
    """Return the material of the file, without extensions that change nothing."""
    colour = np.broadcast_to(model.base_color, 3).tolist()
    extensions: dict[str, dict[str, Any]] = {}
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
            "baseColorFactor": [*colour, 1.0],
            "metallicFactor": model.metallic,
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
        "highlights": "`gltf`: one GGX and a coat",
        "anisotropy": "yes",
        "else": "coat",
    },
    hold=hold,
    write=write,
    candidates=("gltf",),
)
