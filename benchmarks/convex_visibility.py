"""Measures shadows of convex parts beside those of triangles and of height fields.

    python benchmarks/convex_visibility.py MODELS RESULTS

MODELS is a folder of OBJ meshes, plain or compressed; RESULTS a folder for results.json, results.md
and frames.png, an object that moves, shaded by its parts (above) and its triangles (below). What
results.json has is not measured again: a run that was stopped goes on.

C7 to C10 are the claims of [Ergun 2015] on convex visibility. Pictures of one mesh are rendered by
the integrator `convex_direct` with the same samples, so that they differ by their shadows alone.
PSNR is stated twice: of linear values over all pixels, with the 99.9th percentile as the peak, and
of values as they are shown (sRGB, clipped at the 95th percentile of the picture, peak 1).
"""

import json
import math
import sys
import time
from pathlib import Path

import numpy as np

import brdfkit as bk
from brdfkit.catalogue.shipped import environment_path
from brdfkit.files import contents, make_folder, write_safely
from brdfkit.picture_errors.psnr import psnr
from brdfkit.visibility.decomposition import CONCAVITY, decompose
from brdfkit.visibility.height_fields import HeightFields
from brdfkit.visibility.occluders import RESOLUTION, Occluders

SIZE, SPP = 128, 128
STUDY = "spot"  # the mesh of the sweeps
CONCAVITIES = 0.02, 0.03, 0.05, 0.1, 0.2, 0.4
RESOLUTIONS = 8, 16, 32, 64, 128, 256
CLEARANCES = 0.0, 0.005, 0.01, 0.02, 0.04
MOVES, FRAMES = 20, 6


def main(models, results):
    import mitsuba as mi

    mi.set_variant("llvm_ad_rgb")
    make_folder(results)
    done = Done(Path(results) / "results.json")
    meshes = {path.name.split(".")[0]: path for path in sorted(Path(models).glob("*.obj*"))}
    for name, path in meshes.items():
        done.measure(f"mesh {name}", lambda path=path: of_mesh(path))
    if STUDY in meshes:
        study = meshes[STUDY]
        for c in CONCAVITIES:
            done.measure(f"concavity {c:g}", lambda c=c: of_settings(study, concavity=c))
            done.measure(
                f"without-clearance {c:g}",
                lambda c=c: of_settings(study, concavity=c, clearance=0.0),
            )
        for r in RESOLUTIONS:
            done.measure(f"resolution {r}", lambda r=r: of_settings(study, resolution=r))
        for c in CLEARANCES:
            done.measure(f"clearance {c:g}", lambda c=c: of_settings(study, clearance=c))
        done.measure("moves", lambda: of_moves(study))
        done.measure("frames", lambda: frames(study, Path(results) / "frames.png"))
    with write_safely(Path(results) / "results.md") as beside:
        beside.write_text(page(done.values), encoding="utf-8")


class Done:
    """The results so far, kept in a file."""

    def __init__(self, file):
        self.file = file
        self.values = json.loads(file.read_text(encoding="utf-8")) if file.exists() else {}

    def measure(self, name, function):
        """The result of `function`, called unless the file has it, under this `name`."""
        if name not in self.values:
            print(name, flush=True)
            self.values[name] = function()
            with write_safely(self.file) as beside:
                beside.write_text(json.dumps(self.values, indent=1), encoding="utf-8")


# What is measured


def of_mesh(path):
    """C7, C8, C9 of a mesh at the default settings."""
    points, faces = mesh_of(path)
    parts = decompose(points, faces)
    if not parts:
        return {"parts": 0}
    study = Study(points, faces)
    convex, fields = Occluders({"mesh": parts}), HeightFields(points, faces)
    return {
        "triangles": len(faces),
        "parts": len(parts),
        "convex": study.quality(convex) | study.reads(convex),
        "height fields": study.quality(fields) | study.reads(fields),
        "look-ups per test": study.lookups_per_test(convex),
    }


def of_settings(path, concavity=CONCAVITY, **settings):
    """The quality of convex shadows by their settings."""
    points, faces = mesh_of(path)
    parts = decompose(points, faces, concavity=concavity)
    found = Study(points, faces).quality(Occluders({"mesh": parts}, **settings))
    return found | {"parts": len(parts)}


def of_moves(path):
    """Seconds of CPU for a rigid motion: of the parts; of Mitsuba's tree over the triangles; and
    of the small tree over Mitsuba's instances, whose own triangles rest."""
    import mitsuba as mi

    points, faces = mesh_of(path)
    occluders = Occluders({"mesh": decompose(points, faces)})
    mesh = mi.load_dict({"type": "scene", "mesh": mitsuba_mesh(points, faces)})
    group = {"type": "shapegroup", "mesh": mitsuba_mesh(points, faces)}
    instance = {"type": "instance", "group": {"type": "ref", "id": "group"}}
    instance = mi.load_dict({"type": "scene", "group": group, "instance": instance})
    at = mi.ScalarTransform4f
    turns = [at().rotate([0, 1, 0], 360 * i / MOVES) for i in range(MOVES)]
    matrices = [np.array(turn.matrix) for turn in turns]
    moved = [(points @ turn[:3, :3].T).astype(np.float32).ravel() for turn in matrices]
    return {
        "parts": median_seconds(lambda turn: occluders.move("mesh", turn), matrices),
        "triangles": median_seconds(update(mesh, "mesh.vertex_positions", mi.Float), moved),
        "instance": median_seconds(update(instance, "instance.to_world", mi.Transform4f), turns),
    }


