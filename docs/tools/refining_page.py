"""Writes the page of `make_refining.py` and its picture, from the measurements."""

import json
from pathlib import Path
from runpy import run_path

import numpy as np
from leaderboard.page import describe_versions
from make_models import join_paragraphs, make_table
from PIL import Image, ImageDraw, ImageFont

from brdfkit.core.colours import to_srgb

PAGE = Path(__file__).parents[1] / "refining.md"
RUNS = PAGE.parent.parent / "benchmarks" / "refining_runs.json"
SIDE, LINE, GAP = 288, 30, 8
CLEAR = 0.5  # a difference above it counts as clear [dB]
INTRODUCTION = """`refine` finds numbers of a scene from pictures of it: materials, lamps,
a camera's angle. It renders the whole scene, light that bounces and all, differentiates it, and
says how certain the
numbers are. [Recover a material from a photograph](how_to/material_from_a_photograph.md) goes
through it step by step.

```python
with bk.progress("refining") as bar:
    found = bk.refine("scene.xml", "photograph.exr", parameters=["ball.bsdf.alpha_u"], progress=bar)
print(found)  # values ± standard errors, what trades off, what is left
found.look().write("look.png")  # what was given, what was found, and how they differ
bk.render(found.fit)  # a fit as any other: compared, converted, written
mi.render(found.put_into("scene.xml"))  # the whole scene, with all that was found
```

- **Names** are those of `mitsuba.traverse(mitsuba.load_file("scene.xml", optimize=False))`, with or
  without `.value` at the end: `print` it to see them. None given, all numbers of brdfkit's models
  are searched. Bounds go with them: `{{"ball.bsdf.alpha_u": (0.05, 0.4)}}`.
- **Pictures**: one for each sensor of the scene, in their order and of their size. A scene of two
  sensors takes `[one, other]`. With `lights`, any number of pictures
  [under lamps of their own](how_to/material_from_a_photograph.md#photographs-under-several-lamps).
- **Units** of lamps are those of the pictures: what is twice as bright in the file has twice the
  radiance.
- **Pixels that the scene cannot explain**, as of a hand or of what stands behind, are left out by a
  mask: booleans or weights (height, width), or a picture that is white where pixels count; of a
  cut-out, `mask=rgba[..., 3]`.
- **Mitsuba's own materials** are searched as those of brdfkit. By what `roughplastic` makes tables
  of (`alpha`, `eta`) and the colour of `plastic` Mitsuba's derivatives are wrong; there, as for
  the place of a lamp, they are differences of pictures."""
