"""What a page says about models: a sentence for the list of models, and the page of each."""

from __future__ import annotations

import math
from functools import cache
from typing import Any

from brdfkit.core.discovery.plugin_pages import Page, read_page
from brdfkit.model import Model, labels
from brdfkit.viewing.application import Message
from brdfkit.viewing.materials.parameter_controls import read_meaning

PLUS = "+"  # between the models of a sum
INDENT = "    "  # of a formula in the page of a model


@cache
def describe_label(label: str) -> str:
    """Return what a model is, in a sentence; a sum is described by its parts."""
    parts = label.split(PLUS)
    if len(parts) > 1:
        return f"The sum of {' and '.join(parts)}."
    sentence = read_page(labels.model(label)).sentence
    return sentence[:1].upper() + sentence[1:]


def describe_models(label: str) -> Message:
    """Return the message "about": the pages of the models of a label, each model once."""
    parts = dict.fromkeys(label.split(PLUS))
    return {"type": "about", "models": [_describe(labels.model(part)) for part in parts]}, []


def _describe(model: type[Model]) -> dict[str, Any]:
    """Return the page of a model in parts."""
    page = read_page(model)
    formula, texts = split_page(page)
    return {
        "name": model.label(),
        "title": page.title,
        "sentence": describe_label(model.label()),
        "formula": formula,
        "texts": texts,
        "parameters": [_describe_parameter(model, name) for name in model.parameters],
        "references": [
            {"text": str(work).removesuffix(f". {work.link}"), "link": work.link}
            for work in page.references
        ],
    }


def _describe_parameter(model: type[Model], name: str) -> list[str]:
    """Return the symbol, the name, the bounds and the meaning of a parameter."""
    parameter = model.parameters[name]
    symbol, meaning, unit = read_meaning(name, parameter)
    low, high = ("∞" if math.isinf(v) else f"{v:g}" for v in parameter.bounds)
    bounds = f"{'−' if low == '∞' else ''}{low} to {high} {unit}".strip()
    return [symbol, name, bounds, meaning]


def split_page(page: Page) -> tuple[list[str], list[str]]:
    """Return the lines of a page's formulas, and its paragraphs."""
    formula = [line.removeprefix(INDENT) for line in page.lines if line.startswith(INDENT)]
    texts, paragraph = [], list[str]()
    for line in [*page.lines, ""]:
        if line.strip() and not line.startswith(INDENT):
            paragraph.append(line)
        elif paragraph:
            texts.append(" ".join(paragraph))
            paragraph = []
    return formula, texts
