# pinwarp: `make run` opens the window on the sample bones, `make test` is what CI runs.

PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin
SCREEN := xvfb-run -a -s "-screen 0 1920x1080x24"
# One BLAS thread: on few cores its pool only fights with everything else.
export OPENBLAS_NUM_THREADS = 1
export QT_API = pyside6
export PYTHON
# What was compiled once is kept: the tests start the program some hundred times.
unexport PYTHONDONTWRITEBYTECODE

# The system packages come before everything else, with -j too.
.NOTPARALLEL:

.PHONY: run test lint types layers check bench pictures wheel bundle clean help

help:
	@echo "make run      open the window on the sample bones"
	@echo "make test     lint, types, import rules and tests, under a virtual screen"
	@echo "make bench    speed and memory against other libraries, under 5 minutes"
	@echo "make pictures draw the pictures of the README and of the user guide anew"
	@echo "make wheel    the package for pip, pipx and uv, and its sources, into dist"
	@echo "make bundle   the program that needs no Python, for this system, into dist"
	@echo "make clean    remove the environment and what was built"

# Without a display the window cannot open: a picture of it is the next best thing.
run:
	@if [ -n "$$DISPLAY$$WAYLAND_DISPLAY" ]; then \
	  .make/system-packages && $(MAKE) --no-print-directory $(VENV)/run && exec $(BIN)/pinwarp --demo; \
	else \
	  echo "There is no display here: writing a picture of the sample session instead."; \
	  .make/system-packages --screen && $(MAKE) --no-print-directory $(VENV)/run \
	  && $(SCREEN) $(BIN)/pinwarp --demo --screenshot pinwarp-demo.png \
	  && echo "Wrote pinwarp-demo.png"; \
	fi

test: system-with-screen $(VENV)/dev
	$(MAKE) --no-print-directory check

.PHONY: system-with-screen
system-with-screen:
	@.make/system-packages --screen

check: lint types layers
	$(BIN)/python -m pytest -n auto --dist worksteal

lint:
	$(BIN)/ruff check
	$(BIN)/ruff format --check

types:
	$(BIN)/mypy

layers:
	$(BIN)/lint-imports

# ARGS="--json figures.json" keeps the figures, ARGS="--only live" measures a part.
bench: system-with-screen $(VENV)/dev
	$(SCREEN) $(BIN)/python -m tests.benchmarks $(ARGS)

pictures: system-with-screen $(VENV)/run
	xvfb-run -a -s "-screen 0 1280x800x24" $(BIN)/python assets/make_help_pictures.py

# The wheel is built from the sources that are handed out, not from the checkout.
wheel: $(VENV)/pip
	$(BIN)/python -m pip install --quiet --group wheel
	$(BIN)/python -m build --outdir dist
	$(BIN)/twine check --strict dist/*.whl dist/*.tar.gz

# An environment of its own: what lies in a developer's would go into the bundle. Windows, where
# make is rare, takes these three lines as they are.
bundle:
	$(PYTHON) -m venv build/venv
	build/venv/bin/python -m pip install --quiet --upgrade "pip>=25.1"
	build/venv/bin/python -m pip install --quiet . --group bundle
	build/venv/bin/python .bundle/make.py

$(VENV)/pip:
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --upgrade "pip>=25.1"
	@touch $@

$(VENV)/run: $(VENV)/pip pyproject.toml
	$(BIN)/python -m pip install --quiet --editable .
	@touch $@

$(VENV)/dev: $(VENV)/run
	$(BIN)/python -m pip install --quiet --group dev
	@touch $@

clean:
	rm -rf $(VENV) .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache build dist