def frames(path, file):
    """Pictures of a mesh that jumps and turns; the PSNR of each against shadows of triangles."""
    import mitsuba as mi
    from PIL import Image

    points, faces = mesh_of(path)
    study, occluders = Study(points, faces), Occluders({"mesh": decompose(points, faces)})
    parameters = mi.traverse(study.scene)
    at, strip, errors = mi.ScalarTransform4f, [], []
    for phase in np.arange(FRAMES) / FRAMES:
        turn = at().translate([0, 0.6 * math.sin(math.pi * phase), 0])
        matrix = np.array(turn.rotate([0, 1, 0], 360 * phase).matrix)
        moved = points @ matrix[:3, :3].T + matrix[:3, 3]
        parameters["mesh.vertex_positions"] = mi.Float(moved.astype(np.float32).ravel())
        parameters.update()  # for what the camera sees
        occluders.move("mesh", matrix)
        casters = (occluders, study.ground), (None, study.scene)
        pair = [study.render(*by, SPP)[0] for by in casters]
        errors.append(psnr(pair[1], pair[0]))
        strip.append(np.concatenate(pair))
    shown = srgb(np.clip(np.concatenate(strip, axis=1) / np.percentile(strip, 95), 0, 1))
    Image.fromarray((255 * shown).astype(np.uint8)).save(file)
    return {"psnr": errors}


def update(scene, key, kind):
    """A function that sets a parameter of a scene to a value and waits until rays see it."""
    import drjit as dr
    import mitsuba as mi

    parameters, ray = mi.traverse(scene), mi.Ray3f([0, 0, 9], [0, 0, -1])

    def set_to(value):
        parameters[key] = kind(value)
        parameters.update()
        dr.eval(scene.ray_test(ray))
        dr.sync_thread()

    return set_to


def median_seconds(function, values):
    """Median seconds of CPU of a call of `function` with each of the `values`."""
    seconds = []
    for value in values:
        start = time.process_time()
        function(value)
        seconds.append(time.process_time() - start)
    return float(np.median(seconds))


class Study:
    """A mesh on a ground under the shipped environment `studio`, rendered with several shadows."""

    def __init__(self, points, faces):
        import mitsuba as mi

        at = mi.ScalarTransform4f
        film = {"type": "hdrfilm", "width": SIZE, "height": SIZE, "rfilter": {"type": "box"}}
        camera = at().look_at([2.5, 2, 4.2], [0, -0.05, 0], [0, 1, 0])
        low = at().translate([0, float(points[:, 1].min()), 0])
        ground = {"type": "rectangle", "to_world": low.rotate([1, 0, 0], -90).scale(4)}
        self.ground = mi.load_dict({"type": "scene", "ground": ground})
        self.scene = mi.load_dict(
            {
                "type": "scene",
                "integrator": {"type": "convex_direct"},
                "sensor": {"type": "perspective", "fov": 32, "to_world": camera, "film": film},
                "light": {"type": "kdtree_envmap", "filename": str(environment_path("studio"))},
                "mesh": mitsuba_mesh(points, faces),
                "ground": ground,
            },
            parallel=False,
        )
        self.exact, self.seconds = self.render(None, self.scene, SPP)

    def render(self, occluders, others, spp):
        """A picture with the shadows of `occluders` and those of a scene; seconds of CPU."""
        integrator = self.scene.integrator()
        integrator.casters.set(self.scene, occluders, others)
        integrator.render(self.scene, seed=0, spp=1)  # compiled
        start = time.process_time()
        picture = np.array(integrator.render(self.scene, seed=0, spp=spp))[..., :3]
        return picture, time.process_time() - start

    def quality(self, occluders):
        picture, seconds = self.render(occluders, self.ground, SPP)
        scale = 1 / np.percentile(self.exact, 95)
        shown = [srgb(np.clip(x * scale, 0, 1)) for x in (self.exact, picture)]
        return {
            "psnr": psnr(self.exact, picture),
            "psnr shown": float(-10 * np.log10(np.mean((shown[0] - shown[1]) ** 2))),
            "brightness": float(picture.mean() / self.exact.mean()),
            "time / triangles": seconds / self.seconds,
        }

    def reads(self, occluders):
        """Reads of maps per pixel for the two shadow rays of one sample."""
        counting = Counting(occluders)
        self.render(counting, self.ground, 1)
        reads = sum(np.array(found, float) for found in counting.reads[-2:])
        return {"reads": float(reads.mean()), "deviation": float(reads.std())}

    def lookups_per_test(self, occluders):
        """Mean look-ups in the map of a part whose sphere a ray enters."""
        enter = occluders._enter

        def counted(ray, part, active):
            t, entered, count = enter(ray, part, active)
            return t, entered, count + (count > 0) * 2**16  # tests in the upper half

        occluders._enter = counted
        counting = Counting(occluders)
        self.render(counting, self.ground, 1)
        del occluders._enter
        tested = np.concatenate([np.array(found) for found in counting.reads[-2:]])
        return float((tested & 0xFFFF).sum() / (tested >> 16).sum())


