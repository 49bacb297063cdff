"""A node of one's own, for the page `distance_fields.md`, which shows this file."""

from dataclasses import dataclass
from math import sqrt
from typing import Any

from brdfkit.distance_fields import Node
from brdfkit.distance_fields.functions import absolute, cos, sin
from brdfkit.distance_fields.parameters import number


@dataclass(frozen=True, eq=False, repr=False)
class gyroid(Node):
    """A minimal surface as a wall: |sin x cos y + sin y cos z + sin z cos x| ≤ width."""

    width: Any = number(0.5, above=0)
    lipschitz = sqrt(3)  # by Cauchy and Schwarz: (cos x cos y - sin z sin x)² ≤ cos² y + sin² z ...

    def distance(self, p):
        sines = sin(p.x) * cos(p.y) + sin(p.y) * cos(p.z) + sin(p.z) * cos(p.x)
        return absolute(sines) - self.width
