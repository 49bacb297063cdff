"""A material turned about the normal, by an angle from a texture: the grain of wood, brushed metal.

    {"type": "tangent_rotation", "angle": {"type": "bitmap", ...}, "bsdf": {"type": "ward", ...}}

The material may be any of Mitsuba's or brdfkit's; `alpha_u` is along the turned u. Within
`normalmap` the normal is the map's.
"""

from brdfkit.mitsuba_bridge.properties.declarations import bsdf, declared, texture

PARAMETERS = {
    "angle": texture(0.0, "of the material's u from the surface's, counterclockwise [radians]"),
    "bsdf": bsdf("the material that is turned; in a scene file name it so"),
}


def define(mi):
    """The class of `mi.BSDF` for the current variant."""
    import drjit as dr

    class TangentRotation(declared(mi.BSDF, PARAMETERS)):
        def __init__(self, props):
            super().__init__(props)
            count = self.bsdf.component_count()
            self.m_components = [self.bsdf.flags(k) for k in range(count)]
            self.m_flags = self.bsdf.flags()

        def turned(self, si, active):
            """(the interaction as the nested material sees it, cosine and sine of the angle)."""
            sine, cosine = dr.sincos(self.angle.eval_1(si, active))
            inside = mi.SurfaceInteraction3f(si)
            inside.wi = turn(si.wi, cosine, -sine)
            return inside, cosine, sine

        def sample(self, ctx, si, sample1, sample2, active=True):
            inside, cosine, sine = self.turned(si, active)
            found, weight = self.bsdf.sample(ctx, inside, sample1, sample2, active)
            found.wo = dr.detach(turn(found.wo, cosine, sine))
            if not dr.is_diff_v(mi.Float):  # Dr.Jit's replace_grad crashes with Python's numbers
                return found, weight
            # the direction has no derivatives: where it stays, the material turns beneath it
            smooth = active & (found.pdf > 0) & mi.has_flag(found.sampled_type, mi.BSDFFlags.Smooth)
            value = self.bsdf.eval(ctx, inside, turn(found.wo, cosine, -sine), smooth)
            pdf = dr.select(smooth, dr.detach(found.pdf), 1)
            return found, dr.select(smooth, dr.replace_grad(weight, value / pdf), weight)

        def eval(self, ctx, si, wo, active=True):
            inside, cosine, sine = self.turned(si, active)
            return self.bsdf.eval(ctx, inside, turn(wo, cosine, -sine), active)

        def pdf(self, ctx, si, wo, active=True):
            inside, cosine, sine = self.turned(si, active)
            return self.bsdf.pdf(ctx, inside, turn(wo, cosine, -sine), active)

        def eval_pdf(self, ctx, si, wo, active=True):
            inside, cosine, sine = self.turned(si, active)
            return self.bsdf.eval_pdf(ctx, inside, turn(wo, cosine, -sine), active)

        def eval_diffuse_reflectance(self, si, active=True):
            return self.bsdf.eval_diffuse_reflectance(self.turned(si, active)[0], active)

    def turn(w, cosine, sine):
        """A direction turned about z, counterclockwise."""
        return mi.Vector3f(cosine * w.x - sine * w.y, sine * w.x + cosine * w.y, w.z)

    return TangentRotation


def example():
    """Brushed metal, for the checks."""
    brushed = {"type": "ward", "alpha_u": 0.4, "alpha_v": 0.1, "specular_reflectance": 0.5}
    return {"type": "tangent_rotation", "angle": 0.5, "bsdf": brushed}