class Counting:
    """Occluders that remember the reads of all rays."""

    def __init__(self, occluders):
        self.occluders, self.reads = occluders, []

    def blocked(self, ray, active=True):
        import drjit as dr

        blocked, reads = self.occluders.blocked(ray, active)
        dr.schedule(reads)
        self.reads.append(reads)
        return blocked, reads


# Meshes


def mesh_of(path):
    """The points and triangles of an OBJ file, its longest side from -1 to 1."""
    points, faces = [], []
    for line in contents(path).decode().splitlines():
        kind, *words = line.split() or [""]
        if kind == "v":
            points.append([float(word) for word in words[:3]])
        if kind == "f":
            corners = [int(word.split("/")[0]) for word in words]
            corners = [i - 1 if i > 0 else len(points) + i for i in corners]
            faces += [[corners[0], *corners[k : k + 2]] for k in range(1, len(corners) - 1)]
    points, faces = np.array(points), np.array(faces)
    points = points - (points.min(axis=0) + points.max(axis=0)) / 2
    return points * 2 / np.ptp(points, axis=0).max(), faces


def mitsuba_mesh(points, faces):
    """A grey mesh, seen from both sides."""
    import mitsuba as mi

    properties = mi.Properties()
    grey = {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.5}}
    properties["bsdf"] = mi.load_dict({"type": "twosided", "material": grey})
    mesh = mi.Mesh("mesh", len(points), len(faces), properties)
    buffers = mi.traverse(mesh)
    buffers["vertex_positions"] = points.astype(np.float32).ravel()
    buffers["faces"] = faces.astype(np.uint32).ravel()
    buffers.update()
    return mesh


def srgb(x):
    return np.where(x < 0.0031308, 12.92 * x, 1.055 * np.maximum(x, 1e-9) ** (1 / 2.4) - 0.055)


# The page


def page(values):
    """The results as Markdown."""
    lines = [
        "# Convex visibility, measured",
        "",
        f"brdfkit {bk.__version__}; pictures of {SIZE}² pixels, {SPP} samples; concavity "
        f"{CONCAVITY}, maps of {RESOLUTION} texels. PSNR [dB]: linear, and as shown.",
        "",
        "| mesh | triangles | parts | convex | height fields | reads, convex | reads, fields "
        "| look-ups per test |",
        "| --- | --- | --- | --- | --- | --- | --- | --- |",
    ]
    for name, found in values.items():
        if name.startswith("mesh ") and found["parts"]:
            convex, fields = found["convex"], found["height fields"]
            cells = [
                name[5:],
                found["triangles"],
                found["parts"],
                *(f"{x['psnr']:.1f}, {x['psnr shown']:.1f}" for x in (convex, fields)),
                *(f"{x['reads']:.2f} ± {x['deviation']:.2f}" for x in (convex, fields)),
                f"{found['look-ups per test']:.2f}",
            ]
            lines.append("| " + " | ".join(map(str, cells)) + " |")
        elif name.startswith("mesh "):
            lines.append(f"| {name[5:]} | encloses no volume: has no parts | | | | | | |")
    for sweep in ("concavity", "without-clearance", "resolution", "clearance"):
        lines += ["", f"| {sweep} ({STUDY}) | parts | PSNR | shown | time / triangles |"]
        lines += ["| --- | --- | --- | --- | --- |"]
        lines += [
            f"| {name.split()[1]} | {x['parts']} | {x['psnr']:.1f} | {x['psnr shown']:.1f} "
            f"| {x['time / triangles']:.2f} |"
            for name, x in values.items()
            if name.startswith(f"{sweep} ")
        ]
    if "moves" in values:
        parts, triangles, instance = (1e3 * seconds for seconds in values["moves"].values())
        lines += [
            "",
            f"A rigid motion of {STUDY}: {parts:.2f} ms of CPU for the parts, {triangles:.2f} ms "
            f"for Mitsuba's tree over the triangles ({triangles / parts:.0f} times as much), "
            f"{instance:.2f} ms for a Mitsuba instance ({instance / parts:.0f} times as much).",
        ]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    main(*sys.argv[1:])
