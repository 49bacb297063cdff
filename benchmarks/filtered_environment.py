"""How near the methods of `filtered_environment` come to the truth: 80 scenes, as in a thesis.

    python benchmarks/filtered_environment.py PROBES MODELS OUT

Ball, teapot, bunny and torus × four light probes × Ward's lobe of five roughnesses α, without
shadows [Ergun 2015, section 9.3]. PROBES holds grace.hdr, uffizi.hdr, pisa.hdr and ennis.hdr (in
place of doge2), MODELS teapot.obj.xz and stanford-bunny.obj.xz (in place of the dragon). OUT gets
results.json, results.md and pictures; a run that was stopped goes on where it was.

The reference is direct light by multiple importance sampling without shadow rays, through the same
middles of pixels, and its noise floor is the PSNR of one half of its samples to the other, plus the
6 dB that the whole is better than their difference. PSNR is over the pixels of the object: of 8-bit
sRGB (peak 255), and of linear values (peak their 99.9th percentile). Every probe is scaled to the
same illuminance from above. The thesis states neither its PSNR, nor its tone mapping, BRDF or size.
"""

import argparse
import json
import lzma
import time
from pathlib import Path

import numpy as np

from brdfkit.colours import to_srgb
from brdfkit.files import write_safely
from brdfkit.picture_errors.psnr import psnr
from brdfkit.rendering.environment import environment
from brdfkit.rendering.preview import stage
from brdfkit.rendering.scene_loading import find_scene
from brdfkit.rendering.scenes._meshes import mesh_of_grid, revolve
from brdfkit.rendering.scenes._studio import studio
from brdfkit.rendering.shown_material import load_material, mask

PROBES = "grace", "uffizi", "pisa", "ennis"
SHAPES = "ball", "teapot", "bunny", "torus"
ROUGHNESSES = 0.01, 0.05, 0.1, 0.15, 0.2
MATERIAL = {"type": "ward", "diffuse_reflectance": 0.1, "specular_reflectance": 0.4}
METHODS = "gmm", "filtered_sampling", "kde", "warped"
FILTERS = "lobes", "mips"
PRINTED = {"kde": 61, "warped": 53, "filtered_sampling": 52}  # of the thesis's 80, with mips
SIZE, SAMPLES = 96, 4096
GOOD = 30  # dB


def define_reference(mi):
    """The class of an integrator: direct light of the environment, without shadows."""
    import drjit as dr

    class Unshadowed(mi.SamplingIntegrator):
        def __init__(self, props):
            super().__init__(props)
            self.samples, self.seed = props.get("samples", SAMPLES), props.get("seed", 0)

        def sample(self, scene, sampler, ray, medium=None, active=True):
            si = scene.ray_intersect(mi.Ray3f(ray), active)
            light, bsdf, context = scene.environment(), si.bsdf(), mi.BSDFContext()
            hit = active & si.is_valid()
            numbers = mi.load_dict({"type": "independent"})
            numbers.seed(self.seed, dr.width(ray))

            def one(i, total, numbers):
                # By the light
                ds, weight = light.sample_direction(si, numbers.next_2d(), hit)
                value, pdf = bsdf.eval_pdf(context, si, si.to_local(ds.d), hit)
                by_light = value * weight * mis(ds.pdf, pdf)
                # By the BSDF
                drawn, weight = bsdf.sample(context, si, numbers.next_1d(), numbers.next_2d(), hit)
                ds = mi.DirectionSample3f()
                ds.d = si.to_world(drawn.wo)
                seen = dr.zeros(mi.SurfaceInteraction3f)
                seen.wi = -ds.d
                chance = mis(drawn.pdf, light.pdf_direction(si, ds, hit))
                by_bsdf = weight * light.eval(seen, hit) * chance
                total = total + dr.select(hit, by_light + by_bsdf, 0)
                return i + 1, total, numbers

            _, total, _ = dr.while_loop(
                (mi.UInt32(0), mi.Color3f(0), numbers),
                lambda i, total, numbers: hit & (i < self.samples),
                one,
            )
            behind = light.eval(si, active & ~hit)
            return dr.select(hit, total / self.samples, behind), active, []

        def to_string(self):
            return "Unshadowed[]"

    def mis(ours, others):
        return dr.select(ours > 0, ours / (ours + others), 0)

    return Unshadowed


def shapes(models, scratch):
    """Functions of (BSDF, size) → dictionary of a scene, by the name of the shape."""
    for name in ("teapot", "stanford-bunny"):
        with lzma.open(models / f"{name}.obj.xz") as packed:
            (scratch / f"{name}.obj").write_bytes(packed.read())

    def torus(bsdf, size):
        phi = np.linspace(0, 2 * np.pi, 97)
        phi[-1] = 0  # the profile closes
        points, normals = revolve(0.68 + 0.32 * np.cos(phi), 0.32 * np.sin(phi))
        turn = np.array([[1, 0, 0], [0, 0.64, 0.768375], [0, -0.768375, 0.64]])  # towards the eye
        points = points @ turn + [0, 0, 1]
        return studio(size) | {"torus": mesh_of_grid(points, normals @ turn, bsdf)}

    return {
        "ball": find_scene("ball"),
        "teapot": find_scene(scratch / "teapot.obj"),
        "bunny": find_scene(scratch / "stanford-bunny.obj"),
        "torus": torus,
    }


