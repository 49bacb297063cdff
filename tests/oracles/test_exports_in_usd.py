"""USD reads what `export` wrote: a ball with the network of the .mtlx, and a preview."""

import materialx_oracle
import numpy as np
import pytest
import usd_oracle
from six_fits import SIX_FITS, make_fit

import brdfkit as bk
from brdfkit.exporting.ggx_sum import to_ggx_sum

pytestmark = pytest.mark.oracles


@pytest.mark.parametrize("name", SIX_FITS)
def test_the_network_is_that_of_materialx(name, tmp_path):
    fit = make_fit(name)
    usd = bk.export(fit, "usd", tmp_path / "größe 1.usda", accept_loss=True)
    mtlx = bk.export(to_ggx_sum(usd.drawn).to_model(), "materialx", tmp_path / "größe 1.mtlx")
    network = usd_oracle.read_network(usd_oracle.open_stage(usd.paths[0]))
    told = materialx_oracle.read(mtlx.paths[0].read_text(encoding="utf-8"))
    assert materialx_oracle.list_network(network) == materialx_oracle.list_network(told)


def test_openpbrs_network_is_that_of_materialx(tmp_path):
    brushed = {"base_metalness": 0.5, "specular_roughness_anisotropy": -0.5}
    model = bk.models()["openpbr"](base_color=[0.5, 0.1, 0.05], **brushed)
    usd, mtlx = (
        bk.export(model, target, tmp_path / f"größe 1.{suffix}").paths[0]
        for target, suffix in (("usd", "usda"), ("materialx", "mtlx"))
    )
    network = usd_oracle.read_network(usd_oracle.open_stage(usd))
    told = materialx_oracle.read(mtlx.read_text(encoding="utf-8"))
    assert materialx_oracle.list_network(network) == materialx_oracle.list_network(told)


def test_programs_without_materialx_get_a_preview(tmp_path):
    file = bk.export(make_fit("brushed"), "usd", tmp_path / "größe 1.usda").paths[0]
    stage = usd_oracle.open_stage(file)
    preview, *_ = usd_oracle.find_material(stage).ComputeSurfaceSource()
    assert preview.GetShaderId() == "UsdPreviewSurface"
    values = {given.GetBaseName(): given.Get() for given in preview.GetInputs()}
    assert values["roughness"] == pytest.approx((0.36 * 0.14) ** 0.25)
    assert list(values["specularColor"]) == pytest.approx([0.54, 0.522, 0.495])


def test_the_ball_has_right_handed_frames_along_u(tmp_path):
    from pxr import UsdGeom

    file = bk.export(make_fit("metal"), "usd", tmp_path / "größe 1.usda").paths[0]
    stage = usd_oracle.open_stage(file)
    prim = stage.GetDefaultPrim().GetChild("Ball")
    mesh, variables = UsdGeom.Mesh(prim), UsdGeom.PrimvarsAPI(prim)
    corners = np.reshape(mesh.GetFaceVertexIndicesAttr().Get(), (-1, 3))
    points, normals = (np.array(a.Get()) for a in (mesh.GetPointsAttr(), mesh.GetNormalsAttr()))
    tangents, uv = (np.array(variables.GetPrimvar(key).Get()) for key in ("tangents", "st"))
    p, q = (a[corners][:, 1:] - a[corners][:, :1] for a in (points, uv))
    outward = np.cross(p[:, 0], p[:, 1])
    assert (np.einsum("ni,ni->n", outward, normals[corners[:, 0]]) > 0).all()
    along = np.linalg.solve(q, p)  # the derivatives of the point by u and v
    along /= np.linalg.norm(along, axis=2, keepdims=True)
    assert (np.einsum("ni,ni->n", along[:, 0], tangents[corners].mean(axis=1)) > 0.99).all()
    assert (np.einsum("ni,ni->n", np.cross(along[:, 0], along[:, 1]), outward) > 0).all()


DAMAGES = {
    "connection": ("highlight_2.outputs", "none.outputs"),
    "type": ("float2 inputs:roughness = (0.1, 0.1)", "color3f inputs:roughness = (0.1, 0.1, 1)"),
    "category": ("ND_surface", "ND_none"),
    "binding": ("rel material:binding", "rel nothing"),
}


@pytest.mark.parametrize("damage", DAMAGES)
def test_damage_is_noticed(damage, tmp_path):
    file = bk.export(make_fit("coat"), "usd", tmp_path / "größe 1.usda").paths[0]
    text = file.read_text(encoding="utf-8")
    assert DAMAGES[damage][0] in text
    file.write_text(text.replace(*DAMAGES[damage]), encoding="utf-8")
    with pytest.raises(AssertionError):
        usd_oracle.read_network(usd_oracle.open_stage(file))
