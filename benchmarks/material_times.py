"""Times of live materials: the first picture, a changed parameter, a moved camera, a turned light.

python benchmarks/material_times.py [MODEL ...]

Each picture has 256² pixels and is encoded as the page gets it. Of several pictures the least time
is printed, [ms] on the clock and of all cores together, because other programs may run beside it.
"""

import sys
import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np

import brdfkit as bk
from brdfkit.core.colours import to_srgb
from brdfkit.model.labels import model as find_model
from brdfkit.viewing.encoding import encode_jpeg
from brdfkit.viewing.materials.live_light import LAMP, LiveLights
from brdfkit.viewing.materials.live_material import LiveMaterial
from brdfkit.viewing.materials.material_scene import Look, SceneKind, make_studio_camera
from brdfkit.viewing.materials.parameter_groups import place_between_bounds

SIZE = (256, 256)
PICTURES = 12  # that are timed for each parameter
MODELS = *bk.models(), "lambert+ward", "oren_nayar+ggx"
MOVING, TRACED = (SceneKind("ball", "studio", SIZE, moving) for moving in (True, False))
LIT_BY_LAMP = replace(MOVING, light=LAMP)
STUDIO = Look(make_studio_camera())


def measure(show: Callable[[int], object], count: int = PICTURES) -> str:
    """Show pictures by number, and return the least times [ms] on the clock and of all cores."""
    clock, cores = [], []
    for k in range(count):
        start = time.perf_counter(), time.process_time()
        show(k)
        clock.append(time.perf_counter() - start[0])
        cores.append(time.process_time() - start[1])
    return f"{1e3 * min(clock):5.0f} /{1e3 * min(cores):5.0f}"


def show(live: LiveMaterial, kind: SceneKind, look: Look) -> None:
    """Render a picture and encode it."""
    encode_jpeg(np.rint(255 * to_srgb(live.render(kind, look))).astype(np.uint8))


def time_parameter(live: LiveMaterial, name: str, kind: SceneKind, start: float) -> str:
    """Time pictures of a moving parameter, which goes on from a share `start` of its range."""
    parameter = live.material.parameters[name]

    def move(k: int) -> None:
        share = start + 0.02 * (k + 1)
        value = 0.5 * share if parameter.linear else place_between_bounds(parameter, share)
        live.show(live.material.changed(**{name: value}))
        show(live, kind, STUDIO)

    move(-2), move(-1)  # compile
    return measure(move)


def main() -> None:
    """Print a line for each model, and lines for the camera, the light and a measured material."""
    lights = LiveLights()
    print("first picture of a material", end="", flush=True)
    print(measure(lambda k: show(LiveMaterial(bk.models()["ggx"](), lights), MOVING, STUDIO), 1))
    print(f"{'model':20}  first        a parameter, moving    traced        with a lamp")
    for label in sys.argv[1:] or MODELS:
        live = LiveMaterial(find_model(label)(), lights)
        first = measure(lambda k, live=live: show(live, MOVING, STUDIO), 1)
        name = list(live.material.parameters)[-1]
        kinds = zip((MOVING, TRACED, LIT_BY_LAMP), (0.1, 0.4, 0.7), strict=True)
        times = [time_parameter(live, name, kind, start) for kind, start in kinds]
        print(f"{label:20} {first}   {'   '.join(times)}   ({name})", flush=True)
    for material in (bk.models()["ggx"](), bk.load("car_paint")):
        live = LiveMaterial(material, lights)
        show(live, MOVING, STUDIO)
        turned = [replace(STUDIO, turn=5.0 * k) for k in range(PICTURES)]
        moved = [replace(STUDIO, camera=replace(STUDIO.camera, azimuth=5.0 * k)) for k in range(99)]
        camera = measure(lambda k, live=live, looks=moved: show(live, MOVING, looks[k]))
        light = measure(lambda k, live=live, looks=turned: show(live, MOVING, looks[k]))
        print(f"{material.name:20} camera {camera}   light {light}")


if __name__ == "__main__":
    main()
