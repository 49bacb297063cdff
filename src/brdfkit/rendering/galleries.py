"""`gallery`: a grid of pictures, with a row for each material and a column for each model."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from brdfkit.core.colours import to_srgb
from brdfkit.core.documents import Document, Paragraph, Picture, Shown, Table
from brdfkit.core.documents.parts import SOFT
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import write_safely
from brdfkit.core.names import make_unique, to_printable
from brdfkit.core.progress_bar import Progress
from brdfkit.rendering.render_materials import SceneLike, render
from brdfkit.rendering.result import Rendering
from brdfkit.rendering.scene_input.arguments import Renderable, to_material_list, to_named_material

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Widths of four spaces [pixels]: above the grid and at its left, for names; below each picture, for
# the caption; and between columns
HEAD, SIDE, BELOW, GAP = 26, 26, 22, 6
DPI = 100  # resolution of the figure [pixels per inch]


@dataclass(frozen=True, eq=False, repr=False)
class Gallery(Shown):
    """Pictures of materials and of models fitted to them, made by `gallery`.

    A gallery prints as a table of PSNRs, each of a fit's picture to the picture of its material.

    Attributes
    ----------
    rows : dict of str to Rendering
        For each material, by name, the pictures of its row; the first shows the material itself.
    """

    rows: dict[str, Rendering] = field(repr=False)

    def write(self, path: str | Path) -> None:
        """Write the grid as a picture.

        Parameters
        ----------
        path : str or Path
            The file, `.png`.

        Raises
        ------
        BrdfkitError
            For another suffix, or a file that cannot be written; nothing is half-written.

        Examples
        --------
        >>> gallery([["car_paint", "ward"]], spp=16).write("paint.png")    # doctest: +SKIP
        """
        path = Path(path)
        if path.suffix.lower() != ".png":
            raise BrdfkitError(f"{path}: a gallery is written as .png; choose that.")
        with write_safely(path) as beside:
            draw_grid(self.rows).savefig(beside, format="png", dpi=DPI)

    def document(self) -> Document:
        """Return the grid, and a table of the PSNR of each fit's picture to its material's."""
        first = next(iter(self.rows.values()))
        height, width = first.pictures[first.reference].shape[:2]
        columns = ("material", *(f">{name}" for name in first.differences))
        rows = [
            (name, *(f"{value:.1f}" for value in rendering.psnr().values()))
            for name, rendering in self.rows.items()
        ]
        width_of_grid, _ = _compute_grid_size(self.rows)
        picture = Picture(self._to_png, f"pictures of {', '.join(self.rows)}", width_of_grid)
        unit = (Paragraph("PSNR to the material [dB].", SOFT),) if first.differences else ()
        title = f"{len(rows)} × {len(columns)} pictures, {width}×{height} pixels, {first.spp} spp"
        return Document(title, (picture, Table(tuple(rows), columns), *unit))

    def _to_png(self) -> bytes:
        """Draw the grid as a PNG for notebooks."""
        from brdfkit.core.figures import to_png  # not at the top, as it imports matplotlib

        return to_png(draw_grid(self.rows), DPI)


def gallery(
    materials: Iterable[Iterable[Renderable]],
    *,
    spp: int = 64,
    size: int = 192,
    scene: SceneLike = "ball",
    seed: int = 0,
    progress: Progress | None = None,
) -> Gallery:
    """Path-trace materials and their fits into one picture: a labelled grid, a row per material.

    Parameters
    ----------
    materials : iterable of iterables of what `render` takes
        A row for each material: the material itself, which is the reference of its row, then its
        fits; the models must be the same in every row.
    spp : int, default 64
        Samples per pixel.
    size : int, default 192
        Side of each picture [pixels].
    scene : str, Path or callable, default "ball"
        The scene, as for `render`.
    seed : int, default 0
        Seed of the samples, the same in every picture.
    progress : callable, optional
        Called with (done, total) after each row.

    Returns
    -------
    Gallery
        A `Rendering` for each row; ``write`` makes a PNG, and notebooks show it.

    Raises
    ------
    BrdfkitError
        For rows with different models, and for materials or scenes that `render` rejects.

    Examples
    --------
    >>> materials = [bk.load(n) for n in ("car_paint", "brushed_aluminium")]    # doctest: +SKIP
    >>> gallery([[m, bk.fit(m, "ward"), bk.fit(m, "ggx")] for m in materials])    # doctest: +SKIP
    """
    if isinstance(materials, str) or not isinstance(materials, Iterable):
        raise BrdfkitError(
            f"materials = {materials!r:.60} should be rows of materials, as in "
            "[[material, fit, fit]]."
        )
    listed = [to_material_list(row) for row in materials]
    if not listed:
        raise BrdfkitError("There is nothing to render; give at least one row.")
    columns = [[to_named_material(fit)[0] for fit in row[1:]] for row in listed]
    for names in columns:
        if names != columns[0]:
            raise BrdfkitError(
                f"The rows of a gallery should show the same models: here are {', '.join(names)}, "
                f"in the first row {', '.join(columns[0])}."
            )
    renderings: dict[str, Rendering] = {}
    for done, row in enumerate(listed, 1):
        rendering = render(row, spp=spp, size=size, seed=seed, scene=scene)
        renderings[make_unique(rendering.reference, renderings)] = rendering
        if progress:
            progress(done, len(listed))
    return Gallery(renderings)


def draw_grid(rows: Mapping[str, Rendering]) -> Figure:
    """Draw renderings, given by material name, as the rows of a matplotlib `Figure`.

    The pictures are not resized.
    """
    from matplotlib.figure import Figure

    first = next(iter(rows.values()))
    height, width = first.pictures[first.reference].shape[:2]
    total = _compute_grid_size(rows)

    figure = Figure(figsize=(total[0] / DPI, total[1] / DPI), dpi=DPI)
    for i, (material, rendering) in enumerate(rows.items()):
        psnr = rendering.psnr()
        for j, (name, picture) in enumerate(rendering.pictures.items()):
            left, top = SIDE + j * (width + GAP), HEAD + i * (height + BELOW)
            corner = left / total[0], 1 - (top + height) / total[1]
            axes = figure.add_axes((*corner, width / total[0], height / total[1]))
            axes.imshow(to_srgb(picture), interpolation="none")
            axes.set(xticks=[], yticks=[], frame_on=False)
            axes.set_xlabel(f"{psnr[name]:.1f} dB" if name in psnr else "", fontsize=8, labelpad=3)
            # Names may contain dollar signs, which must not begin formulas
            plain: dict[str, Any] = {"fontsize": 9, "parse_math": False}
            if i == 0:
                axes.set_title(to_printable(name) if j else "reference", pad=4, **plain)
            if j == 0:
                axes.set_ylabel(to_printable(material), labelpad=4, **plain)
    return figure


def _compute_grid_size(rows: Mapping[str, Rendering]) -> tuple[int, int]:
    """Return the (width, height) of the grid of pictures, with names and captions [pixels]."""
    first = next(iter(rows.values()))
    height, width = first.pictures[first.reference].shape[:2]
    columns = max(len(r.pictures) for r in rows.values())
    return SIDE + columns * (width + GAP), HEAD + len(rows) * (height + BELOW)
