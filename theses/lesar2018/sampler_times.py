"""How long a draw by each phase function takes, and a picture with it."""

import drjit as dr

from brdfkit.mitsuba_bridge import phase_functions
from brdfkit.theses.claims import measure_least_seconds

DRAWS, TURNS = 1 << 20, 16  # of which the time is taken
SIZE, SPP = 256, 16  # of the picture
G, K = 0.6, 0.8112


def henyey_greenstein(u):
    """μ by eq. 5.59."""
    s = 2 * u - 1
    return (1 + G * G - dr.square((1 - G * G) / (1 + G * s))) / (2 * G)


def by_schlick(k, u):
    """μ by eq. 5.63, with the sign of Henyey-Greenstein's."""
    s = 2 * u - 1
    return (s + k) / (1 + k * s)


def by_rayleigh(u, root=dr.cbrt):
    """μ by eq. 5.67."""
    s = 4 * u - 2
    r = (s * s + 1) ** 0.5
    return root(s + r) + root(s - r)


def two_lobes(u):
    """μ of one of two lobes of Schlick's: those of the fit to `Mie hazy`."""
    first = u < 0.1738
    u = dr.select(first, u / 0.1738, (u - 0.1738) / (1 - 0.1738))
    return by_schlick(dr.select(first, -0.4460, 0.7297), u)


def mie(u, n):
    """μ of `mie_hazy` or `mie_murky`; one number both chooses the half and places μ in it."""
    return phase_functions.draw_even_and_forward_cosine(n, u, dr.select(u < 0.5, 2 * u, 2 * u - 1))


def samplers():
    """Name → a function from ξ to μ."""
    return {
        "Henyey-Greenstein": henyey_greenstein,
        "Schlick": lambda u: by_schlick(K, u),
        "Rayleigh": by_rayleigh,
        "Mie hazy": lambda u: mie(u, 8),
        "Mie murky": lambda u: mie(u, 32),
        "two of Schlick's": two_lobes,
    }


def plugins(fits):
    """Name → the phase function as a plugin, the last one the fit to `Mie hazy`."""
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


def over_the_first(seconds):
    """Times over that of the first."""
    first = next(iter(seconds.values()))
    return {name: s / first for name, s in seconds.items()}


def time_of_picture(phase):
    """Seconds of CPU of a picture of even smoke with a phase function."""
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

    def picture():
        mi.render(scene, spp=SPP).numpy()

    picture()  # compiles
    return measure_least_seconds(picture)


def time_of(draw):
    """Seconds of CPU of the draws of a sampler, one kernel that keeps a sum of each thread."""
    import mitsuba as mi

    def drawn():
        numbers = mi.PCG32(DRAWS)

        def turn(i, total, numbers):
            return i + 1, total + draw(numbers.next_float32()), numbers

        state = mi.UInt32(0), mi.Float(0), numbers
        _, total, _ = dr.while_loop(state, lambda i, *_: i < TURNS, turn)
        dr.eval(total)
        dr.sync_thread()

    drawn()  # compiles
    return measure_least_seconds(drawn)
