"""A measured BRDF, looked up: a table over half/difference coordinates (MERL's cells).

    {"type": "measured_table", "filename": "gold-metallic-paint.binary"}

takes any file that `brdfkit.load` reads; `Measured.scene_dict()` hands over its table directly.
Trilinear between the cells' centres, phi_d wraps. Isotropic: the table has no azimuth.

Sampled by a share of cosine and a distribution of normals that is read off the table itself.
"""

import itertools

import numpy as np


def define(mi):
    """The class of `mi.BSDF` for the current variant."""
    import drjit as dr

    from brdfkit.colours import luminance
    from brdfkit.errors import BrdfkitError
    from brdfkit.lobes import Cosine
    from brdfkit.normals import normals_of
    from brdfkit.table import Table
    from brdfkit.vectors import above_horizon, dot, half_vector, reflect

    COSINE = Cosine()

    class MeasuredTable(mi.BSDF):
        def __init__(self, props):
            super().__init__(props)
            if mi.is_spectral:
                raise BrdfkitError(
                    f"measured_table holds RGB values; {mi.variant()} is spectral, "
                    "use an rgb or mono variant."
                )
            table = _table(props)
            self.shape, self.period = table.shape, table.phi_d_period
            self.anisotropic = table.anisotropic
            values = np.maximum(table.filled, 0)
            if mi.is_monochromatic:
                values = luminance(values)[..., None]
            else:
                values = np.broadcast_to(values, (*table.shape, 3))
            self.values = buffer(values)

            facets = normals_of(table)
            self.diffuse, self.diffuse_share = facets.diffuse, facets.diffuse_share
            self.cell = mi.DiscreteDistribution(facets.masses.astype(np.float32))
            self.cosines = buffer(facets.cosines)
            self.density = buffer(facets.density)

            flags = mi.BSDFFlags
            self.m_components = [flags.GlossyReflection | flags.FrontSide]
            self.m_flags = self.m_components[0]

        def sample(self, ctx, si, sample1, sample2, active=True):
            wi, active = above_horizon(si.wi, active)
            diffuse = sample1 < self.diffuse_share
            wo = dr.select(diffuse, COSINE.sample(wi, sample2), reflect(wi, self.normal(sample2)))
            pdf = self.pdf(ctx, si, wo, active)
            active &= (pdf > 0) & ctx.is_enabled(mi.BSDFFlags.GlossyReflection, 0)

            sample = dr.zeros(mi.BSDFSample3f)
            sample.wo = wo
            sample.pdf = dr.select(active, pdf, 0)
            sample.eta = 1.0
            sample.sampled_type = int(mi.BSDFFlags.GlossyReflection)
            value = self.eval(ctx, si, wo, active)
            return sample, dr.select(active, value / dr.select(active, pdf, 1), 0)

        def eval(self, ctx, si, wo, active=True):
            active &= ctx.is_enabled(mi.BSDFFlags.GlossyReflection, 0)
            wi, active = above_horizon(si.wi, active)
            wo, active = above_horizon(wo, active)
            return dr.select(active, self.lookup(wi, wo) * wo.z, 0)

        def pdf(self, ctx, si, wo, active=True):
            active &= ctx.is_enabled(mi.BSDFFlags.GlossyReflection, 0)
            wi, active = above_horizon(si.wi, active)
            wo, active = above_horizon(wo, active)
            h = half_vector(wi, wo)
            n = self.shape[0]
            position = dr.sqrt(dr.safe_acos(h.z) / (dr.pi / 2)) * n
            normals = gather(mi.Float, self.density, cell_of(position, n))
            specular = normals / (4 * dot(wi, h))
            share = self.diffuse_share
            pdf = share * COSINE.pdf(wi, wo) + (1 - share) * specular
            return dr.select(active, pdf, 0)

        def eval_pdf(self, ctx, si, wo, active=True):
            return self.eval(ctx, si, wo, active), self.pdf(ctx, si, wo, active)

        def eval_diffuse_reflectance(self, si, active=True):
            return mi.Spectrum(mi.Float(self.diffuse))

        def normal(self, u):
            """A half vector: a cell of theta_h by its mass, evenly within it."""
            cell, x = self.cell.sample_reuse(u.x)
            low = gather(mi.Float, self.cosines, cell)
            high = gather(mi.Float, self.cosines, cell + 1)
            cos_theta = dr.maximum(dr.lerp(low, high, x), 0)
            sin_theta = dr.safe_sqrt(1 - cos_theta * cos_theta)
            sin_phi, cos_phi = dr.sincos(2 * dr.pi * u.y)
            return mi.Vector3f(sin_theta * cos_phi, sin_theta * sin_phi, cos_theta)

        def lookup(self, wi, wo):
            """BRDF in sr⁻¹: `Table.eval`, in the renderer."""
            n_h, n_d, n_p = self.shape[-3:]
            theta_h, theta_d, phi_d, phi_h = half_difference(wi, wo)
            axes = [
                clamped(dr.sqrt(theta_h / (dr.pi / 2)) * n_h, n_h),
                clamped(theta_d / (dr.pi / 2) * n_d, n_d),
                periodic(phi_d / self.period * n_p, n_p),
            ]
            if self.anisotropic:
                n_a = self.shape[0]
                axes.insert(0, periodic(phi_h / (2 * dr.pi) * n_a, n_a))
            result = mi.Spectrum(0)
            for corner in itertools.product((0, 1), repeat=len(axes)):
                index, share = mi.UInt32(0), mi.Float(1)
                for n, (*cells, t), upper in zip(self.shape, axes, corner, strict=True):
                    index = index * n + cells[upper]
                    share *= t if upper else 1 - t
                result += share * gather(mi.Spectrum, self.values, index)
            return result

        def to_string(self):
            return f"MeasuredTable[shape = {self.shape}, phi_d_period = {self.period:.6g}]"

    scalar = mi.variant().startswith("scalar")

    def buffer(values):
        values = np.ascontiguousarray(values, np.float32)
        return values.reshape(-1, values.shape[-1]) if scalar else mi.TensorXf(values).array

    def gather(kind, array, index):
        if not scalar:
            return dr.gather(kind, array, index)
        row = array.reshape(-1, array.shape[-1] if kind is mi.Spectrum else 1)[index]
        return kind(*map(float, row))

    def _table(props):
        if "filename" in props:
            from brdfkit.formats import load

            return load(props["filename"]).rgb.table
        if "table" not in props:
            raise BrdfkitError("measured_table needs a filename (or the tensor table).")
        period = props.get("phi_d_period", float(np.pi))
        return Table(np.array(props["table"], float), period)

    def half_difference(wi, wo):
        h = half_vector(wi, wo)
        sin_h = dr.safe_sqrt(h.x * h.x + h.y * h.y)
        theta_h = dr.atan2(sin_h, h.z)
        # wi in the frame of the half vector; at h = n any azimuth will do
        safe = dr.select(sin_h > 1e-7, sin_h, 1)
        cos_p = dr.select(sin_h > 1e-7, h.x / safe, 1)
        sin_p = dr.select(sin_h > 1e-7, h.y / safe, 0)
        x, y = cos_p * wi.x + sin_p * wi.y, cos_p * wi.y - sin_p * wi.x
        x, z = h.z * x - sin_h * wi.z, sin_h * x + h.z * wi.z
        return theta_h, dr.atan2(dr.safe_sqrt(x * x + y * y), z), azimuth(x, y), azimuth(h.x, h.y)

    def azimuth(x, y):
        phi = dr.atan2(y, x)
        return dr.select(phi < 0, phi + 2 * dr.pi, phi)

    def clamped(position, n):
        x = dr.clip(position - 0.5, 0, n - 1)
        lower = dr.minimum(mi.UInt32(x), max(n - 2, 0))
        return lower, dr.minimum(lower + 1, n - 1), x - mi.Float(lower)

    def periodic(position, n):
        x = position - 0.5
        x = x - n * dr.floor(x / n)
        lower = dr.minimum(mi.UInt32(x), n - 1)
        return lower, dr.select(lower + 1 == n, 0, lower + 1), x - mi.Float(lower)

    def cell_of(position, n):
        return dr.minimum(mi.UInt32(position), n - 1)

    return MeasuredTable
