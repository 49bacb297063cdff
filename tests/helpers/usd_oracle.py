"""Reads an exported .usda by USD, and makes a document of MaterialX of its network.

USD's own validators, of usd-core 26.11, see neither connections with nothing nor inputs of another
type, and they do not know MaterialX's nodes. So the network is built again as a document, which
`materialx_oracle` checks and draws.
"""

import materialx_oracle
import pytest

Usd = pytest.importorskip("pxr.Usd", reason="usd-core is not installed: make oracles")

TYPES = {
    "color3f": "color3",
    "float2": "vector2",
    "float3": "vector3",
    "token": "BSDF",
}  # MaterialX's, by USD's


def open_stage(file):
    """Return the stage of a file; `AssertionError` says what USD's validators find.

    What is read of a stage exists as long as the stage does.
    """
    from pxr import UsdValidation

    stage = Usd.Stage.Open(str(file))
    validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    found = UsdValidation.ValidationContext(validators).Validate(stage)
    complaints = [f"{error.GetName()}: {error.GetMessage()}" for error in found]
    unknown = "MissingShaderIdInRegistry"
    assert not [c for c in complaints if unknown not in c or "'ND_" not in c], complaints
    return stage


def find_material(stage):
    """Return the material that the default object's ball is bound to."""
    from pxr import UsdShade

    ball = stage.GetDefaultPrim().GetChild("Ball")
    material, _ = UsdShade.MaterialBindingAPI(ball).ComputeBoundMaterial()
    assert material, "the ball has no material"
    return material


def read_network(stage):
    """Return MaterialX's document of the ball's material.

    `AssertionError` says what is wrong with it.
    """
    material = find_material(stage)
    surface, *_ = material.ComputeSurfaceSource("mtlx")
    document = materialx_oracle.mx.createDocument()
    name = material.GetPath().GetParentPath().name
    result = document.addNode("surfacematerial", name, "material")
    link = result.addInput("surfaceshader", "surfaceshader")
    link.setNodeName(_add_node(document, name, surface))
    materialx_oracle.check(document)
    return document


def _add_node(document, material, shader):
    """Add a node and those that it is connected with; return its name."""
    definition = materialx_oracle.load_library().getNodeDef(shader.GetShaderId())
    assert definition, f"MaterialX has no {shader.GetShaderId()}"
    name = f"{material}_{shader.GetPrim().GetName()}"
    kind, output = definition.getNodeString(), definition.getActiveOutputs()[0].getType()
    node = document.addNode(kind, name, output)
    for given in shader.GetInputs():
        kind = str(given.GetTypeName())
        made = node.addInput(given.GetBaseName(), TYPES.get(kind, kind))
        sources, wrong = given.GetConnectedSources()
        assert not wrong, f"{given.GetFullName()} is connected with nothing"
        if sources:
            made.setNodeName(_add_node(document, material, _to_shader(sources[0].source)))
        else:
            value = given.Get()
            numbers = value if hasattr(value, "__len__") else [value]
            text = ", ".join(f"{x:.9g}" for x in numbers) if not isinstance(value, str) else value
            made.setValueString(text)
    return name


def _to_shader(source):
    from pxr import UsdShade

    return UsdShade.Shader(source.GetPrim())
