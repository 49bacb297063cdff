"""A model in a file of a user's own, which tests write into a folder."""

USER_MODEL = '''"""Felt: dull."""

from brdfkit.model.lobes import lambertian
from brdfkit.model import Model, weight


class Felt(Model):
    diffuse_reflectance = weight(0.3, "k_d")

    def lobes(self):
        return (lambertian(),)
'''
