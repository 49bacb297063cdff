"""Kurt (2007): BRDF models fitted to CUReT, Cornell and MERL, and a new polynomial BRDF model."""

TITLE = "Kurt 2007, reproduced"
INTRODUCTION = """M. Kurt, *A new illumination model in computer graphics*, MSc thesis, Ege
University, 2007 [Kurt 2007]. Made by `brdfkit reproduce kurt2007`, which runs each claim again and
sets what came out beside what is printed.

**In short.** The thesis fits known BRDF models to measurements, and a new one, a polynomial over
two principal components of the directions. It claims that the polynomial, being linear, takes half
the time, reaches the global minimum, needs few parameters, and describes most materials best. *What
holds*: the printed errors of Table 9.2 come back, after one factor per material; so do the ratios
of its times, by SQP where the searches alone are timed; the polynomial of degree 7 has the lowest
error of eight models on most samples of CUReT; and away from the horizon Lambert's sampling is
enough for it. *What depends on the fit*: by least squares the polynomial has one minimum, and is
the best on as many samples as is printed; by bisquare, as the thesis fits it, it has several
minima, is the best on fewer, and brings no highlight to a lacquer at any degree. *What does not
hold*: on MERL it is not the best by E, in the thesis's own table either, though it is by its
pictures; on a tile the picture is best at p = 3 and not at 6; a rational function of as many
coefficients has lower errors, also of values left out of its fit; and of the models that are called
plausible Blinn-Phong and Cook-Torrance reflect up to 4 times the light that arrives, Ward-Dür more
than all near the horizon, Ward only in its last quarter of a degree. *What surprised*: 61 of 364
printed fits beat every fit that light allows, by a highlight or a diffuse part below 0; and though
bisquare hides highlights, the balls of four of MERL's five are nearest by the polynomial.

The measurements, which brdfkit does not ship, and what is not as it was in the thesis:

- **CUReT**: the thesis fitted R, G and B; the file at hand is an average over them, on a scale of
  its own in each sample. So errors are compared after one factor per sample, or without a unit; one
  section divides the average among the channels by the colours of the printed fits.
- **Meshes**: the thesis's vase and dragon are not at hand. In their place are brdfkit's vase, the
  Stanford bunny and two more meshes, under lights of ours, because the thesis tells none.
- **Weights below 0**: the thesis let k_d and k_s have any sign and printed the negative ones as 0;
  those of brdfkit's models are never negative. Each section says which are compared; models whose
  weights may have any sign are made for it, in three lines (docs/how_to/your_model.md).
- **MERL**: none of its tables is at hand. The five materials are *neural reconstructions* of them
  [Sztrajman et al. 2021], smooth and without noise, in tables of 30 × 30 × 60 cells.
- **Cornell**: Cayman is there, Mystique is not.

E is eq. 5.13: cosine-weighted, w = sin θ_i, squares summed over the channels, both angles below
80°. A claim is *confirmed* where our figures agree to the tolerance that is told with it, *not
confirmed* where they do not, or where the thesis's own table or a proof speaks against it, *not
stated* where the thesis gives no figure or comparison to set ours beside, *not run* where a file is
missing, and nothing independent stands in for it. *Holds where* names the largest block of the
settings that were tried in which a claim holds without exception, if that is an eighth of them or
more, and not a single one of more than four."""

# The measured files, and where to get each of them
NEEDS = {
    "curet/abrdf.dat": "abrdf.dat of CUReT (brdfkit data list curet)",
    "curet/table.txt": "the table of directions of CUReT (brdfkit data list curet) as table.txt",
    "cornell/cayman.brdf": "it by 'brdfkit data get cornell/cayman'",
    "nbrdf_derived/merl_nbrdf.npz": (
        "the networks of github.com/asztr/Neural-BRDF, one array of 675 weights by material"
    ),
}
PARTS = (
    "table_9_1",
    "figure_9_1",
    "table_9_2",
    "curet_colours",
    "figure_9_2",
    "appendix_3",
    "figure_9_4",
    "figure_9_5",
    "table_9_3",
    "figure_9_3",
    "figure_9_6",
    "quadratic_programming",
    "table_9_4",
    "figure_5_1",
    "figure_7_1",
    "interactions",
    "rational_functions",
    "figure_3_3",
    "energy",
    "sampling",
    "comparisons",
    "misprints",
)
