"""Describes the four renderers of the thesis, each with a volume of one of the scans."""

from brdfkit.theses.lesar2018.iterations import make_stage

from brdfkit.volumes import TransferFunction

CLAY = {
    "type": "roughplastic",
    "alpha": 0.3,
    "diffuse_reflectance": {"type": "rgb", "value": [0.7, 0.5, 0.38]},
}


def describe_maximum_intensity(scan):
    """Return the volume of a maximum-intensity picture, in the colours of a colour map."""
    low, high = scan.window
    function = TransferFunction.from_colormap("magma", (low, high), opacity=[(0, 1), (1, 1)])
    return {"volume": scan.density.scene_dict(function)}


def describe_isosurface(scan):
    """Return the volume, level and clay material of an isosurface."""
    volume = scan.density.scene_dict()
    return {"volume": volume, "level": scan.level, "bsdf": CLAY, "shadows": True}


def describe_emission_absorption(scan):
    """Return the volume of a picture by emission and absorption."""
    return {"extinction": scan.coloured.scene_dict(scan.function)}


def describe_single_scattering(scan):
    """Return the volume of a picture by scattered light."""
    return {"extinction": scan.coloured.scene_dict(scan.function)}


RENDERERS = {
    "maximum_intensity": describe_maximum_intensity,
    "isosurface": describe_isosurface,
    "emission_absorption": describe_emission_absorption,
    "single_scattering": describe_single_scattering,
}
LIT = "isosurface", "single_scattering"  # the renderers that need lights


def make_scan_scene(scan, name, size):
    """Return the scene of a scan by a renderer, with `size` pixels along both edges."""
    integrator = {"type": name, **RENDERERS[name](scan)}
    return make_stage(integrator, size, scan.eye, scan.up, lit=name in LIT)
