"""Makes data/priors/models.npz, the prior of random models, in one to three minutes.

python data/priors/make.py
"""

from pathlib import Path

import brdfkit as bk
from brdfkit.materials.completion.prior_file import write_prior
from brdfkit.materials.completion.prior_making import make_model_prior

if __name__ == "__main__":
    with bk.progress("materials") as bar:
        write_prior(make_model_prior(progress=bar), Path(__file__).with_name("models.npz"))
