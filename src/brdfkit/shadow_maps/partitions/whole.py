"""One map for all."""

from brdfkit.shadow_maps.part import Part


def parts(placement, project):
    import mitsuba as mi

    return [Part(project(placement), lambda p: mi.Bool(True))]
