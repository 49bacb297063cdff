"""`plot`: the lobes of BRDFs in polar plots, with matplotlib."""

from brdfkit.materials.plotting.lobe_plots import plot as plot
