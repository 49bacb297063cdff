"""`plot` draws BRDFs in the plane of incidence as polar plots, with matplotlib."""

from brdfkit.materials.plotting.lobe_plots import plot as plot
