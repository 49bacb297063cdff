"""The environment maps of the thesis, or those that brdfkit brings."""

from brdfkit.lighting.environments.map_files import load

PROBES = "grace", "uffizi", "pisa", "ennis"
SHIPPED = "studio", "sky", "room"


def find_probes(sources):
    """Name → file of the thesis's probes where all are at hand, else name → name of the maps that
    brdfkit brings."""
    files = {name: sources.beside(f"environments/{name}.hdr") for name in PROBES}
    return files if all(files.values()) else {name: name for name in SHIPPED}


def read_probes(sources):
    """Name → radiance (height, width, 3) of each of the probes."""
    return {name: load(file)[1].astype(float) for name, file in find_probes(sources).items()}
