"""Reads materials by MaterialX, and draws with the OSL that it generates.

Known of MaterialX 1.39.5, by these tests:

- Its OSL passes all arguments, to six decimals, on to the closure `generalized_schlick_bsdf` of the
  renderer, without a factor.
- Names of nodes have to be ASCII. A document's own check finds unknown inputs, inputs of another
  type and those that are connected with nothing only if it was given the library before; nodes that
  do not exist it never finds.
"""

import functools
import re
from pathlib import Path
from tempfile import TemporaryDirectory

import blender
import numpy as np
import pytest

mx = pytest.importorskip("MaterialX", reason="materialx is not installed: make oracles")


@functools.cache
def load_library():
    """Return MaterialX's own definitions of nodes."""
    library = mx.createDocument()
    folders = mx.getDefaultDataLibraryFolders(), mx.getDefaultDataSearchPath()
    mx.loadLibraries(*folders, library)
    return library


def read(text):
    """Return the document of a text; `AssertionError` says what is wrong with it."""
    document = mx.createDocument()
    mx.readFromXmlString(document, text)
    check(document)
    return document


def check(document):
    """Raise `AssertionError` unless every node and every input is one that MaterialX defines."""
    document.setDataLibrary(load_library())
    valid, reasons = document.validate()
    assert valid, reasons
    for node in document.getNodes():
        assert node.getNodeDef(), f"MaterialX has no {node.getCategory()}"


def list_network(document):
    """Return category, and the inputs' types and values, of each node by the name's last part.

    Names of connected nodes begin with those of the material, as do those of the nodes.
    """
    (material,) = document.getMaterialNodes()
    network = {}
    for node in document.getNodes():
        inputs = {
            given.getName(): (
                given.getType(),
                _shorten(given.getNodeName(), material) or _to_data(given.getValue()),
            )
            for given in node.getInputs()
        }
        network[_shorten(node.getName(), material)] = node.getCategory(), inputs
    return network


def _shorten(name, material):
    return name.removeprefix(material.getName()).strip("_")


def _to_data(value):
    return value if isinstance(value, str) else np.float32(to_list(value)).tolist()


def to_list(value):
    """Return a number, a colour or a vector as a list of floats."""
    return [value] if isinstance(value, float) else list(value.asTuple())


def generate(document, language):
    """Return the shader in "glsl", "essl" or "osl"."""
    from MaterialX import PyMaterialXGenGlsl as of_glsl
    from MaterialX import PyMaterialXGenOsl as of_osl
    from MaterialX import PyMaterialXGenShader as shaders

    kinds = {
        "glsl": of_glsl.GlslShaderGenerator,
        "essl": of_glsl.EsslShaderGenerator,
        "osl": of_osl.OslShaderGenerator,
    }
    generator = kinds[language].create()
    context = shaders.GenContext(generator)
    context.registerSourceCodeSearchPath(mx.getDefaultDataSearchPath())
    if language != "osl":
        context.getOptions().hwMaxActiveLightSources = 1
        sun = load_library().getNodeDef("ND_directional_light")
        shaders.HwShaderGenerator.bindLightShader(sun, 1, context)
    (element,) = shaders.findRenderableElements(document)
    return generator.generate("material", element, context)


def read_osl_arguments(document):
    """Return the values of all parameters of the generated OSL's shader, by name, as texts."""
    text = generate(document, "osl").getSourceCode("pixel")
    head = text[text.rindex("shader material") :].partition("\n{")[0]
    rows = (line.strip().rstrip(",").split(maxsplit=3) for line in head.splitlines())
    return {row[1]: row[3] for row in rows if len(row) == 4 and row[2] == "="}


def measure_in_cycles(document, wi, wo):
    """Return the BRDF (n, 3) in sr⁻¹ that Cycles draws with the generated OSL.

    Cycles' own header takes the place of MaterialX's, with which its compiler crashes, and the
    direction of the texture's u that of the geometry's derivative, which Cycles does not have.
    """
    text = generate(document, "osl").getSourceCode("pixel")
    text = re.sub(r"\bBSDF\b", "CLOSURE", text).replace(" out = ", " BSDF = ")
    text = text.replace("mx_funcs.h", "vector2.h").replace("normalize(dPdu)", "Tangent")
    text = text.replace("output MATERIAL BSDF", "vector Tangent = 0, output MATERIAL BSDF")
    with TemporaryDirectory() as folder:
        file = Path(folder, "material.osl")
        file.write_text(text)
        return blender.measure(file, wi, wo)