def decibels(reference, picture, seen):
    """(PSNR of 8-bit sRGB, PSNR of linear values), over the pixels `seen`."""
    a, b = (np.round(255 * to_srgb(p[seen].astype(float))) for p in (reference, picture))
    eight = 10 * np.log10(255**2 / max(np.mean((a - b) ** 2), 1e-12))
    return round(float(eight), 2), round(psnr(reference, picture, seen), 2)


def render(mi, made, light, integrator):
    """The picture of a scene's dictionary by an integrator, and the seconds of CPU time."""
    scene = mi.load_dict(stage(made, light, integrator, 1))
    start = time.process_time()
    picture = np.array(scene.integrator().render(scene, seed=0, spp=1))[..., :3]
    return picture, time.process_time() - start, scene


def integrators(mi):
    """Integrators by (method, filter, α): light is shared by filters, lobes by methods and α."""
    found = {}
    for filter_ in FILTERS:
        for method in METHODS:
            for alpha in ROUGHNESSES:
                entries = {"type": "filtered_environment", "method": method, "filter": filter_}
                made = found[method, filter_, alpha] = mi.load_dict(entries)
                made.light = found["gmm", filter_, ROUGHNESSES[0]].light
                made.shading = found[method, FILTERS[0], alpha].shading
    return found


