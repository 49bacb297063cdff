"""Ergun (2015): environment maps cut into blocks, convex visibility, BRDFs as Gaussian lobes."""

TITLE = "Ergun 2015, reproduced"
INTRODUCTION = """S. Ergun, *New approaches to real-time global illumination algorithms for dynamic
scenes*, PhD thesis, Ege University, 2015 [Ergun 2015]. Made by `brdfkit reproduce ergun2015`, which
runs each claim again and sets what came out beside what is printed.

The thesis has no tables; its figures' numbers are in the text, or lost. It names no BRDF, no block
count, no samples per pixel, no resolution and no definition of PSNR, and its times are of a
graphics card. So ours are ratios and orders, at settings that are told with each claim.

- **Maps**: grace, pisa and uffizi are P. Debevec's probes, of 256 × 128 pixels with 8-bit
  mantissas; doge2 was not to be had, and ennis stands in. Where they are missing, the maps that
  brdfkit brings (room, sky, studio) stand in for all of them.
- **Meshes**: of the models of the thesis only the bunny is at hand; eleven others stand in.

A claim is *confirmed* where our figures agree, *not confirmed* where they do not, *not stated*
where the thesis gives no figure to compare ours to, *not run* where a file is missing."""

# The probes and meshes are optional: they are looked for beside the folder of measurements
NEEDS: dict[str, str] = {}

PARTS = (
    "block_criteria",
    "block_law",
    "block_sampling",
    "convex_rays",
    "convex_reads",
    "convex_pictures",
    "convex_settings",
    "moving_parts",
    "lobe_scenes",
    "lobe_speeds",
    "lobe_views",
)
