"""Bálint et al. (2019): soft shadows of distance functions by marching a single ray."""

TITLE = "Bálint et al. 2019, reproduced"
INTRODUCTION = """C. Bálint, G. Valasek, R. Bán, *Real-time single-ray soft-shadow algorithms for
surfaces defined by distance functions* (in Hungarian), Eötvös Loránd University, 2019
[Bálint et al. 2019]. Made by `brdfkit reproduce balint2019`, which runs each claim again and sets
what came out beside what is printed.

The thesis has times of frames on a graphics card, and no error of any shadow. It names what is in
its scenes, and no place of an object, a light or a camera; nor its BSDFs, the step rule of the
convex method, and the formulas of its rivals. So ours are like scenes; times are ratios within one
run, of seconds of CPU of the shadows alone; errors are ours to find.

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
