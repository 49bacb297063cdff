"""Finds where pictures of completed materials show what was measured, inferred or guessed."""

from collections.abc import Mapping

import numpy as np

from brdfkit.core.array_types import AnyArray, BoolArray, MitsubaObject
from brdfkit.materials.measured import Measured
from brdfkit.materials.measured.measured_angles import MeasuredAngles
from brdfkit.materials.resolve import Material
from brdfkit.rendering.scene_input.material import find_view_cosines


def find_picture_evidence(
    materials: Mapping[str, Material], scene: MitsubaObject, mask: BoolArray | None
) -> dict[str, AnyArray]:
    """Return for each completed material, by name, what its picture shows, (height, width).

    A pixel is 0 if most of the light that its view may receive was measured or is not the
    material's, 1 if it was inferred, and 2 if it was guessed. Materials that are no completed
    tables are left out. `mask` are the pixels that show the material; without one, nothing is
    known of any.
    """
    completed = {
        name: material
        for name, material in materials.items()
        if isinstance(material, Measured) and material.evidence is not None
    }
    if not completed or mask is None:
        return {}
    cosines = find_view_cosines(scene)
    return {
        name: np.where(mask, MeasuredAngles(material).find_view_kinds(cosines), 0)
        for name, material in completed.items()
    }
