"""Direct light without shadows, by samples: what `filtered_environment` approximates."""


def unshadowed(samples, seed):
    """An integrator for `samples` directions of the light and as many of the BSDF per ray, by
    multiple importance sampling. Equal seeds give equal pictures."""
    import mitsuba as mi

    return define(mi, samples, seed)(mi.Properties())


def define(mi, samples, seed):
    """The class of the integrator for the current variant."""
    import drjit as dr

    class Unshadowed(mi.SamplingIntegrator):
        def sample(self, scene, sampler, ray, medium=None, active=True):
            si = scene.ray_intersect(mi.Ray3f(ray), active)
            light, bsdf, context = scene.environment(), si.bsdf(), mi.BSDFContext()
            hit = active & si.is_valid()
            numbers = mi.load_dict({"type": "independent"})
            numbers.seed(seed, dr.width(ray))

            def one(i, total, numbers):
                # By the light
                ds, weight = light.sample_direction(si, numbers.next_2d(), hit)
                value, pdf = bsdf.eval_pdf(context, si, si.to_local(ds.d), hit)
                by_light = value * weight * balance(ds.pdf, pdf)
                # By the BSDF
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
                one,
            )
            behind = light.eval(si, active & ~hit)
            return dr.select(hit, total / samples, behind), active, []

        def to_string(self):
            return "Unshadowed[]"

    def balance(ours, others):
        return dr.select(ours > 0, ours / (ours + others), 0)

    return Unshadowed
