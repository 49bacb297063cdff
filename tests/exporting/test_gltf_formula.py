"""What an exported glTF file means by its specification is what the export says viewers draw."""

import json
import struct

import numpy as np
import pytest

import brdfkit as bk
from brdfkit.checks.material_subject import draw_direction_pairs
from brdfkit.exporting.targets import gltf
from brdfkit.model import labels

COLOURED = {"diffuse_color": [0.3, 0.1, 0.05], "specular_color": [0.5, 0.3, 0.1], "specular": 0.6}
PLASTIC = {"base_color": [0.6, 0.2, 0.1], "metallic": 0.3, "ior": 1.7, "specular": 0.8}
COAT = {"clearcoat": 0.7, "clearcoat_roughness": 0.2}


def evaluate_file(path, wi, wo):
    """The BRDF of appendix B and of the extensions, without anisotropy, seen from wo."""
    data = path.read_bytes()
    document = json.loads(data[20 : 20 + struct.unpack("<I", data[12:16])[0]])
    (material,) = document["materials"]
    base, more = material["pbrMetallicRoughness"], material.get("extensions", {})
    specular = more.get("KHR_materials_specular", {})
    factor = specular.get("specularFactor", 1.0)
    colour = np.array(specular.get("specularColorFactor", [1, 1, 1]))
    ior = more.get("KHR_materials_ior", {}).get("ior", 1.5)
    f0 = np.minimum(((ior - 1) / (ior + 1)) ** 2 * colour, 1) * factor
    c = np.array(base["baseColorFactor"][:3])
    h = (wi + wo) / np.linalg.norm(wi + wo, axis=1, keepdims=True)
    share = (1 - (h * wo).sum(axis=1, keepdims=True)) ** 5

    def reflect(roughness):
        squared = roughness**4
        D = squared / (np.pi * ((squared - 1) * h[:, 2:] ** 2 + 1) ** 2)
        i, o = (np.sqrt(squared + (1 - squared) * w[:, 2:] ** 2) for w in (wi, wo))
        return D * 0.5 / (wo[:, 2:] * i + wi[:, 2:] * o)

    F = f0 + (factor - f0) * share
    S = reflect(base["roughnessFactor"])
    dielectric = (1 - F.max(axis=1, keepdims=True)) * c / np.pi + F * S
    metal = (c + (1 - c) * share) * S
    value = dielectric + base["metallicFactor"] * (metal - dielectric)
    coat = more["KHR_materials_clearcoat"]
    strength = coat["clearcoatFactor"]
    passing = 1 - strength * (0.04 + 0.96 * (1 - wo[:, 2:]) ** 5)
    highlight = (0.04 + 0.96 * share) * reflect(coat["clearcoatRoughnessFactor"])
    return value * passing + strength * highlight


@pytest.mark.quick
@pytest.mark.parametrize(
    ("label", "values"), [("gltf", PLASTIC), ("gltf:highlights=coloured", COLOURED)]
)
def test_a_file_holds_what_viewers_are_said_to_draw(tmp_path, label, values):
    model = labels.model(label)(**values, **COAT)
    done = bk.export(model, "gltf", tmp_path / "a.glb", accept_loss=True)
    pairs = draw_direction_pairs(500, 1, 85)
    drawn = gltf.hold(model).drawn.eval(*pairs)
    np.testing.assert_allclose(evaluate_file(done.paths[0], *pairs), drawn, rtol=1e-9)
