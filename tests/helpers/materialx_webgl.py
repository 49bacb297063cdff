"""Draws materials with the shaders that MaterialX generates for WebGL, in a browser.

Under one directional light there is no noise: values agree with the formula to 1e-6. Known of
MaterialX 1.39.5, by these measurements, of a highlight of `generalized_schlick_bsdf`: GLSL draws
S F (1 + F (1 - E) / E) with F = k₀ + (k₉₀ - k₀) (1 - V·H)⁵, for any k₀ and k₉₀. S is that of GGX
with the isotropic G of √(α_u α_v). E is an approximation of the highlight's albedo for F = 1, from
the direction of the viewer.
"""

import itertools

import materialx_oracle as oracle
import numpy as np

from brdfkit.core.geometry.directions import from_angles

# Draws a pixel for each pair of directions, and returns the values. Programs are kept: to compile
# one takes a second
RUN = """([vertex, fragment, uniforms, pairs, tangent]) => {
    const gl = window.gl ??= document.createElement("canvas").getContext("webgl2");
    if (!gl.getExtension("EXT_color_buffer_float")) throw new Error("no floats");
    const link = () => {
        const program = gl.createProgram();
        for (const [kind, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
            const shader = gl.createShader(kind);
            gl.shaderSource(shader, source);
            gl.compileShader(shader);
            if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS))
                throw new Error(gl.getShaderInfoLog(shader));
            gl.attachShader(program, shader);
        }
        gl.linkProgram(program);
        return program;
    };
    window.programs ??= {};
    const program = window.programs[fragment] ??= link();
    gl.useProgram(program);
    const place = name => gl.getUniformLocation(program, name);
    const identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
    for (const name of ["worldMatrix", "worldInverseTransposeMatrix", "viewProjectionMatrix"])
        gl.uniformMatrix4fv(place("u_" + name), false, identity);
    for (const [name, value] of Object.entries(uniforms)) {
        const call = typeof value == "number" ? "uniform1i" : `uniform${value.length}fv`;
        gl[call](place(name), value);
    }
    const position = gl.getAttribLocation(program, "i_position");
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array([-1, -1, 3, -1, -1, 3]), gl.STATIC_DRAW);
    gl.enableVertexAttribArray(position);
    gl.vertexAttribPointer(position, 2, gl.FLOAT, false, 0, 0);
    for (const [name, value] of [["i_normal", [0, 0, 1]], ["i_tangent", tangent]]) {
        const at = gl.getAttribLocation(program, name);
        if (at < 0) continue;
        gl.disableVertexAttribArray(at);
        gl.vertexAttrib3fv(at, value);
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
    if (gl.getError()) throw new Error("WebGL fails");
    return [...values];
}"""
LIGHT = {
    "u_numActiveLightSources": 1,
    "u_envRadianceSamples": 1,
    "u_envLightIntensity": [0.0],
    "u_lightData[0].type": 1,
    "u_lightData[0].color": [1.0, 1.0, 1.0],
    "u_lightData[0].intensity": [1.0],
}


def draw_pairs(turn=0.0):
    """Return 50 pairs of directions to 85°, turned about the normal by an angle [rad]."""
    random = np.random.default_rng(1)
    theta = np.arccos(random.uniform(np.cos(np.radians(85)), 1, (2, 50)))
    return from_angles(theta, random.uniform(0, 2 * np.pi, (2, 50)) + turn)


def measure(page, document, wi, wo, turn=0.0):
    """Return the BRDF (n, 3) in sr⁻¹ that WebGL draws at directions to light and viewer.

    `page` is one of the browser's; `turn` is the angle [rad] from the surface's x axis to the
    tangent.
    """
    shader = oracle.generate(document, "essl")
    blocks = shader.getStage("pixel").getUniformBlocks().values()
    values = {port.getVariable(): port for block in blocks for port in block if port.getValue()}
    uniforms = {n: _to_uniform(p) for n, p in values.items() if n != "u_envMatrix"} | LIGHT
    sources = [shader.getSourceCode(stage) for stage in ("vertex", "pixel")]
    pairs = np.stack([wi, wo], axis=1).tolist()
    drawn = page.evaluate(RUN, [*sources, uniforms, pairs, [np.cos(turn), np.sin(turn), 0]])
    return np.reshape(drawn, (len(wi), 4))[:, :3] / wi[:, 2:]


def _to_uniform(port):
    """Return a value as a whole number, or a list of floats."""
    data = port.getValue().getData()
    if isinstance(data, str):
        return 0  # "ggx" and "R" are the first ones of their kinds
    return int(data) if isinstance(data, bool | int) else oracle.to_list(data)


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
