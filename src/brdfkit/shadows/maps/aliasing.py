"""Aliasing of a shadow map: how many pixels of the picture one texel covers, by its area.

    1 / |det J|,  J = ∂(texels) / ∂(pixels) along the surface

above 1 the shadow shows the map's texels, below it texels are wasted [Ergun 2008, 3.2.2]. Of an
area on a surface with the normal n, a map (u, v) makes |n · (∇u × ∇v)| times as much.
"""


def aliasing(texels, pixels, p, n):
    """1 / |det J| at a point `p` of a surface with the normal `n`, of three components each.

    texels : of the shadow map, a `Projection` and its resolution.
    pixels : of the picture, a `Projection` by its camera's matrix, and its width and height.

    Components are floats, NumPy arrays or, of opaque projections, Dr.Jit arrays.
    """
    projection, resolution = texels
    camera, (width, height) = pixels
    pixel_density = width * height * magnification(camera, p, n)
    return pixel_density / (resolution**2 * magnification(projection, p, n))


def magnification(projection, p, n):
    """The area on the map's square, over that on the surface."""
    (u_x, v_x, _), (u_y, v_y, _), (u_z, v_z, _) = (
        projection.along(p, way) for way in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    )
    return abs(
        n[0] * (u_y * v_z - u_z * v_y)
        + n[1] * (u_z * v_x - u_x * v_z)
        + n[2] * (u_x * v_y - u_y * v_x)
    )
