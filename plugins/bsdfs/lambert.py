"""Lambert: a matte surface that looks equally bright from every direction.

    f = k_d / π

[Lambert 1760]; [Kurt 2007, eq. 3.1]. It suits chalk and matte paper, whose radiance does not depend
on the direction of view.
"""

from brdfkit.model import Model, weight
from brdfkit.model.lobes import Lobe, lambertian

# The ball in the picture on the model's page: chalk
PICTURE = {
    "diffuse_reflectance": [0.75, 0.73, 0.68],
}


class Lambert(Model):
    diffuse_reflectance = weight(0.5, "k_d: albedo")

    def lobes(self) -> tuple[Lobe, ...]:
        return (lambertian(),)
