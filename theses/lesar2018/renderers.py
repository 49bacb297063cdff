"""The four renderers of the thesis, each with a volume of one of the scans."""

from brdfkit.theses.lesar2018.iterations import stage

from brdfkit.volumes import TransferFunction

CLAY = {
    "type": "roughplastic",
    "alpha": 0.3,
    "diffuse_reflectance": {"type": "rgb", "value": [0.7, 0.5, 0.38]},
}


def maximum_intensity(scan):
    """Largest values, in the colours of a map."""
    low, high = scan.window
    function = TransferFunction.from_colormap("magma", (low, high), opacity=[(0, 1), (1, 1)])
    return {"volume": scan.density.scene_dict(function)}


def isosurface(scan):
    """A surface of clay."""
    volume = scan.density.scene_dict()
    return {"volume": volume, "level": scan.level, "bsdf": CLAY, "shadows": True}


def emission_absorption(scan):
    """Tissues that glow."""
    return {"extinction": scan.coloured.scene_dict(scan.function)}


def single_scattering(scan):
    """Tissues in the light."""
    return {"extinction": scan.coloured.scene_dict(scan.function)}


RENDERERS = {
    "maximum_intensity": maximum_intensity,
    "isosurface": isosurface,
    "emission_absorption": emission_absorption,
    "single_scattering": single_scattering,
}
LIT = "isosurface", "single_scattering"


def scene_of(scan, name, size):
    """The scene of a scan by a renderer, with `size` pixels along both edges."""
    integrator = {"type": name, **RENDERERS[name](scan)}
    return stage(integrator, size, scan.eye, scan.up, lit=name in LIT)
