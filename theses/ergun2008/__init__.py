"""Ergun (2008): a comparison of real-time methods for hard shadows."""

TITLE = "Ergun 2008, reproduced"
INTRODUCTION = """S. Ergun, *Comparison of real-time shadow systems in graphics applications* (in
Turkish), Ege University, 2008 [Ergun 2008]. Made by `brdfkit reproduce ergun2008`, which runs each
claim again and sets what came out beside what is printed.

**In short.** The thesis compares six projections and three filters of shadow maps with stencil
volumes, in one scene, and recommends LiSPSM with variance maps (VSM), best with parallel splits
(PSSM). *What holds*: stencil volumes are exact, with the failures that it tells; errors of maps
vanish as their resolution grows; PSSM always helps, with four times the texels; and its
recommendation is right where VSM has no blur. Its order of filters is that of compact scenes with a
constant bias and small windows. *What does not*: its orders of projections, by texture use and by
aliasing, and that LiSPSM is steadier than uniform maps. In deep scenes uniform maps are far behind;
PSM has the most aliasing in three scenes of five, where the uniform map is not too wide. VSM is not
far nearer to exact shadows than a plain map, but where that map has acne. A cap on the near plane
can mend depth-pass. *What surprised*: a blur of 5 × 5 texels, which the thesis does not mention,
takes VSM from above a plain map to 1 to 5 dB below it; with as many texels in all, PSSM seldom
gains; by a constant bias PCF loses up to 17 dB to a plain map, not by its soft edges but by acne;
and along one ray of sunlight no projection distorts depth at all. Six formulas are misprinted, and
one can be misread. Four projections are tried in the thesis's own forms, beside ours; whether a
graphics card does things faster was not run.

The thesis does not describe its scene, nor resolutions, biases and filters; it has no times. So
ours are other scenes, each in four views and two lights that are close together, as there: orders
of methods can agree, figures need not. The views are V1, at right angles to the light, V2, into it,
V3, between, and V4, along it. Pictures are of 256 × 256 pixels, maps of 512 × 512 texels where
nothing else is said. A *relative* score is the mean difference between both lights, small where
shadows are steady.

Claims that depend on such settings are tried on a grid of them. Some of its values were chosen by
their outcome: a search for settings in which the printed orders hold had found a compact scene, at
the nearest of three distances, VSM without blur, and constant biases of 0.0005 to 0.001. `compact`
is such a scene: seven objects on 8 × 8, the eye 7 away, 60°. `compact_from_afar` is the same from
14. Shadows of the thesis's uniform map that end at half the farthest depth were added when those up
to all of it were seen to waste most of the map. The other values were there before, or are beside
those that were found.

The projections of which we have another form than the thesis are told at Table 1. Verdicts on
projections and curves of depth are on the thesis's forms, with the counts by ours beside them;
filters, resolutions, partitions and what is recommended are tried with our forms.

A claim is *confirmed* where it holds in everything that was tried. *Holds where* names the largest
block of the grid in which it holds without exception, if that is an eighth of the grid or more;
else it is *not confirmed*, as where our figures disagree and there is no grid. *Not
stated* is it where the thesis gives no figure to compare ours to, and *not run* where it speaks of
hardware of its time."""

NEEDS: dict[str, str] = {}  # no measured files, as all scenes are made by code

PARTS = (
    "check_values",
    "misprints",
    "stencil",
    "degenerate_quads",
    "table_1",
    "depth_curves",
    "table_4",
    "resolution",
    "resolution_matched",
    "combination",
    "costs",
)
