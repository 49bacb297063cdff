"""The network of MaterialX's nodes for a `GgxSum` or `openpbr`; `materialx` and `usd` write it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from brdfkit.exporting.filling import write_number, write_numbers
from brdfkit.exporting.ggx_sum import GgxLobe, GgxSum, to_colour
from brdfkit.exporting.openpbr import hold_openpbr, is_turned, to_inputs
from brdfkit.exporting.target import GGX_SUM, Held, hold_ggx_sum
from brdfkit.model import Model

VERSION = "1.39"  # of MaterialX

# What MaterialX can hold, in words, by the columns of the table of targets
HOLDS = GGX_SUM | {"diffuse": "Lambert, `openpbr`", "else": "coat, fuzz of `openpbr`"}

# What a file says about viewers that draw with MaterialX's GLSL. The figures are those of
# tests/oracles, over pairs of directions: the median, and the largest
NOTE = (
    "MaterialX's OSL draws exactly this. Its GLSL adds light that facets scatter several times",
    "(a metal of alpha 0.2 is 6 % brighter) and shadows by the mean of both widths.",
)
NOTE_OF_OPENPBR = (
    "MaterialX's GLSL adds light that facets scatter several times (a metal of alpha 0.16: 1 %).",
    "It draws a rough diffuse base up to twice as bright where light and viewer are more than 90",
    "degrees apart.",
)


@dataclass(frozen=True)
class Input:
    """A value of a node, as text, or the name of the node that it is connected with.

    `type` is MaterialX's: "float", "vector2", "color3" or "string" of values, "BSDF" or "vector3"
    of nodes.
    """

    type: str
    name: str
    text: str

    @property
    def is_node(self) -> bool:
        """Whether the input is connected with a node."""
        return self.type in ("BSDF", "vector3")


@dataclass(frozen=True)
class Node:
    """A node of MaterialX: its category, name, the type of its output, and its inputs."""

    kind: str
    name: str
    inputs: tuple[Input, ...]
    type: str = "BSDF"


def hold(model: Model) -> Held | None:
    """Return what MaterialX draws of a model; None for models of other forms."""
    return hold_openpbr(model) or hold_ggx_sum(model)


def describe_viewers(content: GgxSum | Model) -> tuple[str, ...]:
    """Return lines of the comment: how viewers draw that use MaterialX's GLSL."""
    return NOTE_OF_OPENPBR if isinstance(content, Model) else NOTE


def make_network(content: GgxSum | Model) -> list[Node]:
    """Return the nodes, each after those that it needs; the last one is the surface shader."""
    if isinstance(content, Model):
        return _make_openpbr(content)
    return _make_sum(content)


def _make_openpbr(model: Model) -> list[Node]:
    """Return OpenPBR's node, and one for the tangent if the highlight is wide along y."""
    inputs = [
        Input("color3", name, write_numbers(value))
        if isinstance(value, list)
        else Input("float", name, write_number(value))
        for name, value in to_inputs(model).items()
    ]
    nodes = []
    if is_turned(model):
        nodes.append(
            Node("bitangent", "bitangent", (Input("string", "space", "world"),), "vector3")
        )
        inputs.append(Input("vector3", "geometry_tangent", "bitangent"))
    return [*nodes, Node("open_pbr_surface", "surface", tuple(inputs), "surfaceshader")]


def _make_sum(content: GgxSum) -> list[Node]:
    """Return the nodes of a sum.

    Node `generalized_schlick_bsdf` has the form of a highlight, F = k₀ + (k₉₀ - k₀) (1 - V·H)⁵, for
    any k₀ to 1 and k₉₀; its `roughness` is (α_u, α_v) itself.
    """
    parts_of_lobes = (part for lobe in content.lobes for part in _split(lobe))
    lobes = [_make_highlight(number, part) for number, part in enumerate(parts_of_lobes, 1)]
    diffuse = [_make_diffuse(content)] if any(content.diffuse) or not lobes else []
    parts = diffuse + lobes
    nodes, total = list(parts), parts[0].name
    for number, part in enumerate(parts[1:], 1):
        both = Input("BSDF", "in1", total), Input("BSDF", "in2", part.name)
        nodes.append(Node("add", total := f"sum_{number}", both))
    return [*nodes, Node("surface", "surface", (Input("BSDF", "bsdf", total),), "surfaceshader")]


def _split(lobe: GgxLobe) -> list[GgxLobe]:
    """Return a highlight as equal ones whose k₀ is at most 1, to which renderers clamp it."""
    count = max(1, math.ceil(max(lobe.f0)))
    f0, f90 = (to_colour(np.divide(colour, count)) for colour in (lobe.f0, lobe.f90))
    return [replace(lobe, f0=f0, f90=f90)] * count


def _make_diffuse(content: GgxSum) -> Node:
    """Return the node of the diffuse term, which is Lambert's for the roughness 0."""
    colour = Input("color3", "color", write_numbers(content.diffuse))
    flat = Input("float", "roughness", write_number(0))
    return Node("oren_nayar_diffuse_bsdf", "diffuse", (colour, flat))


def _make_highlight(number: int, lobe: GgxLobe) -> Node:
    """Return the node of a highlight."""
    inputs = (
        Input("color3", "color0", write_numbers(lobe.f0)),
        Input("color3", "color90", write_numbers(lobe.f90)),
        Input("float", "exponent", write_number(5)),
        Input("vector2", "roughness", write_numbers((lobe.alpha_u, lobe.alpha_v))),
        Input("string", "distribution", "ggx"),
        Input("string", "scatter_mode", "R"),
    )
    return Node("generalized_schlick_bsdf", f"highlight_{number}", inputs)