WHERE = """`fit(loss="picture")` compares pictures of one shape under direct light, by the
BRDF's table; `refine` takes a picture, not a table. Where does that help?

Measured materials are rendered as they are, {size}×{size} pixels. A model is fitted to the table by
the loss `picture`, and from there refined on that picture, with at most {samples} samples per
pixel. Both are held against another picture, from a camera that no search saw: PSNR, and HDR-FLIP
in brackets, 0 at best. *Noise* is the measured material beside itself, of another seed; `room` is
the scene `cornell_box`, with paths of six edges, `ball` that of `brdfkit render`, under direct
light. Made by `python docs/tools/make_refining.py`: {versions}."""
PICTURE = """![What was measured, fitted and refined, from both cameras](refining.jpg)

*Blasted gold and `ggx` in the room: in the upper row the camera of the picture, in the lower one
the camera that no search saw.*"""
RACE = """A metal of known roughness and colour in the room, from the same start, noise of 1 %;
seconds without compiling, and the largest relative error of the four numbers.

{rows}

Adam's noise does not end, for each of its steps has its own. `refine` says how certain its numbers
are, too."""
MANY = """Textures, environment maps and volumes are searched, too, by the name of their `.data`:
thousands of numbers, by derivatives backwards and L-BFGS, again of two independent halves of the
samples. Texels that no pixel shows follow their neighbours; how smooth, pixels decide that are held
out, or `smoothness=`, more of which is smoother. There are no standard errors then.
Of smoke of 12³ voxels, seen in five pictures of 20 × 20 pixels, the densities were 0.20 off at the
start, and 0.03 after 42 steps,
in 6 s:

```python
found = bk.refine(scene, pictures, parameters={"integrator.extinction.values.data": (0, 1)})
density = found.values["integrator.extinction.values.data"]
```

An environment map is found from one picture of a mirror ball: of 8 × 16 texels, half are within
5 % and two lamps of one texel each, up to 27 times as bright as the rest, within 30 %. A blurred
ball shows less: with `alpha_u` = 0.05, half of the texels are within 10 to 20 %."""
HOW = """Four things have to be known, and whatever is wrong in them goes into the material:

1. **The camera.** Calibrate it, or search what is left: a few degrees of the field of view are the
   number `x_fov` of the sensor. Without shape there is no material.
2. **The light.** A lamp whose place and size are measured, or an environment map that was captured
   with the camera. Its strength may be searched along with the material, if something of known
   reflectance is in the picture: a grey card, or a painted wall.
3. **Linear pixels.** OpenEXR from raw files, one exposure or several merged; no tone curve.
   `accept_8_bit=True` takes what sRGB's curve was applied to, and clipped pixels do not count.
4. **Where light comes from in between.** Walls and ground belong into the scene, with a colour:
   they light what stands on them.

A search that *did not converge* says so above its numbers, and a note says where
*the residuals are not noise*: neighbouring pixels differ alike, by more than five standard errors
of chance. Look at
`found.look()` before you believe the numbers then. Standard errors are made larger where that
is so: the roughness alone, searched under colours that are wrong, was 16 standard errors off, and
is 1.4 off now; with a lamp 5 % too bright, reflectances were 10 off, and are 1 off.
A camera that is off changes edges, which no material does; a light that is off may look like
another material,
and no standard error knows."""
TIMES = """Nearly all of the time goes into paths: pixels × samples × pictures, and two to three
times as much for the derivatives. Samples grow by themselves from few to `samples`, until rendering
is quieter than what is left, so that the last steps take most. For the metal of the race below,
its roughness and a colour, with noise of 1 %, on two cores, from far starts; in brackets the
standard error of the roughness:

{times}

So begin with the photograph scaled to 64 or 128 pixels (`mitsuba.Bitmap.resample`, or means of
blocks: whatever keeps it linear) and `spp=128`, see whether the scene is right, and take
more of both for the last digit. In small pictures the far starts take most of the time:
`starts=1`, where the scene's own values are near, halved it at 64 × 48 pixels. Each further number
is a picture more in
each step, a colour counts as one, and two pictures take twice as long. `progress=` shows how far
it is."""
RIGHT = """A search may end in a valley that is not the deepest, and where single samples hit a
narrow highlight, luck makes an end look better than it is. So the points where searches begin are
compared with the noise of their pictures added, by samples of their own, and the end is held
against the scene's own values and against twice the samples: *at twice the samples* begins the
note where these say otherwise. Five scenes, four guesses and five seeds, all defaults, in pictures
of 24 × 24 pixels with noise of 1 %; right is a run whose numbers are all within 3 of their own
standard errors of the truth, warned one that did not converge, ended on a bound or has a note that
something is wrong. *Off* is the worst number, in standard errors; the median cost is in samples per
pixel, derivatives counted by their time.

{table}

Before this, {before}. Made by `python benchmarks/refining_runs.py`."""
BEFORE = """of 88 of these runs 71 were right, 8 warned and 9 silent, up to 8.9 standard errors off,
and they cost 1.18 times as much"""
TRADES = """Some numbers do the same to a picture. `f0` and the specular weight do, unless light
grazes; a lamp's strength and all reflectances do, unless one is known; a wide lobe and the diffuse
weight nearly do. `refine` says so in its notes, and its standard errors are as large as that makes
them. Then

- keep one of them at a value that is known: `f0` = 0.04 for plastic, 0.9 for metals;
- add a picture: a second camera or lamp, such that light grazes the surface;
- or use what is determined, their product; the picture is right whatever the share of each."""


def write_page(rows, shown, by_adam, by_refine, timings, size, samples):
    """Write the page and its picture.

    `rows`, `shown`: result of `compare_with_fits`; `by_adam`, `by_refine`: result of
    `race_with_adam`; `timings`: result of `measure_times`; `size`, `samples`: side of the pictures
    and samples per pixel.
    """
    text = join_paragraphs(
        "# Refining on pictures",
        INTRODUCTION.format(),
        "## On a photograph of your own",
        HOW,
        "## How long it takes",
        TIMES.format(times=make_times_table(timings)),
        "## How often it is right",
        make_outcomes_text(),
        "## What trades off",
        TRADES,
        "## Thousands of numbers",
        MANY,
        "## Where it helps",
        WHERE.format(size=size, samples=samples, versions=describe_versions()),
        describe_gains(rows),
        PICTURE,
        "## Beside the fit of the table",
        make_comparison_table(rows),
        "## Beside Adam",
        RACE.format(rows=make_race_table(by_adam, by_refine)),
    )
    PAGE.write_text(text, encoding="utf-8")
    draw_picture(shown).save(PAGE.with_suffix(".jpg"), quality=88, optimize=True)


