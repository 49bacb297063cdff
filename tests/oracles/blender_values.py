"""Measures materials in Blender: BRDF values at pairs of directions, and pictures of a ball.

Blender's Python runs this file as a program. That is Blender 5.0 as the wheel `bpy`, and NumPy:

    python blender_values.py MATERIAL REQUEST.npz RESULT.npz

MATERIAL is a .py file that makes one material in `bpy.data.materials` when it is run, or an .osl
file with one shader, whose input `Tangent` gets the direction of the UV map's u, and whose output
`BSDF` is drawn. The arrays of REQUEST.npz tell what to measure:

- `wi` and `wo` (n, 3), the directions to the light and to the camera in the frame of the surface,
  and `turn`, the angle [rad] from the surface's x axis to the UV map's u. RESULT.npz then holds
  `values` (n, 3), the BRDF in sr⁻¹.
- `side`, the pixels along a side, and `view` (3,), the direction to the camera. RESULT.npz then
  holds the linear `picture` (side, side, 3) of a ball that fills it, its first row on top. The
  light is `sun` (3,), the direction to a sun that sends 1 W/m², or `environment` (h, w, 3),
  radiances over the polar angle from +z (rows) and the azimuth from +x to +y (columns), with
  `samples` for each pixel. In the world z points up, and the ball's u follows its circles of
  latitude eastwards.

A plane under one sun has no noise: one sample of each pair agrees with the formula to 1e-6. Known
of Cycles 5.0, by these measurements (r is a node's roughness, A its anisotropy, x along u):

- Glossy: no Fresnel factor. α_x = r² (1 - A), α_y = r² / (1 - A); A < 0 the other way round;
  |A| ≤ 0.99. Metallic and Principled: α_x = r² / a, α_y = r² a, a² = 1 - 0.9 A; 0 ≤ A ≤ 1. All cut
  α off at 1. `Rotation` turns x from u towards v, with 1 for a full turn. α_x = α_y is rounded:
  1 % of D at α = 0.005, 0.05 % at 0.02; the least anisotropy avoids that.
- Metallic with the edge tint 1 is Schlick's F with F₉₀ = 1 and F₀ the base colour, cut to 0..1.
  Weights and colours of Glossy and Diffuse above 1 are kept, and those below 0 become 0.
- The distribution `GGX` scatters once; the default `MULTI_GGX` adds light, by the view alone.
- Principled, not metallic: a dielectric's F by the refractive index, and the diffuse part times 1
  less the highlight's albedo in the direction of the camera. Hence it is not reciprocal.
- Diffuse with a roughness is EON, but for ρ³ instead of ρ² in the second term.
- OSL: generalized_schlick_bsdf(N, T, reflection, transmission, α_x, α_y, F₀, F₉₀, 5, "ggx") cuts
  F₀ to 0..1, but neither F₉₀ nor a factor of the closure. Without a tangent, α_x ≠ α_y draws black.
"""

import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import bpy
import numpy as np
from mathutils import Matrix, Vector

ROWS, COLUMNS = 192, 384  # faces of the ball, from pole to pole and around


def main(material_file, request_file, result_file):
    request = dict(np.load(request_file))
    with TemporaryDirectory() as folder:
        if "wi" in request:
            scene = prepare_scene(side=4, samples=1, folder=folder)
            add_plane(make_material(Path(material_file), folder), float(request["turn"]))
            result = {"values": measure_values(scene, request["wi"], request["wo"])}
        else:
            scene = prepare_scene(int(request["side"]), int(request["samples"]), folder)
            add_ball(make_material(Path(material_file), folder))
            if "sun" in request:
                add_sun().matrix_world = look_from(request["sun"])
            else:
                add_environment(request["environment"])
            scene.camera.matrix_world = look_from(request["view"])
            result = {"picture": draw(scene)}
    np.savez(result_file, **result)


