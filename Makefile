# Set-up, demo and tests on a machine that has Python 3.11 and make. Everything lives in .venv and build/.
PYTHON ?= python3
ifeq ($(OS),Windows_NT)
  BIN := .venv/Scripts
else
  BIN := .venv/bin
endif

.PHONY: demo quick test nightly docs durations clean

demo: .venv/installed
	$(BIN)/shipcosim build
	$(BIN)/shipcosim run scenarios/four_corner.toml

# before every commit: format, lint, tests/unit
quick: .venv/installed-test
	$(BIN)/python .ci/checks.py quick

# what CI runs: the same, types, tests/system and the examples in docstrings
test: .venv/installed-test
	$(BIN)/python .ci/checks.py test

# tests/bench, fresh seeds, and the numeric tests as on an older processor: hours
nightly: .venv/installed-test
	$(BIN)/python -m pip install --quiet --editable ".[allocators]"
	$(BIN)/python .ci/checks.py nightly

# the documentation as a site with search, and a ship to steer: build/site/index.html
docs: .venv/installed-docs
	$(BIN)/python -m mkdocs build --strict
	@echo "Page: build/site/index.html"

# after `make test`: how long its files of tests took decides their order from now on
durations: .venv/installed-test
	$(BIN)/python .ci/durations.py

.venv/installed: pyproject.toml
	$(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --editable .
	$(BIN)/python -c "open('.venv/installed', 'w')"

.venv/installed-docs: .venv/installed
	$(BIN)/python -m pip install --quiet --editable ".[docs,native]"
	$(BIN)/python -c "open('.venv/installed-docs', 'w')"

# Dask in a folder of its own: xarray imports it wherever it is found, 0.4 s of each of a thousand commands of the tests.
# torch by its exact version: where a CPU build is at hand pip takes that one, a range would fetch gigabytes of GPU packages
.venv/installed-test: .venv/installed
	$(BIN)/python -m pip install --quiet torch==2.13.0
	$(BIN)/python -m pip install --quiet --editable ".[docs,engines,test]"
	$(BIN)/python -m pip install --quiet --target .venv/cluster "distributed>=2024.8"
	$(BIN)/python -c "open('.venv/installed-test', 'w')"

clean:
	$(PYTHON) -c "import shutil; [shutil.rmtree(d, ignore_errors=True) for d in ('.venv', 'build', 'results')]"