def run(mi, probes, models, out):
    """Render what is not in `out` yet; returns the results by the name of the scene."""
    results_file, pictures = out / "results.json", out / "pictures"
    pictures.mkdir(parents=True, exist_ok=True)
    results = json.loads(results_file.read_text()) if results_file.exists() else {}
    makers, methods = shapes(models, pictures), integrators(mi)
    materials = {
        alpha: load_material(MATERIAL | {"alpha_u": alpha, "alpha_v": alpha}, "ward", True)
        for alpha in ROUGHNESSES
    }
    for probe in PROBES:
        light = mi.load_dict(environment(probes / f"{probe}.hdr"))
        for shape in SHAPES:
            for alpha, material in materials.items():
                name = f"{shape} {probe} {alpha:g}"
                if name in results:
                    continue
                made = makers[shape](material, (SIZE, SIZE))
                halves = []
                for seed in (1, 2):
                    entries = {"type": "unshadowed", "samples": SAMPLES // 2, "seed": seed}
                    half, seconds, scene = render(mi, made, light, mi.load_dict(entries))
                    halves.append(half)
                reference, seen = np.mean(halves, axis=0), mask(scene, material)
                floor = [round(d + 6.02, 2) for d in decibels(*halves, seen)]
                found = {"noise floor": floor, "reference seconds": round(2 * seconds, 3)}
                row = [reference]
                for method in METHODS:
                    for filter_ in FILTERS:
                        integrator = methods[method, filter_, alpha]
                        render(mi, made, light, integrator)  # fits, filters and compiles
                        picture, seconds, _ = render(mi, made, light, integrator)
                        found[f"{method} {filter_}"] = {
                            "psnr": decibels(reference, picture, seen),
                            "seconds": round(seconds, 4),
                        }
                        row.append(picture)
                results[name] = found
                np.savez_compressed(pictures / f"{name}.npz", pictures=row, seen=seen)
                with write_safely(results_file) as beside:
                    beside.write_text(json.dumps(results, indent=1))
                told = [f"{k} {found[k]['psnr'][0]:.1f}" for k in found if k.endswith(FILTERS)]
                print(f"{name}: noise floor {floor[0]:.1f} dB;", ", ".join(told), flush=True)
    return results


def table(columns, rows):
    """A table in Markdown."""
    lines = [columns, ["---"] * len(columns), *rows]
    return "\n".join("| " + " | ".join(map(str, line)) + " |" for line in lines) + "\n"


def report(results, times):
    """The page: scenes over 30 dB by method, PSNR by roughness, and times."""
    kinds = [f"{method} {filter_}" for filter_ in FILTERS for method in METHODS]
    values = {kind: np.array([found[kind]["psnr"] for found in results.values()]) for kind in kinds}
    alpha = np.array([float(name.split()[-1]) for name in results])
    floor = np.array([found["noise floor"] for found in results.values()])
    rows, by_alpha = [], []
    for kind in kinds:
        over = (values[kind] >= GOOD).sum(axis=0)
        mean, worst = values[kind].mean(axis=0), values[kind].min(axis=0)
        method, filter_ = kind.split()
        thesis = PRINTED.get(method, "not stated") if filter_ == "mips" else ""
        rows.append([kind, over[0], thesis, f"{mean[0]:.1f}", f"{worst[0]:.1f}", over[1]])
        means = [values[kind][alpha == a, 0].mean() for a in ROUGHNESSES]
        by_alpha.append([kind, *(f"{m:.1f}" for m in means)])
    slowest = times["filtered_sampling mips"]
    speed = [[k, f"{1000 * t:.1f}", f"{slowest / t:.1f}"] for k, t in times.items()]
    counts = f"scenes of {len(results)} over {GOOD} dB"
    columns = ["method", counts, "thesis", "mean dB", "worst dB", "over, linear"]
    roughness = [f"α = {a:g}" for a in ROUGHNESSES]
    return "\n".join(
        [
            "# The methods of filtered_environment on the grid of a thesis\n",
            f"{__doc__.split(chr(10) * 2, 2)[2]}",
            f"Noise floor of the references: {floor[:, 0].min():.1f} dB or more (sRGB), "
            f"{floor[:, 1].min():.1f} dB or more (linear).\n",
            table(columns, rows),
            "Mean PSNR [dB] by roughness:\n",
            table(["method", *roughness], by_alpha),
            "CPU time of a ball of 256 × 256 pixels under grace, α = 0.1, the least of five; the\n"
            "thesis's speeds are warped 10.6 : kde 3.3 : gmm 2.0 : filtered_sampling 1.\n",
            table(["method", "ms", "speed"], speed),
            "blocks.png: the reference; gmm with the nearest of its views; between its views.\n",
            "roughness.png: a row per α; the reference, then "
            f"{', '.join(f'{m} {f}' for m in METHODS for f in FILTERS)}.\n",
        ]
    )


def measure_times(mi, probes):
    """The least CPU time [s] of five, by method and filter."""
    light, alpha = mi.load_dict(environment(probes / "grace.hdr")), 0.1
    material = load_material(MATERIAL | {"alpha_u": alpha, "alpha_v": alpha}, "ward")
    made, found = find_scene("ball")(material, (256, 256)), {}
    for (method, filter_, a), integrator in integrators(mi).items():
        if a == alpha:
            seconds = [render(mi, made, light, integrator)[1] for _ in range(6)]
            found[f"{method} {filter_}"] = min(seconds[1:])
    return found


def show_blocks(mi, probes, out):
    """The ball of gmm with the nearest of few views, as in the thesis, and between them."""
    light = mi.load_dict(environment(probes / "grace.hdr"))
    material = load_material(MATERIAL | {"alpha_u": 0.05, "alpha_v": 0.05}, "ward")
    made = find_scene("ball")(material, (256, 256))
    row = [render(mi, made, light, mi.load_dict({"type": "unshadowed", "samples": SAMPLES}))[0]]
    for nearest in (True, False):
        integrator = mi.load_dict({"type": "filtered_environment", "method": "gmm"})
        lobes = integrator.shading.fit(material)
        if nearest:
            lobes.around = nearest_view(lobes.around)
        integrator.shading.fit = lambda bsdf, lobes=lobes: lobes
        row.append(render(mi, made, light, integrator)[0])
    save(out / "blocks.png", [row])


def nearest_view(around):
    """A function as `ViewedLobes.around`, whose views all count as the nearest of them."""
    import drjit as dr

    def found(wo):
        ((low, share), (high, _)), sin, cos = around(wo)
        return [(dr.select(share > 0.5, low, high), 1.0)], sin, cos

    return found


def show_roughness(out):
    """Balls under grace: a row per roughness, the reference and then the methods."""
    rows = []
    for alpha in ROUGHNESSES:
        with np.load(out / "pictures" / f"ball grace {alpha:g}.npz") as kept:
            rows.append(list(kept["pictures"]))
    save(out / "roughness.png", rows)


def save(path, rows):
    """Write rows of pictures (height, width, 3), linear, as one PNG."""
    from PIL import Image

    page = np.concatenate([np.concatenate(row, axis=1) for row in rows])
    Image.fromarray(np.round(255 * to_srgb(page)).astype(np.uint8)).save(path)


def main():
    import mitsuba as mi

    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    for name in ("probes", "models", "out"):
        parser.add_argument(name, type=Path)
    given = parser.parse_args()
    mi.set_variant("llvm_ad_rgb")
    mi.register_integrator("unshadowed", lambda props: define_reference(mi)(props))
    results = run(mi, given.probes, given.models, given.out)
    page = report(results, measure_times(mi, given.probes))
    (given.out / "results.md").write_text(page, encoding="utf-8")
    show_blocks(mi, given.probes, given.out)
    show_roughness(given.out)
    print(page)


if __name__ == "__main__":
    main()
