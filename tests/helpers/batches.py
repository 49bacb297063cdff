"""Estimates what a camera sees, from many batches of samples in one kernel: Mitsuba prepares each
rendering for as long as such a batch takes."""

import drjit as dr
import numpy as np


def render_batches(scene, batches, samples, seed=0):
    """The mean radiances (batches, 3) of so many pictures of a scene.

    Each picture has so many `samples` per pixel, drawn as for a film whose filter is a box.
    """
    import mitsuba as mi

    sensor = scene.sensors()[0]
    width, height = sensor.film().crop_size()
    n = batches * samples * width * height
    sampler = mi.load_dict({"type": "independent"})
    sampler.seed(seed, n)
    pixel = dr.arange(mi.UInt32, n) % dr.opaque(mi.UInt32, width * height)
    row = pixel // dr.opaque(mi.UInt32, width)
    corner = mi.Vector2f(mi.Float(pixel - row * dr.opaque(mi.UInt32, width)), mi.Float(row))
    place = (corner + sampler.next_2d()) / mi.Vector2f(width, height)
    ray, weight = sensor.sample_ray_differential(
        0, sampler.next_1d(), place, mi.Point2f(sampler.next_2d())
    )
    radiance, _, _ = scene.integrator().sample(scene, sampler, ray)
    return np.array(mi.Color3f(radiance * weight)).reshape(3, batches, -1).mean(axis=2).T


def mean_and_error(values, ddof=0):
    """The mean of values, those of batches along the first axis, and its standard error."""
    return values.mean(axis=0), values.std(axis=0, ddof=ddof) / np.sqrt(len(values))
