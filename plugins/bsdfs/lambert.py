"""Lambert: light scattered evenly, whatever the directions.

    f = k_d / π

[Lambert 1760]; [Kurt 2007, eq. 3.1]. Shows chalk and matte paper; nothing that depends on the view.
"""

from brdfkit.model import Model, weight
from brdfkit.model.lobes import lambertian

# The ball of its page: chalk
PICTURE = {
    "diffuse_reflectance": [0.75, 0.73, 0.68],
}


class Lambert(Model):
    diffuse_reflectance = weight(0.5, "k_d: albedo")

    def lobes(self):
        return (lambertian(),)
