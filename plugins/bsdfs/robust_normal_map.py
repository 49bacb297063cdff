"""Robust normal map: the normals of a texture, without black edges and without a loss of energy.

    f'(wi, wo) (wo · z) = f(wi, wo) (wo · n) + δ f(wi, w) (wo · z),    δ = (1 - cos θ) / 2

    {"type": "robust_normal_map", "normalmap": {"type": "bitmap", "raw": True, ...}, "bsdf": {...}}

The plugin takes the place of Mitsuba's `normalmap`, whose parameters it has. f is any BSDF of
Mitsuba or brdfkit, in the frame of the normal n that the texture gives, and θ the angle between n
and the normal z of the surface. Mitsuba's `normalmap` has the first term; the plugin differs in two
ways:

- Light that f sends below the surface is not lost, but spread over the directions above it: the
  second term, whose w is the direction below the surface that is mapped to wo. It keeps the energy
  exactly, so the albedo is that of f, at all angles; and a matt f has a matt second term. This is
  what `conserve_energy` means.
- A normal that hardly faces the viewer, or not at all, is bent towards z, until its cosine to the
  viewer is half of z's. The mirror direction then is about at the horizon, which is how
  [Keller et al. 2017] bend normals. Mitsuba mirrors a normal as soon as it faces away.

Values are continuous in the normal, so derivatives by the texture have no missing part. Like every
normal map that shows the shading of its normals, the BSDF is not symmetric in wi and wo. The
two-facet surface of [Schüssler et al. 2017] is, but a matt one shows no bumps from above.
"""

from typing import Any

from brdfkit.core.array_types import (
    JitColour,
    JitFloat,
    JitMask,
    JitVector,
    MitsubaModule,
    MitsubaObject,
)
from brdfkit.core.errors import BrdfkitError
from brdfkit.mitsuba_bridge.properties.declarations import (
    declare_bool,
    declare_bsdf,
    declare_normals,
    derive_plugin,
)

PARAMETERS = {
    "normalmap": declare_normals("unit normals in the frame of the surface, as (n + 1) / 2"),
    "bsdf": declare_bsdf("the material, white and matt by default; it may have any name"),
    "conserve_energy": declare_bool(
        True, "whether light below the surface is spread above it; if not, it is lost"
    ),
    "flip_invalid_normals": declare_bool(
        True, "whether normals that face away from the viewer are bent; if not, they look black"
    ),
    "use_shadowing_function": declare_bool(
        False,
        "whether lights near the surface's horizon are dimmed on tilted normals, with a loss of "
        "energy [Estevez et al. 2019]; Mitsuba's default is true",
    ),
}


