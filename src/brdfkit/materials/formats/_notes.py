"""Notes about doubtful samples, which the readers of formats add; no sample is changed."""

import numpy as np

from brdfkit.materials.formats._writing import sample_angles

SUSPICIOUS = 5  # times the next largest value


def note_lone_point(samples):
    """A note, by its key, if one sample at grazing mirror reflection stands out; otherwise none.

    It is more than 5 times as bright as any other. Every file of Cornell's instrument has one.
    """
    samples = samples.at(samples.valid)
    brightest = samples.values.max(axis=1)
    top = int(np.argmax(brightest))
    theta_i, phi_i, theta_s, phi_s = np.degrees(sample_angles(samples))[:, top]
    others = np.delete(brightest, top)
    near_grazing = theta_i > 79.5 and theta_s > 78.5 and abs(abs(phi_s - phi_i) - 180) < 0.5
    if not near_grazing or not others.size or brightest[top] <= SUSPICIOUS * others.max():
        return {}
    return {
        "suspicious": f"the sample at theta_i {theta_i:.0f}°, theta_s {theta_s:.0f}° in the "
        f"mirror's azimuth is {brightest[top] / others.max():.1f} times the next largest"
    }


def note_short_rings(samples):
    """A note, by its key, if rings of views leave out the mirror's azimuth; otherwise none.

    A ring is the samples with one theta_i and one theta_s. Cornell's instrument measured every ring
    up to Δφ = 180°. Its files are sorted so that a file that is cut short ends within a ring.
    """
    theta_i, phi_i, theta_s, phi_s = np.round(np.degrees(sample_angles(samples)), 1)
    mirror = np.abs(np.mod(phi_s - phi_i, 360) - 180) < 0.5
    tilted = theta_s > 0.5
    rings = set(zip(theta_i[tilted], theta_s[tilted], strict=True))
    whole = set(zip(theta_i[mirror & tilted], theta_s[mirror & tilted], strict=True))
    short = len(rings - whole)
    if not short:
        return {}
    return {
        "incomplete": f"{short} of {len(rings)} rings of views stop short of the mirror's azimuth: "
        "the file is cut short, or was not measured in Cornell's pattern"
    }
