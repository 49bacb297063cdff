"""Bálint et al. (2019): soft shadows of distance functions by marching a single ray."""

TITLE = "Bálint et al. 2019, reproduced"
INTRODUCTION = """**In short.** The thesis claims that one march along a cone, from a point to a
round light, finds a soft shadow with an error of at most ε, about as fast as three rays and far
more exact than the shadows known from games. *What holds*: the bound ε, of the marches as they are
meant; the speed beside 64 and 512 rays, which are far more exact, though; errors a third to a tenth
of those of its rivals; and its pictures of where one straight edge is a wrong model: corners,
several objects, thin walls. *What holds in part*: it is as fast as its rivals in whole frames, but
two to five times as slow in the shadows alone; its error is below a tenth of ε in the mean, but not
at single points. *What does not*: algorithms 3 and 4 keep no bound as they are printed; τ can be
inverted by Newton's method; a larger light costs noticeably more; shading by one march is 3 to 11
times as fast as by 150 samples, where 28 to 50 times are printed, since eye rays and shading take
most of our frames; and `base` is not the slowest march, by the printed tables themselves. Which ε a
light needs depends on what one calls a band. *What surprised*: `convex`, for which the thesis
prints no rule, is by far the fastest march with our rule, where objects are convex: ten times as
fast as rays of the same error and more, where `linear`, the one that the thesis recommends, is
three to nine times. It gains everywhere, not only where much is lit or light travels far, as the
thesis says.

C. Bálint, G. Valasek, R. Bán, *Real-time single-ray soft-shadow algorithms for
surfaces defined by distance functions* (in Hungarian), Eötvös Loránd University, 2019
[Bálint et al. 2019]. Made by `brdfkit reproduce balint2019`, which runs each claim again and sets
what came out beside what is printed.

The thesis has times of frames on a graphics card, and no error of any shadow. It names what is in
its scenes, and no place of an object, a light or a camera; nor its BSDFs, the step rule of the
convex method, and the formulas of its rivals. So ours are like scenes; times are ratios within one
run, of seconds of CPU in one thread; errors are ours to find.

A claim is *confirmed* where our figures agree, *not confirmed* where they do not, *not stated*
where the thesis gives no figure to compare ours to, and *not run* where what it needs is not at
hand. Where it is tried in several settings, the verdict says in which of them it holds."""

NEEDS: dict[str, str] = {}  # no measured files, as all scenes are made by code

PARTS = (
    "hard_edges",
    "check_values",
    "error_bound",
    "against_rays",
    "variants",
    "convex",
    "right_epsilon",
    "model_errors",
    "shading",
)
