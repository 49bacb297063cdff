"""Runs exported GLSL by WebGL in a browser."""

import numpy as np

# Draws one pixel for each pair of directions into a texture of floats, and returns the values
RUN = """([formula, pairs]) => {
    const gl = document.createElement("canvas").getContext("webgl2");
    if (!gl.getExtension("EXT_color_buffer_float")) return "no floats";
    const sources = [[gl.VERTEX_SHADER, `#version 300 es
        void main() {
            gl_Position = vec4((gl_VertexID & 1) * 4 - 1, (gl_VertexID & 2) * 2 - 1, 0, 1);
        }`],
        [gl.FRAGMENT_SHADER, `#version 300 es
        precision highp float;
        uniform highp sampler2D pairs;
        out vec4 value;
        ${formula}
        void main() {
            ivec2 place = ivec2(gl_FragCoord.x, 0);
            value = vec4(brdf(texelFetch(pairs, place, 0).xyz,
                              texelFetch(pairs, place + ivec2(0, 1), 0).xyz), 1);
        }`]];
    const program = gl.createProgram();
    for (const [kind, source] of sources) {
        const shader = gl.createShader(kind);
        gl.shaderSource(shader, source);
        gl.compileShader(shader);
        const log = gl.getShaderInfoLog(shader);
        if (log) return log;
        gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    gl.useProgram(program);
    const width = pairs.length / 8, makeTexture = (height, data) => {
        gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
        gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, width, height, 0, gl.RGBA, gl.FLOAT, data);
        for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER])
            gl.texParameteri(gl.TEXTURE_2D, name, gl.NEAREST);
        return gl.getParameter(gl.TEXTURE_BINDING_2D);
    };
    const target = makeTexture(1, null);
    makeTexture(2, new Float32Array(pairs));
    gl.bindFramebuffer(gl.FRAMEBUFFER, gl.createFramebuffer());
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, target, 0);
    gl.viewport(0, 0, width, 1);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    const values = new Float32Array(4 * width);
    gl.readPixels(0, 0, width, 1, gl.RGBA, gl.FLOAT, values);
    return [...values];
}"""


def evaluate(browser, formula, wi, wo):
    """Return the values (n, 3) of the function `brdf` of a GLSL text at directions (n, 3) each."""
    pairs = [np.pad(w, ((0, 0), (0, 1))) for w in (wi, wo)]
    page = browser.new_page()
    values = page.evaluate(RUN, [formula, np.stack(pairs).ravel().tolist()])
    page.close()
    return np.reshape(values, (len(wi), 4))[:, :3]
