"""Describes a completed material in words: from what it was made, how sure it is, its albedo."""

from brdfkit.materials.measured import Measured
from brdfkit.materials.measured.albedos import ANGLES
from brdfkit.materials.measured.evidence import describe_evidence
from brdfkit.materials.measured.spectrum_to_rgb import to_rgb_or_mean

MOST_CHANNELS = 3  # albedos of more are told in linear sRGB, or the mean if they give no colour


def describe_completion(completed: Measured) -> dict[str, str]:
    """Return what to tell about a material from `complete`, as texts by their headings."""
    info = completed.info
    prior = [key for key in ("prior", "prior sources", "prior terms") if key in info]
    return {
        "completed": info["completed"],
        **describe_evidence(completed),
        "albedo": describe_albedo(completed),
        **{key: info[key] for key in prior},
    }


def describe_albedo(completed: Measured) -> str:
    """Return the directional albedos at 5°, 45° and 75° in words, one number for each channel."""
    data = completed if len(completed.channels) <= MOST_CHANNELS else to_rgb_or_mean(completed)
    rows = zip(ANGLES, data.albedo.values, strict=False)
    texts = [f"{' '.join(f'{a:.3f}' for a in albedo)} at {angle:g}°" for angle, albedo in rows]
    return f"{', '.join(texts)} ({' '.join(data.channels)})"
