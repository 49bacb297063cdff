"""Lesar (2018): path tracing for direct volume rendering with web technologies."""

TITLE = "Lesar 2018, reproduced"
INTRODUCTION = """Ž. Lesar, *Path tracing for direct volume rendering with web technologies* (in
Slovenian), MSc thesis, University of Ljubljana, 2018 [Lesar 2018]. Made by
`brdfkit reproduce lesar2018`, which runs each claim again and sets what came out beside what is
printed.

**In short.** The thesis shows volumes in the browser by four renderers, which improve their
pictures iteration by iteration. It claims that Woodcock tracking is unbiased, that importance
sampling makes it fast, and that times grow more slowly than voxels and pixels. *What holds*: the
tracking, the sampling, the convergence, times that grow more slowly than the voxels, and the parts
that are exchanged while the program runs. *What does not*: scattering is the slowest of the four
renderers only where a ray has few steps, and maximum intensity is not the fastest; a mean in 16
bits stops where noise is small; and two formulas of the same phase function use opposite
directions. *What surprised*: phase functions that
are called too costly to draw from take several times as long for a draw, and hardly longer for a
picture. What needs a browser's graphics chip was not run.

The thesis has formulas, one table of times on two graphics chips, and pictures. It names no data,
no transfer function, camera or light, no albedo and no error of any picture; its curves of PSNR
have no numbers that could be read. So our data are others, times are ratios within one run, of
seconds of CPU, and errors are ours to find. Where it says "computed apart", the thesis prints no
value, and the one beside ours is by a program that shares no line with brdfkit.

A claim is *confirmed* where our figures agree, *not confirmed* where they do not, *not stated*
where the thesis gives no figure to compare ours to, and *not run* where what it needs is not at
hand. Where it is tried in several settings, the verdict says in which of them it holds."""

NEEDS: dict[str, str] = {}  # scans are optional: they are looked for beside the measurements
# The packages that read scans, by the scan's file
MRI = "volumes/mni152_t1_1mm.nii.gz"
PACKAGES = {MRI: "nibabel"}

PARTS = (
    "phase_functions",
    "schlick",
    "phase_samplers",
    "importance",
    "free_paths",
    "ray_marching",
    "single_scattering",
    "against_volpath",
    "largest_values",
    "isosurface_depth",
    "half_floats",
    "four_renderers",
    "transfer_functions",
    "tone_mappers",
    "convergence",
    "iteration_times",
    "application",
)
