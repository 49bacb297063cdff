"""The network of MaterialX's nodes that draws a `GgxSum`; `materialx` and `usd` write it."""

from __future__ import annotations

from dataclasses import dataclass

from brdfkit.exporting.filling import write_number, write_numbers
from brdfkit.exporting.ggx_sum import GgxLobe, GgxSum

VERSION = "1.39"  # of MaterialX

# What a file says about viewers that draw with MaterialX's GLSL. The figures are medians over
# pairs of directions, measured in tests/oracles
NOTE = (
    "MaterialX's OSL draws exactly this. Its GLSL adds light that facets scatter several times",
    "(a metal of alpha 0.2 is 6 % brighter) and shadows by the mean of both widths.",
)


@dataclass(frozen=True)
class Input:
    """A value of a node, as text, or the name of the node that it is connected with.

    `type` is MaterialX's: "float", "vector2", "color3" or "string" of values, "BSDF" of nodes.
    """

    type: str
    name: str
    text: str

    @property
    def is_node(self) -> bool:
        """Whether the input is connected with a node."""
        return self.type == "BSDF"


@dataclass(frozen=True)
class Node:
    """A node of MaterialX: its category, name, the type of its output, and its inputs."""

    kind: str
    name: str
    inputs: tuple[Input, ...]
    type: str = "BSDF"


def make_network(content: GgxSum) -> list[Node]:
    """Return the nodes, each after those that it needs; the last one is the surface shader.

    Node `generalized_schlick_bsdf` has the form of a highlight, F = k₀ + (k₉₀ - k₀) (1 - V·H)⁵, for
    any k₀ and k₉₀; its `roughness` is (α_u, α_v) itself.
    """
    lobes = [_make_highlight(number, lobe) for number, lobe in enumerate(content.lobes, 1)]
    diffuse = [_make_diffuse(content)] if any(content.diffuse) or not lobes else []
    parts = diffuse + lobes
    nodes, total = list(parts), parts[0].name
    for number, part in enumerate(parts[1:], 1):
        both = Input("BSDF", "in1", total), Input("BSDF", "in2", part.name)
        nodes.append(Node("add", total := f"sum_{number}", both))
    return [*nodes, Node("surface", "surface", (Input("BSDF", "bsdf", total),), "surfaceshader")]


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
