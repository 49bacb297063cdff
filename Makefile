# make demo | notebook | ipynb | test | quick | oracles | lint | bench | docs | site | wheel; everything happens in .venv, nothing else is needed
PYTHON ?= python3
VENV := .venv
RUN := $(VENV)/bin
# NumPy's threads beside Dr.Jit's, times two workers, would wait for each other; and what Python
# compiles is kept, because tests start processes that load the whole library
PYTEST := OPENBLAS_NUM_THREADS=1 PYTHONDONTWRITEBYTECODE= $(RUN)/python -m pytest -n 2

.PHONY: demo notebook ipynb test quick oracles lint bench docs site wheel clean

$(VENV)/.ready: pyproject.toml
	$(PYTHON) -m venv $(VENV)
	$(RUN)/python -m pip install --quiet --upgrade "pip>=25.1"
	$(RUN)/python -m pip install --quiet --editable . --group dev
	@touch $@

demo: $(VENV)/.ready
	$(RUN)/brdfkit fit brushed_aluminium -m ward_duer:form=bounded -m ashikhmin_shirley -m ggx --render -o demo
	@echo "The pictures: demo/render.png (to look at), demo/render.exr (all parts, linear)"

# JupyterLab shows Markdown as text unless its settings, here those of .venv, say that it is a notebook
LABCONFIG := $(VENV)/etc/jupyter/labconfig/default_setting_overrides.json

notebook: $(VENV)/.ready
	$(RUN)/jupytext-config --settings-file $(LABCONFIG) set-default-viewer markdown
	$(RUN)/jupyter lab --LabApp.default_url=/lab/tree/notebooks/first_render.md

# For editors that open no text as a notebook, such as VS Code
ipynb: $(VENV)/.ready
	$(RUN)/jupytext --to ipynb notebooks/[a-z]*.md

test: lint
	$(PYTEST)

quick: $(VENV)/.ready
	$(PYTEST) -m quick

oracles: $(VENV)/.ready
	-$(RUN)/python -m pip install --quiet --group oracles  # without it, tests are skipped
	$(PYTEST) -m oracles

lint: $(VENV)/.ready
	$(RUN)/ruff check
	$(RUN)/ruff format --check
	$(RUN)/lint-imports --no-logo --no-cache
	$(RUN)/mypy

bench: $(VENV)/.ready
	DRJIT_CACHE_DIR=$$(mktemp -d) $(RUN)/python benchmarks/model_times.py
	$(RUN)/python docs/tools/make_performance.py

docs: $(VENV)/.ready
	$(RUN)/python docs/tools/make_models.py
	$(RUN)/python docs/tools/make_plugins.py
	$(RUN)/python docs/tools/make_formats.py
	$(RUN)/python docs/tools/make_references.py
	$(RUN)/python docs/tools/make_architecture.py
	[ -z "$$BRDFKIT_DATA" ] || $(RUN)/python docs/tools/make_real_measurements.py
	$(MAKE) site

site: $(VENV)/.ready
	$(RUN)/python -m sphinx -W --keep-going -n -q docs docs/_build/html
	@echo "The site: docs/_build/html/index.html"

wheel: $(VENV)/.ready
	$(RUN)/python -m build

clean:
	rm -rf $(VENV) build dist demo docs/_build docs/api docs/commands .mypy_cache .pytest_cache .ruff_cache .hypothesis
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
