"""Ergun (2008): a comparison of real-time methods for hard shadows."""

TITLE = "Ergun 2008, reproduced"
INTRODUCTION = """S. Ergun, *Comparison of real-time shadow systems in graphics applications* (in
Turkish), Ege University, 2008 [Ergun 2008]. Made by `brdfkit reproduce ergun2008`, which runs each
claim again and sets what came out beside what is printed.

The thesis has one scene, which is not described, nor are the resolutions, biases and filters; it
has no times. So ours are three other scenes, each in four views and two lights that are close
together, as there: orders of methods can agree, figures need not. The views are V1, at right angles
to the light, V2, into it, V3, between, and V4, along it. Pictures are of 256 × 256 pixels, maps
of 512 × 512 texels, all else is at brdfkit's defaults. A *relative* score is the mean difference
between both lights, small where shadows are steady.

A claim is *confirmed* where our figures agree, *not confirmed* where they do not, *not stated*
where the thesis gives no figure to compare ours to."""

NEEDS: dict[str, str] = {}  # no measured files, as all scenes are made by code

PARTS = (
    "check_values",
    "misprints",
    "stencil",
    "table_1",
    "depth_curves",
    "table_4",
    "resolution",
    "combination",
    "costs",
)
