"""Independent programs that evaluate exported files, by target: BRDF values at directions.

Each function takes the files that `export` wrote and directions to light and viewer (n, 3), and
returns values (n, 3) in sr⁻¹; it skips where its program is not at hand.
"""

import runpy

import blender
import numpy as np
import openmaterial
import pbrt_rules
import radiance
import webgl
from chromium import start_chromium


def evaluate_in_blender(paths, wi, wo):
    """Cycles draws a plane under a sun."""
    return blender.measure(paths[0], wi, wo)


def evaluate_in_python(paths, wi, wo):
    """Python runs the file."""
    return runpy.run_path(str(paths[0]))["brdf"](wi, wo)


SCENE = """<scene version="3.0.0"><include filename="{}"/>
<shape type="rectangle"><ref id="material"/></shape></scene>"""


def evaluate_in_mitsuba(paths, wi, wo):
    """Mitsuba loads the file into a scene, and its own plugins evaluate the BSDF."""
    import drjit as dr
    import mitsuba as mi

    mi.set_variant("llvm_ad_rgb")
    user = paths[0].with_name("scene.xml")
    user.write_text(SCENE.format(paths[0].name))
    si = dr.zeros(mi.SurfaceInteraction3f, len(wi))
    si.wi = mi.Vector3f(np.asarray(wi).T)
    bsdf = mi.load_file(str(user)).shapes()[0].bsdf()
    values = bsdf.eval(mi.BSDFContext(), si, mi.Vector3f(np.asarray(wo).T))
    return np.array(values).T / wo[:, 2:]


def evaluate_by_pbrts_rules(paths, wi, wo):
    """The table obeys pbrt's rules, and Mitsuba's spectral variant evaluates it."""
    table = pbrt_rules.find_table(paths[0])
    assert paths[1:] == (table,)
    wavelengths = pbrt_rules.read_fields(table)["wavelengths"]
    return pbrt_rules.evaluate(table, wavelengths, wi, wo)


def evaluate_by_openmaterial(paths, wi, wo):
    """The rows are read again, and SciPy interpolates between them."""
    return openmaterial.evaluate(openmaterial.find_table(paths[0]), wi, wo)


def evaluate_in_radiance(paths, wi, wo):
    """Radiance's rcontrib traces rays to a plane under suns."""
    return radiance.measure(paths[0], wi, wo)


def evaluate_by_materialx(paths, wi, wo):
    """Cycles draws with the OSL that MaterialX generates of the file."""
    import materialx_oracle

    document = materialx_oracle.read(paths[0].read_text(encoding="utf-8"))
    return materialx_oracle.measure_in_cycles(document, wi, wo)


def evaluate_by_usd(paths, wi, wo):
    """USD reads the file, MaterialX generates OSL of its network, and Cycles draws with that."""
    import materialx_oracle
    import usd_oracle

    network = usd_oracle.read_network(usd_oracle.open_stage(paths[0]))
    return materialx_oracle.measure_in_cycles(network, wi, wo)


def evaluate_in_three(paths, wi, wo):
    """three.js draws a plane under a light in Chromium, by glTF's own formula."""
    import gltf_oracle

    return gltf_oracle.measure(start_chromium(), paths[0], wi, wo)


def evaluate_by_webgl(paths, wi, wo):
    """Chromium runs the shader."""
    return webgl.evaluate(start_chromium(), paths[0].read_text(encoding="utf-8"), wi, wo)


ORACLES = {
    "blender": evaluate_in_blender,
    "glsl": evaluate_by_webgl,
    "gltf": evaluate_in_three,
    "materialx": evaluate_by_materialx,
    "mitsuba": evaluate_in_mitsuba,
    "openmaterial": evaluate_by_openmaterial,
    "osl": evaluate_in_blender,
    "pbrt": evaluate_by_pbrts_rules,
    "python": evaluate_in_python,
    "radiance": evaluate_in_radiance,
    "usd": evaluate_by_usd,
}
