"""What the page says of a measured file: what it is, what is doubtful in it, and what mends it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from brdfkit.core.errors import BrdfkitError
from brdfkit.materials.auditing import Audit, audit
from brdfkit.materials.auditing.report import list_findings
from brdfkit.materials.measured import Measured
from brdfkit.materials.measured.conventions import OPTIONS
from brdfkit.viewing.materials.mends import LABELS, PREFIX

if TYPE_CHECKING:
    from brdfkit.viewing.application import Message
    from brdfkit.viewing.materials.material_state import MaterialState
    from brdfkit.viewing.session import Session

    Application = Any  # `MaterialApplication`, which imports this file

TITLES = {  # of findings, by their topics
    "azimuth": "Highlight towards the light",
    "cosine": "Values times a cosine",
    "reciprocity": "Not reciprocal",
    "horizon": "Dark towards the horizon",
    "plane": "In one plane only",
    "incidence": "One angle of incidence",
    "zero": "Values of 0",
    "sentinel": "Marks of missing values",
    "unit": "Another unit",
    "spike": "Spike",
    "albedo": "Albedo above 1",
    "negative": "Negative values",
    "coverage": "Few measurements",
}


def begin_audit(application: Application, session: Session) -> list[Message]:
    """Begin to audit the material as it is mended; the page hears of it later."""
    states: MaterialState = application.states
    data, mends = states.measured, states.mends
    if not isinstance(data, Measured):
        raise BrdfkitError(f"{application.name} was not measured, so there is nothing to audit.")

    def make_messages() -> list[Message]:
        if mends not in application.audits:
            application.audits[mends] = describe_audit(data)
        return [application.audits[mends]] if states.mends == mends else []

    session.compute_aside(make_messages)
    return []


def describe_audit(data: Measured) -> Message:
    """Return the message "audit": lines on the file, and its findings."""
    result = audit(data)
    findings = [
        {
            "title": TITLES[finding.topic],
            "text": to_greek(finding.text),
            "where": to_greek(finding.where),
            "mend": finding.mend and PREFIX + finding.mend,
            "label": LABELS[finding.mend][0] if finding.mend else "",
        }
        for finding in list_findings(result)
    ]
    return {"type": "audit", "file": describe_file(result), "findings": findings}, []


def describe_file(result: Audit) -> list[str]:
    """Return lines that say what an audited file is: its format, its values and their angles."""
    rows, unit = result.rows(), "cells" if result.data.is_table else result.kind
    count = f"{result.valid:,} {unit}"
    if result.valid < result.above:
        count = f"{result.valid:,} valid of {result.above:,} {unit}"
    kind = f"{result.kind}, {count}" if result.data.is_table else count
    line = [result.data.info.get("format", ""), kind, rows["channels"]]
    info = result.data.info
    done = [
        text for notes in OPTIONS.values() for key, text in notes.items() if info.get(key) == text
    ]
    mended = [f"Mended: {to_greek(text)}." for text in done]
    return [", ".join(filter(None, line)), rows["angles"], *mended]


def to_greek(text: str) -> str:
    """Return a text with the letters of angles: φo for phi_o."""
    return text.replace("phi_", "φ").replace("theta_", "θ")
