# Set-up, demo and tests on a machine that has Python 3.11 and make. Everything lives in .venv and build/.
PYTHON ?= python3
ifeq ($(OS),Windows_NT)
  BIN := .venv/Scripts
else
  BIN := .venv/bin
endif

.PHONY: demo test test-all benchmarks clean

demo: .venv/installed
	$(BIN)/shipcosim build
	$(BIN)/shipcosim run scenarios/four_corner.toml

test: .venv/installed-test
	$(BIN)/shipcosim build
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/pyright
	$(BIN)/pytest -n 2 --dist loadfile tests/unit tests/system src

test-all: .venv/installed-test
	$(BIN)/python -m pip install --quiet --editable ".[allocators]"
	$(BIN)/shipcosim build
	$(BIN)/pytest

benchmarks: .venv/installed-test
	$(BIN)/shipcosim build
	$(BIN)/pytest -s tests/bench tests/system/bench/allocation tests/system/bench/prediction

.venv/installed: pyproject.toml
	$(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --editable .
	$(BIN)/python -c "open('.venv/installed', 'w')"

# torch by its exact version: where a CPU build is at hand pip takes that one, a range would fetch gigabytes of GPU packages
.venv/installed-test: .venv/installed
	$(BIN)/python -m pip install --quiet torch==2.13.0
	$(BIN)/python -m pip install --quiet --editable ".[docs,engines,test]"
	$(BIN)/python -c "open('.venv/installed-test', 'w')"

clean:
	$(PYTHON) -c "import shutil; [shutil.rmtree(d, ignore_errors=True) for d in ('.venv', 'build', 'results')]"
