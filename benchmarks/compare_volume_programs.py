# ruff: noqa: I001, for brdfkit comes first: it chooses the LLVM that Dr.Jit loads
"""Renders the conformance set of volumes in several programs, to compare with exact pictures.

    python benchmarks/compare_volume_programs.py  # minutes on two cores

It writes docs/volume_programs.md and .png. PyVista, VTK, K3D and Playwright with a Chromium have to
be installed: `pip install pyvista k3d playwright`. Each file `by_NAME.py` of `volume_programs/` is
for one program.
"""

import brdfkit  # noqa: F401
import mitsuba as mi

mi.set_variant("llvm_ad_rgb")

from volume_programs import by_brdfkit, by_k3d, by_mitsuba, by_pyvista, by_vtk, page  # noqa: E402
from volume_programs.case import NAMES, Case  # noqa: E402

PROGRAMS = by_brdfkit, by_vtk, by_pyvista, by_k3d, by_mitsuba


def main():
    pictures = {}
    for program in PROGRAMS:
        for name in NAMES:
            for setting in program.SETTINGS:
                picture = program.draw_case(Case(name), setting)
                if picture is not None:
                    pictures[name, program.NAME, setting] = picture
                    rms, most = page.compute_errors(picture, Case(name).exact)
                    print(f"{name}, {program.NAME}, {setting}: {rms:.2e}, {most:.2e}", flush=True)
    page.write_page(PROGRAMS, pictures)


if __name__ == "__main__":
    main()
