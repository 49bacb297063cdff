"""Blender draws sums of its nodes, and OSL, as brdfkit's formula says: what an export can hold."""

import blender
import numpy as np
import pytest

import brdfkit as bk
from brdfkit.core.geometry.directions import from_angles
from brdfkit.images.ball.normals import VIEW, find_normals, make_frames
from brdfkit.images.errors.colour_difference import ciede2000
from brdfkit.model import labels

pytestmark = [pytest.mark.oracles, pytest.mark.usefixtures("blenders_python")]

DIFFUSE = np.array([0.2, 0.1, 0.05])
NODES = """
import bpy

material = bpy.data.materials.new("Größe 1")
nodes, link = material.node_tree.nodes, material.node_tree.links.new
nodes.clear()
output, tangent = nodes.new("ShaderNodeOutputMaterial"), nodes.new("ShaderNodeTangent")
tangent.direction_type = "UV_MAP"


def make(kind, **values):
    node = nodes.new("ShaderNode" + kind)
    if hasattr(node, "distribution"):
        node.distribution = "GGX"
        link(tangent.outputs[0], node.inputs["Tangent"])
    for name, value in values.items():
        node.inputs[name.replace("_", " ")].default_value = value
    return node


def add(first, other):
    node = make("AddShader")
    link(first.outputs[0], node.inputs[0])
    link(other.outputs[0], node.inputs[1])
    return node


def scale(factor, shader):
    node = make("MixShader", Fac=factor)
    link(shader.outputs[0], node.inputs[2])
    return node


def colour(rgb):
    return *rgb, 1


"""
LINK = "link(shader.outputs[0], output.inputs[0])\n"


@pytest.fixture(scope="module")
def blenders_python():
    """Blender's Python, or the tests are skipped."""
    return blender.find_python()


def write_grey_sum(alpha_u, alpha_v, f0, f90):
    """Diffuse + Glossy + W · Metallic: k₀ = W b + g and k₉₀ = W + g, for base b and Glossy g.

    It exists where the largest k₉₀ - k₀ is at most the least k₉₀."""
    weight = ((f90 - f0).max() + f90.min()) / 2
    assert (f90 - f0).max() <= weight <= f90.min()
    ratio = min(alpha_u, alpha_v) / max(alpha_u, alpha_v)
    sign = 1 if alpha_u < alpha_v else -1
    roughness, glossy = (alpha_u * alpha_v) ** 0.25, sign * (1 - np.sqrt(ratio))
    metallic, quarter = (1 - ratio) / 0.9, 0.0 if alpha_u > alpha_v else 0.25
    return f"""{NODES}
glossy = make("BsdfGlossy", Color=colour({list(f90 - weight)}), Roughness={roughness},
              Anisotropy={glossy})
metallic = make("BsdfMetallic", Base_Color=colour({list(1 - (f90 - f0) / weight)}),
                Edge_Tint=colour([1, 1, 1]), Roughness={roughness}, Anisotropy={metallic},
                Rotation={quarter})
shader = add(glossy, scale({weight}, metallic))
shader = add(make("BsdfDiffuse", Color=colour({list(DIFFUSE)})), shader)
{LINK}""".replace("np.float64", "")


def write_tinted_metal(alpha_u, alpha_v, f0, f90):
    """Diffuse + s · Principled, whose coat has no share of its own but a tint, F₉₀ / s.

    The factor s w of the coat is below 1e-5, where Cycles leaves it out; its tint stays, though,
    and has no angle where the coat's index is large. So any k₉₀ ≥ k₀ is exact."""
    w, s = 1.1e-5, min(0.5, f90.min())
    ratio = min(alpha_u, alpha_v) / max(alpha_u, alpha_v)
    return f"""{NODES}
principled = make("BsdfPrincipled", Base_Color=colour({list(f0 / f90)}), Metallic=1,
                  Roughness={(alpha_u * alpha_v) ** 0.25}, Anisotropic={(1 - ratio) / 0.9},
                  Anisotropic_Rotation={0.0 if alpha_u > alpha_v else 0.25}, Coat_Weight={w},
                  Coat_IOR=1e6, Coat_Roughness=1, Coat_Tint=colour({list((f90 / s - 1 + w) / w)}))
shader = add(make("BsdfDiffuse", Color=colour({list(DIFFUSE)})), scale({s}, principled))
{LINK}""".replace("np.float64", "")


