"""Khronos' validator and three.js, where they are at hand, ask what is in a .glb file.

The environment variable BRDFKIT_NODE_MODULES names a folder node_modules with gltf-validator and
three; Node and Chromium have to be there, too.
"""

import base64
import json
import mimetypes
import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

VALIDATE = """
const { validateBytes } = require(process.argv[1] + "/gltf-validator");
const bytes = new Uint8Array(require("fs").readFileSync(process.argv[2]));
validateBytes(bytes).then((report) => console.log(JSON.stringify(report.issues)));
"""
PAGE = """<script type="importmap">{"imports": {"three": "/three/build/three.module.js"}}</script>
<script type="module">
import * as THREE from "three";
import { GLTFLoader } from "/three/examples/jsm/loaders/GLTFLoader.js";
Object.assign(window, { THREE, GLTFLoader });
</script>"""
# Draws a plane with the file's material under a directional light, from an orthographic camera
DRAW = """async ([file, pairs, tangent]) => {
    const bytes = Uint8Array.from(atob(file), (letter) => letter.charCodeAt(0));
    const { scene: model } = await new GLTFLoader().parseAsync(bytes.buffer, "");
    let material;
    model.traverse((object) => (material = object.material || material));
    const renderer = new THREE.WebGLRenderer();
    renderer.toneMapping = THREE.NoToneMapping;
    renderer.setSize(4, 4);
    const target = new THREE.WebGLRenderTarget(4, 4, { type: THREE.FloatType });
    renderer.setRenderTarget(target);
    const plane = new THREE.PlaneGeometry(2, 2);
    const tangents = new Float32Array(Array(4).fill([...tangent, 0, 1]).flat());
    plane.setAttribute("tangent", new THREE.BufferAttribute(tangents, 4));
    const scene = new THREE.Scene(), light = new THREE.DirectionalLight(0xffffff, 1);
    scene.add(new THREE.Mesh(plane, material), light, light.target);
    const camera = new THREE.OrthographicCamera(-0.01, 0.01, 0.01, -0.01, 0.1, 100);
    camera.up.set(0, 1, 0.3);
    return pairs.map(([wi, wo]) => {
        light.position.set(...wi.map((x) => 10 * x));
        camera.position.set(...wo.map((x) => 10 * x));
        camera.lookAt(0, 0, 0);
        renderer.render(scene, camera);
        const pixel = new Float32Array(4);
        renderer.readRenderTargetPixels(target, 1, 1, 1, 1, pixel);
        return [...pixel].slice(0, 3);
    });
}"""
# three.js adds light that facets scatter several times, and approximates (1 - V·H)⁵ by a power of
# 2, which differs by 7 % of a plastic's highlight at 50°. It takes light off the diffuse term by
# each channel of F, and glTF's formula by the largest
REPLACED = {
    "irradiance * diffuseBRDF * ( 1.0 - F )": (
        "irradiance * diffuseBRDF * ( 1.0 - max( F.r, max( F.g, F.b ) ) )"
    ),
    "irradiance * specularBRDF * material.multiScatteringCompensation": "irradiance * specularBRDF",
    "exp2( ( - 5.55473 * dotVH - 6.98316 ) * dotVH )": "pow( 1.0 - dotVH, 5.0 )",
}


def find_modules():
    """Return the folder of the packages; without one, skip the test and say what to do."""
    folder = os.environ.get("BRDFKIT_NODE_MODULES", "")
    if folder and Path(folder, "gltf-validator").is_dir() and Path(folder, "three").is_dir():
        return Path(folder)
    return pytest.skip("BRDFKIT_NODE_MODULES names no folder with gltf-validator and three")


def validate(file):
    """Return the numbers of errors, warnings, infos and hints, and the messages."""
    command = ["node", "-e", VALIDATE, str(find_modules()), str(file)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    issues = json.loads(done.stdout)
    counts = [issues[f"num{kind}"] for kind in ("Errors", "Warnings", "Infos", "Hints")]
    return counts, issues["messages"]


def measure(browser, file, wi, wo, turn=0.0):
    """Return the BRDF (n, 3) in sr⁻¹ that three.js draws; `turn` is the angle of the tangent."""
    modules = find_modules()

    def serve(route):
        name = route.request.url.partition("//files/")[2]
        if not name:
            route.fulfill(body=PAGE, content_type="text/html")
        else:
            text = (modules / name).read_text(encoding="utf-8")
            for own, of_gltf in REPLACED.items():
                text = text.replace(own, of_gltf)
            route.fulfill(body=text, content_type=mimetypes.guess_type(name)[0])

    page = browser.new_page()
    page.route("http://files/**", serve)
    page.goto("http://files/")
    page.wait_for_function("Boolean(window.GLTFLoader)")
    data = base64.b64encode(Path(file).read_bytes()).decode()
    pairs = np.stack([wi, wo], axis=1).tolist()
    values = page.evaluate(DRAW, [data, pairs, [np.cos(turn), np.sin(turn)]])
    page.close()
    return np.array(values) / wi[:, 2:]
