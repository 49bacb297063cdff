"""Bálint et al. (2019): soft shadows of distance functions by marching a single ray."""

TITLE = "Bálint et al. 2019, reproduced"
INTRODUCTION = """In plain words: the thesis claims that one march along a cone, from a point to a
round light, finds a soft shadow with a bounded error ε, about as fast as three rays and far more
exact than the shadows known from games. That holds, and so do its pictures of where one straight
edge is a wrong model: corners, several objects, thin walls. What does not hold: algorithms 3 and 4
keep no bound as they are printed, but a small change mends them; τ can be inverted by Newton's
method, so that `base` need not be slow, and it is not the slowest; and the right ε for a light
depends on what one calls a band. What surprised: `convex`, which the thesis mentions without a
formula, is by far the fastest march, so that it is more than ten times as fast as rays of the same
error where `linear`, the thesis's best, is three to nine times; and in coarse pictures the empty
ball about a point, and not the straight edge, makes most of the error.

C. Bálint, G. Valasek, R. Bán, *Real-time single-ray soft-shadow algorithms for
surfaces defined by distance functions* (in Hungarian), Eötvös Loránd University, 2019
[Bálint et al. 2019]. Made by `brdfkit reproduce balint2019`, which runs each claim again and sets
what came out beside what is printed.

The thesis has times of frames on a graphics card, and no error of any shadow. It names what is in
its scenes, and no place of an object, a light or a camera; nor its BSDFs, the step rule of the
convex method, and the formulas of its rivals. So ours are like scenes; times are ratios within one
run, of seconds of CPU in one thread; errors are ours to find.

A claim is *confirmed* where our figures agree, *not confirmed* where they do not, *not stated*
where the thesis gives no figure to compare ours to."""

NEEDS: dict[str, str] = {}  # no measured files, as all scenes are made by code

PARTS = (
    "hard_edges",
    "check_values",
    "error_bound",
    "against_rays",
    "variants",
    "right_epsilon",
    "model_errors",
    "shading",
)