def write_osl(alpha_u, alpha_v, f0, f90):
    """Diffuse + m · generalized Schlick, with k₀ / m at most 1."""
    m = max(1, f0.max())
    kd, f0, f90 = (",".join(map(str, rgb)) for rgb in (DIFFUSE, f0 / m, f90 / m))
    return f"""
shader brdf(vector Tangent = vector(0, 0, 0), output closure color BSDF = 0)
{{
    BSDF = color({kd}) * diffuse(N)
         + {m} * generalized_schlick_bsdf(N, Tangent, color(1), color(0), {alpha_u}, {alpha_v},
                                          color({f0}), color({f90}), 5, "ggx");
}}
"""


def make_model(alphas, f0, f90):
    return labels.model("ggx:fresnel=coloured")(
        diffuse_reflectance=DIFFUSE,
        alpha_u=alphas[0],
        alpha_v=alphas[1],
        f0_reflectance=f0,
        f90_reflectance=f90,
    )


@pytest.mark.parametrize(
    ("write", "alphas", "f0", "f90"),
    [
        (write_grey_sum, (0.3, 0.3), (0.6, 0.3, 0.05), (0.8, 0.7, 0.5)),
        (write_grey_sum, (0.1, 0.4), (0.9, 0.69, 0.3), (1, 0.77, 0.34)),
        (write_grey_sum, (0.4, 0.1), (0.9, 0.69, 0.3), (1, 0.77, 0.34)),
        (write_tinted_metal, (0.1, 0.4), (0.04, 0.02, 0.3), (0.9, 0.5, 0.3)),
        (write_tinted_metal, (0.4, 0.1), (0.2, 1, 0.02), (3, 1.5, 0.06)),
        (write_osl, (0.02, 0.5), (1.5, 0.5, 0.1), (0.7, 2, 0)),
    ],
)
def test_sums_of_nodes_are_exact(tmp_path, write, alphas, f0, f90):
    file = tmp_path / ("grün 1.osl" if write is write_osl else "grün 1.py")
    file.write_text(write(*alphas, np.array(f0), np.array(f90)), encoding="utf-8")
    rng, turn = np.random.default_rng(1), 0.7  # of the brush, about the normal
    theta = np.arccos(rng.uniform(np.cos(np.radians(85)), 1, (2, 50)))
    phi = rng.uniform(0, 2 * np.pi, (2, 50))
    truth = bk.evaluate(make_model(alphas, f0, f90), *from_angles(theta, phi))
    measured = blender.measure(file, *from_angles(theta, phi + turn), turn)
    np.testing.assert_allclose(measured, truth, rtol=1e-4)


@pytest.mark.parametrize("light", ["sun", "environment"])
def test_ball_is_brdfkits_ball(tmp_path, light):
    alphas, f0, f90, side = (0.5, 0.3), np.array([0.9, 0.7, 0.3]), np.array([1, 0.8, 0.4]), 16
    file = tmp_path / "metal.py"
    file.write_text(write_grey_sum(*alphas, f0, f90), encoding="utf-8")
    x, y = np.meshgrid(*[(np.arange(side) + 0.5) / side * 2 - 1] * 2)
    inside = np.hypot(x, y) < 0.95
    frames = make_frames(find_normals(x[inside], -y[inside]))
    if light == "sun":
        w, shares = from_angles(np.array([0.7]), np.array([-2.1])), 1
        picture = blender.draw_ball(file, side, VIEW, sun=w[0])
    else:  # its colours turn with the azimuth
        rows = 64
        theta, phi = (np.mgrid[:rows, : 2 * rows] + 0.5) * np.pi / rows
        radiance = np.stack([1 + np.cos(phi), 1 + np.sin(phi), 1 + np.cos(theta)], axis=2)
        picture = blender.draw_ball(file, side, VIEW, samples=1024, environment=radiance)
        w = from_angles(theta, phi).reshape(-1, 3)
        shares = (radiance * np.sin(theta)[:, :, None]).reshape(-1, 3) * (np.pi / rows) ** 2
    wi = w @ frames.transpose(0, 2, 1)
    wo = np.broadcast_to((frames @ VIEW)[:, None], wi.shape)
    values = bk.evaluate(make_model(alphas, f0, f90), wi.reshape(-1, 3), wo.reshape(-1, 3))
    truth = (values.reshape(wi.shape) * np.maximum(wi[:, :, 2:], 0) * shares).sum(axis=1)
    white = truth.max()
    assert ciede2000(truth / white, picture[inside] / white).mean() < 0.2
