"""Reads materials by MaterialX, and draws with the shaders that it generates, in a browser.

The shader for WebGL, under one directional light, has no noise: it agrees with the formula to 1e-6.
Known of MaterialX 1.39.5, by these measurements, of a highlight of `generalized_schlick_bsdf`:

- GLSL and ESSL draw S F (1 + F (1 - E) / E) with F = k₀ + (k₉₀ - k₀) (1 - V·H)⁵, for any k₀ and
  k₉₀. S is that of GGX with the isotropic G of √(α_u α_v); α is cut to 1. E is an approximation of
  the albedo of the highlight for F = 1, from the direction of the viewer.
- OSL passes all arguments on to the closure `generalized_schlick_bsdf` of the renderer, without a
  factor.
- Names of nodes have to be ASCII. A document's own check finds unknown inputs, inputs of another
  type and those that are connected with nothing only if it was given the library before; nodes that
  do not exist it never finds.
"""

import functools
import itertools

import numpy as np
import pytest

from brdfkit.core.geometry.directions import from_angles

mx = pytest.importorskip("MaterialX", reason="materialx is not installed: make oracles")

# Draws a pixel for each pair of directions, and returns the values
RUN = """([vertex, fragment, uniforms, pairs, tangent]) => {
    const gl = document.createElement("canvas").getContext("webgl2");
    if (!gl.getExtension("EXT_color_buffer_float")) return "no floats";
    const program = gl.createProgram();
    for (const [kind, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
        const shader = gl.createShader(kind);
        gl.shaderSource(shader, source);
        gl.compileShader(shader);
        if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) return gl.getShaderInfoLog(shader);
        gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    gl.useProgram(program);
    const place = name => gl.getUniformLocation(program, name);
    const identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
    for (const name of ["worldMatrix", "worldInverseTransposeMatrix", "viewProjectionMatrix"])
        gl.uniformMatrix4fv(place("u_" + name), false, identity);
    for (const [name, value] of Object.entries(uniforms)) {
        const call = typeof value == "number" ? "uniform1i" : `uniform${value.length}fv`;
        gl[call](place(name), value);
    }
    const up = [0, 0, 1], repeat = v => [...v, ...v, ...v];
    const corners = {i_position: [-1, -1, 0, 3, -1, 0, -1, 3, 0], i_normal: repeat(up),
                     i_tangent: repeat(tangent)};
    for (const [name, values] of Object.entries(corners)) {
        const at = gl.getAttribLocation(program, name);
        if (at < 0) continue;
        gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
        gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(values), gl.STATIC_DRAW);
        gl.enableVertexAttribArray(at);
        gl.vertexAttribPointer(at, 3, gl.FLOAT, false, 0, 0);
    }
    const target = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, target);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA32F, pairs.length, 1);
    gl.bindFramebuffer(gl.FRAMEBUFFER, gl.createFramebuffer());
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, target, 0);
    gl.bindTexture(gl.TEXTURE_2D, null);
    pairs.forEach(([wi, wo], i) => {
        gl.viewport(i, 0, 1, 1);
        gl.uniform3fv(place("u_viewPosition"), wo.map(x => 1e6 * x));
        gl.uniform3fv(place("u_lightData[0].direction"), wi.map(x => -x));
        gl.drawArrays(gl.TRIANGLES, 0, 3);
    });
    const values = new Float32Array(4 * pairs.length);
    gl.readPixels(0, 0, pairs.length, 1, gl.RGBA, gl.FLOAT, values);
    return gl.getError() || [...values];
}"""
LIGHT = {
    "u_numActiveLightSources": 1,
    "u_envRadianceSamples": 1,
    "u_envLightIntensity": [0.0],
    "u_lightData[0].type": 1,
    "u_lightData[0].color": [1.0, 1.0, 1.0],
    "u_lightData[0].intensity": [1.0],
}


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
    return value if isinstance(value, str) else np.float32(_to_list(value)).tolist()


def _to_list(value):
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


def draw_pairs(turn=0.0):
    """Return 50 pairs of directions to 85°, turned about the normal by an angle [rad]."""
    random = np.random.default_rng(1)
    theta = np.arccos(random.uniform(np.cos(np.radians(85)), 1, (2, 50)))
    return from_angles(theta, random.uniform(0, 2 * np.pi, (2, 50)) + turn)


def measure(browser, document, wi, wo, turn=0.0):
    """Return the BRDF (n, 3) in sr⁻¹ that WebGL draws at directions to light and viewer.

    `turn` is the angle [rad] from the surface's x axis to the tangent.
    """
    shader = generate(document, "essl")
    blocks = shader.getStage("pixel").getUniformBlocks().values()
    values = {port.getVariable(): port for block in blocks for port in block if port.getValue()}
    uniforms = {n: _to_uniform(p) for n, p in values.items() if n != "u_envMatrix"} | LIGHT
    sources = [shader.getSourceCode(stage) for stage in ("vertex", "pixel")]
    page = browser.new_page()
    pairs = np.stack([wi, wo], axis=1).tolist()
    drawn = page.evaluate(RUN, [*sources, uniforms, pairs, [np.cos(turn), np.sin(turn), 0]])
    page.close()
    assert isinstance(drawn, list), drawn
    return np.reshape(drawn, (len(wi), 4))[:, :3] / wi[:, 2:]


def _to_uniform(port):
    """Return a value as a whole number, or a list of floats."""
    data = port.getValue().getData()
    if isinstance(data, str):
        return 0  # "ggx" and "R" are the first ones of their kinds
    return int(data) if isinstance(data, bool | int) else _to_list(data)


def read_osl_arguments(document):
    """Return the values of all parameters of the generated OSL's shader, by name, as texts."""
    text = generate(document, "osl").getSourceCode("pixel")
    head = text[text.rindex("shader material") :].partition("\n{")[0]
    rows = (line.strip().rstrip(",").split(maxsplit=3) for line in head.splitlines())
    return {row[1]: row[3] for row in rows if len(row) == 4 and row[2] == "="}


def predict(content, white, wi, wo):
    """Return what GLSL draws (n, 3) of a `GgxSum` by its formula.

    `white`: for each highlight, what GLSL draws if F = 1, from which E follows.
    """
    values = np.tile(np.divide(content.diffuse, np.pi), (len(wi), 1))
    h = (wi + wo) / np.linalg.norm(wi + wo, axis=1, keepdims=True)
    rise = (1 - (wi * h).sum(axis=1))[:, None] ** 5
    for lobe, bright in itertools.zip_longest(content.lobes, white):
        widths = lobe.alpha_u, lobe.alpha_v
        slopes = np.square(h[:, :2] / widths).sum(axis=1) + h[:, 2] ** 2
        D = 1 / (np.pi * np.prod(widths) * slopes**2)
        sides = [np.hypot(w[:, 2], np.sqrt(np.prod(widths)) * np.hypot(*w.T[:2])) for w in (wi, wo)]
        S = D / (2 * (sides[0] * wo[:, 2] + sides[1] * wi[:, 2]))
        E = S[:, None] / bright
        F = lobe.f0 + np.subtract(lobe.f90, lobe.f0) * rise
        values += S[:, None] * F * (1 + F * (1 - E) / E)
    return values
