"""`Finding`: a doubtful property of a measurement, and how it is mended."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Finding:
    """A doubtful property of a measurement; as text a sentence without a full stop.

    `topic`: what it is about, such as "azimuth". `text`: what is doubtful, and why. `where`: the
    angles at which, if the text does not name them. `mend`: the argument of `brdfkit.load` that
    mends it, or ""; `remedy`: the end of the sentence, which names that argument.
    """

    topic: str
    text: str
    where: str = ""
    mend: str = ""
    remedy: str = ""

    def __str__(self) -> str:
        return self.text + self.remedy
