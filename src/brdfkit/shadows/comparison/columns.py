"""The columns of the table of shadow techniques, and its rows as texts."""

import math

# Name, heading, scale, decimals, and whether more is better
COLUMNS = (
    ("psnr", "PSNR [dB]", 1, 1, True),
    ("wrong", "wrong [%]", 100, 2, False),
    ("acne", "acne [%]", 100, 2, False),
    ("texture_use", "use [%]", 100, 1, True),
    ("aliasing", "aliasing [dB]", 1, 1, True),
    ("camera_flicker", "camera flicker [%]", 100, 3, False),
    ("light_flicker", "light flicker [%]", 100, 3, False),
    ("build", "build [ms]", 1e3, 0, False),
    ("look_up", "look-up [ms]", 1e3, 0, False),
)


def to_texts(rows):
    """The `Scores` by technique as rows of texts; "–" for what is unknown."""

    def text(value, digits):
        return "–" if math.isnan(value) else f"{value:.{digits}f}"

    return [
        (
            label,
            *(text(getattr(scores, name) * scale, digits) for name, _, scale, digits, _ in COLUMNS),
        )
        for label, scores in rows.items()
    ]
