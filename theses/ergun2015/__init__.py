"""Ergun (2015): environment maps cut into blocks, convex visibility, BRDFs as Gaussian lobes."""

TITLE = "Ergun 2015, reproduced"
INTRODUCTION = """S. Ergun, *New approaches to real-time global illumination algorithms for dynamic
scenes*, PhD thesis, Ege University, 2015 [Ergun 2015]. Made by `brdfkit reproduce ergun2015`, which
runs each claim again and sets what came out beside what is printed.

**In short.** The thesis cuts maps into blocks, casts shadows by convex parts, and lights surfaces
through Gaussian lobes. Where brdfkit's form of a method is another than the thesis's, a claim names
the form that it judges. *Blocks*: by the thesis's law and 191 blocks, its ratio of blocks, a sample
takes a third to a half of the time of cumulative sums, and far less memory; but its blocks, uniform
inside, give worse pictures at equal samples with every number of them tried, by 0.7 dB or more.
With brdfkit's linear densities they are as good if there are 1,024 of them, or if they are drawn by
their shares. To prepare blocks takes far longer. *Convex parts*: a ray takes about the printed
number of look-ups in them. They are exact by their true planes and a small ε, need fewer reads and
less time than height fields, and move cheaply; height fields have the better pictures, of brdfkit's
form on all meshes but one. As printed, parts shade themselves: few meshes reach the 39 dB of the
thesis, and a middle concavity is best on four of five. With brdfkit's clearance, 0.03, which was
chosen on these very meshes, all reach them, and the more parts the better; with 0.02 or 0.04 one
mesh does not. *Lobes*: as printed, mixtures show edges between views, kernels none, and kernels are
faster if they are few: 8 of them come near the printed number of good scenes, and are 3.3 times as
fast as filtered sampling with 64 directions, as printed. But filtered sampling is better in all
settings that were tried than in the thesis, so that kernels are nowhere clearly the best, as
printed or as wide together as their lobe. What surprised: interpolation between views takes nearly
all edges of mixtures away, and adds 4 to 18 dB.

The thesis has no tables; its figures' numbers are in the text, or lost. It names no BRDF, no block
count, no samples per pixel, no resolution and no definition of PSNR, and its times are of a
graphics card. So ours are ratios and orders, at settings that are told with each claim.

- **Maps**: grace, pisa and uffizi are P. Debevec's probes, of 256 × 128 pixels with 8-bit
  mantissas; doge2 was not to be had, and ennis stands in. Where they are missing, the maps that
  brdfkit brings (room, sky, studio) stand in for all of them.
- **Meshes**: of the models of the thesis only the bunny is at hand; eleven others stand in.

A claim is *confirmed* where our figures agree, in all that was tried, *not confirmed* where they do
not, *not stated* where the thesis gives no figure or comparison to set ours beside, and would be
*not run* where a file were missing. *Holds where* names the largest block of the settings that were
tried in which a claim holds without exception, if that is an eighth of them or more, and not a
single one of more than four."""

# The probes and meshes are optional: they are looked for beside the folder of measurements
NEEDS: dict[str, str] = {}

PARTS = (
    "block_criteria",
    "block_law",
    "block_counts",
    "block_sampling",
    "sample_times",
    "convex_rays",
    "convex_reads",
    "convex_times",
    "convex_pictures",
    "convex_settings",
    "convex_concavity",
    "convex_gallery",
    "moving_parts",
    "lobe_scenes",
    "lobe_speeds",
    "lobe_views",
)