def prepare_scene(side, samples, folder):
    """Return an empty scene that Cycles draws with `side`² pixels, without tricks against noise."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    render, cycles = scene.render, scene.cycles
    render.engine = "CYCLES"
    render.resolution_x = render.resolution_y = side
    render.resolution_percentage = 100
    render.use_persistent_data = True  # ten times as fast
    render.threads_mode, render.threads = "FIXED", 1
    render.dither_intensity = 0
    image = render.image_settings
    image.file_format, image.color_depth, image.color_mode = "OPEN_EXR", "32", "RGB"
    render.filepath = str(Path(folder) / "picture.exr")
    scene.view_settings.view_transform = "Raw"
    cycles.device, cycles.samples = "CPU", samples
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.blur_glossy = cycles.light_sampling_threshold = 0
    cycles.max_bounces = 1
    # Rays through the centres of pixels; a box would be a pixel wide at least
    cycles.pixel_filter_type, cycles.filter_width = "GAUSSIAN", 0.01
    scene.camera = add_object(bpy.data.cameras.new("camera"))
    scene.camera.data.type, scene.camera.data.ortho_scale = "ORTHO", 2
    return scene


def make_material(path, folder):
    """Make the material of a .py or an .osl file, and return it."""
    if path.suffix == ".osl":
        return make_osl_material(path, folder)
    before = set(bpy.data.materials)
    sys.argv = [str(path)]
    program = compile(path.read_text(encoding="utf-8"), str(path), "exec")
    exec(program, {"__name__": "__main__", "__file__": str(path)})
    made = [material for material in bpy.data.materials if material not in before]
    if len(made) != 1:
        sys.exit(f"{path} made {len(made)} materials instead of one")
    if any(node.bl_idname == "ShaderNodeScript" for node in made[0].node_tree.nodes):
        bpy.context.scene.cycles.shading_system = True
    return made[0]


def make_osl_material(path, folder):
    """Make a material that draws with an .osl file.

    The wheel lacks the module with which Blender reads the inputs and outputs of a shader. It says
    so, and the node stays without sockets: they are added by hand.
    """
    import _cycles

    compiled = str(Path(folder) / "shader.oso")
    if not _cycles.osl_compile(str(path), compiled):
        sys.exit(f"Blender cannot compile {path}")
    bpy.context.scene.cycles.shading_system = True
    material = bpy.data.materials.new("osl")
    nodes, link = material.node_tree.nodes, material.node_tree.links.new
    nodes.clear()
    output, script = nodes.new("ShaderNodeOutputMaterial"), nodes.new("ShaderNodeScript")
    tangent = nodes.new("ShaderNodeTangent")
    tangent.direction_type = "UV_MAP"
    script.mode, script.filepath = "EXTERNAL", compiled
    if not script.outputs:
        script.inputs.new("NodeSocketVector", "Tangent")
        script.outputs.new("NodeSocketShader", "BSDF")
    link(tangent.outputs[0], script.inputs["Tangent"])
    link(script.outputs["BSDF"], output.inputs["Surface"])
    return material


def measure_values(scene, wi, wo):
    """Return the BRDF (n, 3) of the plane at directions to the light and to the camera (n, 3)."""
    sun, values = add_sun(), []
    scene.camera.data.ortho_scale = 0.1  # the plane fills the picture at all angles
    for to_light, to_camera in zip(wi, wo, strict=True):
        sun.matrix_world = look_from(to_light)
        sun.data.energy = 1 / to_light[2]  # so that the irradiance is 1
        scene.camera.matrix_world = look_from(to_camera)
        values.append(draw(scene).mean(axis=(0, 1)))
    return np.array(values)


def draw(scene):
    """Draw the picture and return it (side, side, 3), its first row on top."""
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    pixels = np.empty(len(image.pixels), dtype=np.float32)
    image.pixels.foreach_get(pixels)
    bpy.data.images.remove(image)
    side = scene.render.resolution_x
    return pixels.reshape(side, side, 4)[::-1, :, :3]


def look_from(direction):
    """Return the placement of a camera or sun that looks from a direction to the origin.

    The picture's upper edge is towards +z.
    """
    z = Vector([float(x) for x in direction]).normalized()
    x = Vector((0, 0, 1)).cross(z)
    x = x.normalized() if x.length > 1e-6 else Vector((1, 0, 0))
    return Matrix.LocRotScale(10 * z, Matrix((x, z.cross(x), z)).transposed(), None)


def add_object(data):
    added = bpy.data.objects.new(data.name, data)
    bpy.context.scene.collection.objects.link(added)
    return added


def add_sun():
    sun = bpy.data.lights.new("sun", "SUN")
    sun.angle, sun.energy = 0, 1
    return add_object(sun)


def add_environment(radiance):
    """Light the scene by radiances (h, w, 3) over polar angle and azimuth."""
    height, width = radiance.shape[:2]
    # Blender's pictures begin with the lowest row, and turn from +x to -y, with +x in the middle
    columns = (width // 2 - 1 - np.arange(width)) % width
    pixels = np.ones((height, width, 4), dtype=np.float32)
    pixels[:, :, :3] = radiance[::-1, columns]
    image = bpy.data.images.new("environment", width, height, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    image.pixels.foreach_set(pixels.ravel())
    image.pack()
    world = bpy.context.scene.world = bpy.data.worlds.new("world")
    world.cycles.sampling_method, world.cycles.sample_map_resolution = "MANUAL", 2048
    texture = world.node_tree.nodes.new("ShaderNodeTexEnvironment")
    texture.image = image
    background = next(n for n in world.node_tree.nodes if n.bl_idname == "ShaderNodeBackground")
    world.node_tree.links.new(texture.outputs["Color"], background.inputs["Color"])


def add_plane(material, turn):
    """Add a plane through the origin, facing +z, with u at the angle `turn` [rad] to +x."""
    x, y = np.array([[-5, 5, 5, -5], [-5, -5, 5, 5]], dtype=float)
    u, v = np.cos(turn) * x + np.sin(turn) * y, np.cos(turn) * y - np.sin(turn) * x
    add_mesh(np.stack([x, y, 0 * x], axis=1), [(0, 1, 2, 3)], np.stack([u, v], axis=1), material)


def add_ball(material):
    """Add a ball of the radius 1, with u along its circles of latitude and v to the north."""
    row, column = np.mgrid[: ROWS + 1, : COLUMNS + 1]
    theta, phi = np.pi * (1 - row / ROWS), 2 * np.pi * column / COLUMNS
    points = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], 2)
    uv = np.stack([column / COLUMNS, row / ROWS], axis=2).reshape(-1, 2)
    corner = (row * (COLUMNS + 1) + column)[:-1, :-1].ravel()
    corners = np.stack([corner, corner + 1, corner + COLUMNS + 2, corner + COLUMNS + 1], axis=1)
    points = points.reshape(-1, 3)
    mesh = add_mesh(points, corners.tolist(), uv[corners].reshape(-1, 2), material)
    mesh.polygons.foreach_set("use_smooth", np.ones(len(corners), dtype=bool))
    mesh.normals_split_custom_set_from_vertices(points)


def add_mesh(points, faces, uv, material):
    """Add a mesh of `points` (n, 3), with `uv` (corners, 2) for all corners of its faces."""
    mesh = bpy.data.meshes.new("mesh")
    mesh.from_pydata(points.tolist(), [], faces)
    mesh.uv_layers.new(name="UVMap").data.foreach_set("uv", uv.astype(np.float32).ravel())
    mesh.materials.append(material)
    add_object(mesh)
    return mesh


if __name__ == "__main__":
    main(*sys.argv[1:])