def define(mi: MitsubaModule) -> type:
    """Return the plugin's class for Mitsuba's current variant: a `mi.BSDF`."""
    import drjit as dr

    from brdfkit.core.geometry.vectors import HORIZON, normalise
    from brdfkit.mitsuba_bridge.bsdf import tilted_facets

    Base: MitsubaObject = derive_plugin(mi.BSDF, PARAMETERS)

    class RobustNormalMap(Base):
        def __init__(self, props: MitsubaObject) -> None:
            rename_material(props)
            super().__init__(props)
            count = self.bsdf.component_count()
            asymmetric = mi.BSDFFlags.NonSymmetric
            self.m_components = [self.bsdf.flags(k) | asymmetric for k in range(count)]
            self.m_flags = self.bsdf.flags() | asymmetric

        def traverse(self, callback: MitsubaObject) -> None:
            """Name the parameters as Mitsuba's `normalmap` does."""
            callback.put("nested_bsdf", self.bsdf, mi.ParamFlags.Differentiable)
            callback.put("normalmap", self.normalmap, mi.ParamFlags.Differentiable)

        def tilt_interaction(
            self, si: MitsubaObject, active: JitMask
        ) -> tuple[MitsubaObject, MitsubaObject]:
            """Return `si` in the frame of the facet, and this frame relative to that of `si`."""
            n = tilted_facets.decode_normal(mi.Vector3f(self.normalmap.eval_3(si, active)))
            if self.flip_invalid_normals:
                n = tilted_facets.bend_normal(n, si.wi)
            s = normalise(mi.Vector3f(1, 0, 0) - n * n.x)
            frame = mi.Frame3f(s, dr.cross(n, s), n)
            inside = mi.SurfaceInteraction3f(si)
            inside.wi = frame.to_local(si.wi)
            inside.sh_frame = mi.Frame3f(*(si.to_world(axis) for axis in (s, frame.t, n)))
            return inside, frame

        def sample(
            self,
            ctx: MitsubaObject,
            si: MitsubaObject,
            sample1: JitFloat,
            sample2: JitVector,
            active: JitMask = True,
        ) -> tuple[MitsubaObject, JitColour]:
            active = active & (dr.abs(si.wi.z) > HORIZON)
            inside, frame = self.tilt_interaction(si, active)
            drawn, weight = self.bsdf.sample(ctx, inside, sample1, sample2, active)
            # Some BSDFs of Mitsuba also draw directions on the wrong side, with the weight 0
            crosses = drawn.wo.z * inside.wi.z
            reflects = mi.has_flag(drawn.sampled_type, mi.BSDFFlags.Reflection)
            active = active & (drawn.pdf > 0) & dr.select(reflects, crosses > 0, crosses < 0)
            n, w = dr.detach(mi.Vector3f(frame.n)), dr.detach(frame.to_world(drawn.wo))
            stays = drawn.wo.z * w.z > 0
            if self.conserve_energy:
                w = dr.select(stays, w, tilted_facets.raise_direction(n, w))
            else:
                active = active & stays
            drawn.wo = w
            if self.use_shadowing_function:
                weight = weight * tilted_facets.compute_shadowing(frame.n, drawn.wo)

            # A direction may be drawn in two ways, by itself or raised, so the nested material's
            # density is only that of mirror directions. Directions have no derivatives
            smooth = active & mi.has_flag(drawn.sampled_type, mi.BSDFFlags.Smooth)
            value, pdf = self.eval_pdf_tilted(ctx, inside, frame, drawn.wo, smooth)
            drawn.pdf = dr.select(active, dr.select(smooth, dr.detach(pdf), drawn.pdf), 0)
            active = active & (drawn.pdf > 0)
            weight = dr.select(smooth, value / dr.select(active, drawn.pdf, 1), weight)
            return drawn, dr.select(active, weight, 0)

        def eval_pdf(
            self, ctx: MitsubaObject, si: MitsubaObject, wo: JitVector, active: JitMask = True
        ) -> tuple[JitColour, JitFloat]:
            active = active & (dr.abs(si.wi.z) > HORIZON) & (dr.abs(wo.z) > HORIZON)
            inside, frame = self.tilt_interaction(si, active)
            return self.eval_pdf_tilted(ctx, inside, frame, wo, active)

        def eval_pdf_tilted(
            self,
            ctx: MitsubaObject,
            inside: MitsubaObject,
            frame: MitsubaObject,
            wo: JitVector,
            active: JitMask,
        ) -> tuple[JitColour, JitFloat]:
            """Return value and density at `wo`, for `inside` and `frame` of `tilt_interaction`."""
            n, own = mi.Vector3f(frame.n), frame.to_local(wo)
            stays = active & (own.z * wo.z > 0)
            value, pdf = self.bsdf.eval_pdf(ctx, inside, own, stays)
            value, pdf = dr.select(stays, value, 0), dr.select(stays, pdf, 0)
            if self.conserve_energy:
                w, ratio = tilted_facets.find_raised(n, wo)
                raised = active & (ratio > 0)
                value_2, pdf_2 = self.bsdf.eval_pdf(ctx, inside, frame.to_local(w), raised)
                value = value + dr.select(raised, value_2 * ratio, 0)
                pdf = pdf + dr.select(raised, pdf_2 * ratio, 0)
            if self.use_shadowing_function:
                value = value * tilted_facets.compute_shadowing(n, wo)
            return value, pdf

        def eval(
            self, ctx: MitsubaObject, si: MitsubaObject, wo: JitVector, active: JitMask = True
        ) -> JitColour:
            return self.eval_pdf(ctx, si, wo, active)[0]

        def pdf(
            self, ctx: MitsubaObject, si: MitsubaObject, wo: JitVector, active: JitMask = True
        ) -> JitFloat:
            return self.eval_pdf(ctx, si, wo, active)[1]

        def eval_diffuse_reflectance(self, si: MitsubaObject, active: JitMask = True) -> JitColour:
            return self.bsdf.eval_diffuse_reflectance(self.tilt_interaction(si, active)[0], active)

    def rename_material(props: MitsubaObject) -> None:
        """Give the nested BSDF, which may have any name, the name "bsdf"."""
        names = [name for name, value in props.objects() if isinstance(value, mi.BSDF)]
        if len(names) > 1:
            raise BrdfkitError(
                f"{props.plugin_name()}: {' and '.join(names)} are materials; give only one."
            )
        if names and names[0] != "bsdf":
            props["bsdf"] = props[names[0]]
            del props[names[0]]

    return RobustNormalMap


def example() -> dict[str, Any]:
    """Return a BSDF of red plastic whose normal is tilted by 35°, to test the plugin."""
    plastic = {"type": "ggx", "diffuse_reflectance": {"type": "rgb", "value": [0.6, 0.1, 0.1]}}
    tilted = {"type": "rgb", "value": [0.75, 0.35, 0.9]}
    return {"type": "robust_normal_map", "normalmap": tilted, "bsdf": plastic}
