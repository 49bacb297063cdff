"""Draws from each phase function, and renders pictures with it, to measure the times."""

import drjit as dr

from brdfkit.mitsuba_bridge import phase_functions
from brdfkit.theses.timing import wait_for

DRAWS, REPEATS = 1 << 20, 16  # threads, and draws of each, whose time is measured
SIZE, SPP = 256, 16  # pixels along an edge of the measured picture, and samples of each
G, K = 0.6, 0.8112


def sample_henyey_greenstein(u):
    """Return the cosine μ for a random number u, by Henyey-Greenstein's inverse, eq. 5.59."""
    s = 2 * u - 1
    return (1 + G * G - dr.square((1 - G * G) / (1 + G * s))) / (2 * G)


def sample_schlick(k, u):
    """Return the cosine μ for a random number u, by Schlick's inverse; k > 0 is forward."""
    s = 2 * u - 1
    return (s + k) / (1 + k * s)


def sample_rayleigh(u, root=dr.cbrt):
    """Return the cosine μ for a random number u, by Rayleigh's inverse, eq. 5.67."""
    s = 4 * u - 2
    r = (s * s + 1) ** 0.5
    return root(s + r) + root(s - r)


def sample_two_lobes(u):
    """Return the cosine μ by one of two of Schlick's lobes, which were fitted to `Mie hazy`."""
    first = u < 0.1738
    u = dr.select(first, u / 0.1738, (u - 0.1738) / (1 - 0.1738))
    return sample_schlick(dr.select(first, -0.4460, 0.7297), u)


def sample_mie(u, n):
    """Return the cosine μ of `mie_hazy` or `mie_murky`.

    One number u both chooses the half of the mixture and places μ in it.
    """
    return phase_functions.draw_cosine(n, u, dr.select(u < 0.5, 2 * u, 2 * u - 1))


def list_samplers():
    """Return functions from random numbers to cosines, by name."""
    return {
        "Henyey-Greenstein": sample_henyey_greenstein,
        "Schlick": lambda u: sample_schlick(K, u),
        "Rayleigh": sample_rayleigh,
        "Mie hazy": lambda u: sample_mie(u, 8),
        "Mie murky": lambda u: sample_mie(u, 32),
        "two of Schlick's": sample_two_lobes,
    }


def list_plugins(fits):
    """Return the phase functions as plugins by name, the last one the fit to `Mie hazy`."""
    r, *ks = fits["Mie hazy"][0]
    lobes = ({"type": "schlick", "k": float(k)} for k in ks)
    mixture = {"type": "blendphase", "weight": 1 - float(r), **dict(zip("ab", lobes, strict=True))}
    return {
        "Henyey-Greenstein": {"type": "hg", "g": G},
        "Schlick": {"type": "schlick", "k": K},
        "Rayleigh": {"type": "rayleigh"},
        "Mie hazy": {"type": "mie_hazy"},
        "Mie murky": {"type": "mie_murky"},
        "two of Schlick's": mixture,
    }


def prepare_picture(phase):
    """Return a function that renders a picture of even smoke with a phase function."""
    import mitsuba as mi

    camera = mi.ScalarTransform4f().look_at([1.9, 1.1, 2.2], [0.5, 0.5, 0.5], [0, 1, 0])
    film = {"type": "hdrfilm", "width": SIZE, "height": SIZE, "rfilter": {"type": "box"}}
    smoke = {"type": "single_scattering", "extinction": 2.0, "albedo": 0.8, "phase": phase}
    scene = mi.load_dict(
        {
            "type": "scene",
            "integrator": smoke,
            "sensor": {"type": "perspective", "fov": 40, "to_world": camera, "film": film},
            "sky": {"type": "constant", "radiance": 0.6},
        },
        parallel=False,
    )

    return lambda: mi.render(scene, spp=SPP).numpy()


def prepare_draws(draw):
    """Return a function that draws by a sampler many times, in one kernel that sums the cosines."""
    import mitsuba as mi

    def draw_all():
        numbers = mi.PCG32(DRAWS)

        def add_draw(i, total, numbers):
            return i + 1, total + draw(numbers.next_float32()), numbers

        state = mi.UInt32(0), mi.Float(0), numbers
        _, total, _ = dr.while_loop(state, lambda i, *_: i < REPEATS, add_draw)
        wait_for(total)

    return draw_all
