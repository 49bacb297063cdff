"""Six fitted materials for tests of exports, by name; their values are those of fits."""

from brdfkit.model import labels

METAL = {"diffuse_reflectance": 0.0, "alpha_u": 0.21, "f0": 0.85}
SIX_FITS = {
    "metal": ("ggx", {**METAL, "specular_reflectance": [0.95, 0.72, 0.36]}),
    "plastic": (
        "ggx",
        {
            "diffuse_reflectance": [0.35, 0.03, 0.02],
            "specular_reflectance": 0.9,
            "alpha_u": 0.08,
            "f0": 0.045,
        },
    ),
    "paint": (
        "ggx+ggx",
        {
            "diffuse_reflectance": [0.01, 0.043, 0.068],
            "ggx_1_specular_reflectance": [0.53, 0.4, 0.72],
            "ggx_1_alpha_u": 0.195,
            "ggx_1_f0": 0.42,
            "ggx_2_specular_reflectance": 0.36,
            "ggx_2_alpha_u": 0.06,
            "ggx_2_f0": 0.1,
        },
    ),
    "fabric": ("burley", {"diffuse_reflectance": [0.3, 0.1, 0.05], "roughness": 0.95}),
    "brushed": (
        "ggx",
        {
            "diffuse_reflectance": 0.02,
            "specular_reflectance": [0.6, 0.58, 0.55],
            "alpha_u": 0.36,
            "alpha_v": 0.14,
            "f0": 0.9,
        },
    ),
    "coat": (
        "ggx:fresnel=coloured+ggx",
        {
            "diffuse_reflectance": [0.05, 0.02, 0.1],
            "ggx_1_alpha_u": 0.4,
            "ggx_1_alpha_v": 0.2,
            "ggx_1_f0_reflectance": [0.3, 0.2, 0.4],
            "ggx_1_f90_reflectance": [0.9, 0.8, 0.95],
            "ggx_2_specular_reflectance": 0.8,
            "ggx_2_alpha_u": 0.1,
            "ggx_2_f0": 0.04,
        },
    ),
}


def make_fit(name):
    """Return the model of a fit."""
    label, values = SIX_FITS[name]
    return labels.model(label)(**values)
