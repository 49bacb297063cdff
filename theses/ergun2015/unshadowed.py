"""Renders direct light without shadows by samples, which `filtered_environment` approximates."""


def make_unshadowed_integrator(samples, seed):
    """Return an integrator that samples direct light without shadows.

    Each ray takes `samples` directions of the light and as many of the BSDF, by multiple importance
    sampling. Equal seeds give equal pictures.
    """
    import mitsuba as mi

    return define_integrator(mi, samples, seed)(mi.Properties())


def define_integrator(mi, samples, seed):
    """Return the class of the integrator for the current variant."""
    import drjit as dr

    class Unshadowed(mi.SamplingIntegrator):
        def sample(self, scene, sampler, ray, medium=None, active=True):
            si = scene.ray_intersect(mi.Ray3f(ray), active)
            light, bsdf, context = scene.environment(), si.bsdf(), mi.BSDFContext()
            hit = active & si.is_valid()
            numbers = mi.load_dict({"type": "independent"})
            numbers.seed(seed, dr.width(ray))

            def add_sample(i, total, numbers):
                # Sample the light
                ds, weight = light.sample_direction(si, numbers.next_2d(), hit)
                value, pdf = bsdf.eval_pdf(context, si, si.to_local(ds.d), hit)
                by_light = value * weight * balance(ds.pdf, pdf)
                # Sample the BSDF
                drawn, weight = bsdf.sample(context, si, numbers.next_1d(), numbers.next_2d(), hit)
                ds = mi.DirectionSample3f()
                ds.d = si.to_world(drawn.wo)
                seen = dr.zeros(mi.SurfaceInteraction3f)
                seen.wi = -ds.d
                share = balance(drawn.pdf, light.pdf_direction(si, ds, hit))
                by_bsdf = weight * light.eval(seen, hit) * share
                return i + 1, total + dr.select(hit, by_light + by_bsdf, 0), numbers

            _, total, _ = dr.while_loop(
                (mi.UInt32(0), mi.Color3f(0), numbers),
                lambda i, total, numbers: hit & (i < samples),
                add_sample,
            )
            behind = light.eval(si, active & ~hit)
            return dr.select(hit, total / samples, behind), active, []

        def to_string(self):
            return "Unshadowed[]"

    def balance(ours, others):
        return dr.select(ours > 0, ours / (ours + others), 0)

    return Unshadowed
