# make demo | test | quick | lint | bench | wheel; everything happens in .venv, nothing else is needed
PYTHON ?= python3
VENV := .venv
RUN := $(VENV)/bin

.PHONY: demo test quick lint bench wheel clean

$(VENV)/.ready: pyproject.toml
	$(PYTHON) -m venv $(VENV)
	$(RUN)/python -m pip install --quiet --upgrade "pip>=25.1"
	$(RUN)/python -m pip install --quiet --editable . --group dev
	@touch $@

demo: $(VENV)/.ready
	$(RUN)/brdfkit fit car_paint --render -o demo
	@echo "The pictures: demo/render.png (to look at), demo/render.exr (all parts, linear)"

test: lint
	$(RUN)/python -m pytest -n 2

quick: $(VENV)/.ready
	$(RUN)/python -m pytest -n 2 -m quick

lint: $(VENV)/.ready
	$(RUN)/ruff check
	$(RUN)/ruff format --check

bench: $(VENV)/.ready
	$(RUN)/python tests/benchmark.py

wheel: $(VENV)/.ready
	$(RUN)/python -m build

clean:
	rm -rf $(VENV) build dist demo