def describe_gains(rows):
    """Return sentences on how much refining improved the pictures of each scene."""
    said = []
    for scene in dict.fromkeys(row["scene"] for row in rows):
        gains = [r["refined"][0] - r["fit"][0] for r in rows if r["scene"] == scene]
        pairs = [(r["refined"][1], r["fit"][1]) for r in rows if r["scene"] == scene]
        nearer = sum(refined < fit for refined, fit in pairs)
        better, worse = sum(g > CLEAR for g in gains), sum(g < -CLEAR for g in gains)
        said.append(
            f"- `{scene}`: better by {np.median(gains):.1f} dB (median; {min(gains):.1f} to "
            f"{max(gains):.1f}); clearly better for {better} of {len(gains)}, clearly worse for "
            f"{worse}. By FLIP nearer for {nearer}."
        )
    return "\n".join(said)


def make_comparison_table(rows):
    """Return the table of errors of all materials and models."""

    def format_errors(pair):
        """Return PSNR and FLIP as text."""
        return f"{pair[0]:.1f} ({pair[1]:.3f})"

    cells = [
        (
            row["scene"],
            f"`{row['material']}`",
            f"`{row['model']}`",
            format_errors(row["fit"]),
            format_errors(row["refined"]),
            format_errors(row["noise"]),
            str(row["steps"]),
            f"{row['seconds']:.0f} s",
        )
        for row in sorted(rows, key=lambda row: row["scene"], reverse=True)
    ]
    return make_table("scene, material, model, fitted, refined, noise, steps, time", cells)


def make_times_table(timings):
    """Return the table of times and standard errors, by picture size and number of samples."""
    counts = list(dict.fromkeys(samples for _, samples, _, _ in timings))
    cells = {row[:2]: f"{row[2]:.0f} s (±{100 * row[3]:.2g} %)" for row in timings}
    sides = dict.fromkeys(side for side, *_ in timings)
    rows = [(f"{side} × {side}", *(cells[side, samples] for samples in counts)) for side in sides]
    return make_table("pixels, " + ", ".join(f"spp={n}" for n in counts), rows)


def make_outcomes_text():
    """Return the text and table on how many runs of `benchmarks/refining_runs.py` are right."""
    rows = json.loads(RUNS.read_text(encoding="utf-8"))
    cells = run_path(str(RUNS.with_suffix(".py")))["count_outcomes"](rows)
    head = "scene, runs, right, warned, silent, off, cost"
    return RIGHT.format(table=make_table(head, cells), before=BEFORE)


def make_race_table(by_adam, by_refine):
    """Return the table of errors over time of Adam and `refine`."""
    cells = [(f"Adam, {s:.1f} s", f"{100 * error:.1f} %") for s, error in by_adam[1::2]]
    seconds, error = by_refine
    return make_table("by, error", [(f"`refine`, {seconds:.1f} s", f"{100 * error:.1f} %"), *cells])


def draw_picture(shown):
    """Return an image with a row for each camera, of the true, fitted and refined pictures."""
    rows = len(next(iter(shown.values())))
    wide, high = len(shown) * (SIDE + GAP) - GAP, LINE + rows * (SIDE + GAP) - GAP
    sheet = Image.new("RGB", (wide, high), "white")
    draw, font = ImageDraw.Draw(sheet), ImageFont.load_default(18)
    for column, (name, pair) in enumerate(shown.items()):
        left = column * (SIDE + GAP)
        draw.text((left + 4, LINE // 2), name, "black", font, anchor="lm")
        for row, pixels in enumerate(pair):
            image = Image.fromarray((255 * to_srgb(pixels) + 0.5).astype(np.uint8))
            place = left, LINE + row * (SIDE + GAP)
            sheet.paste(image.resize((SIDE, SIDE), Image.Resampling.LANCZOS), place)
    return sheet
