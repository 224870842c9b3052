# make run    sets up what is needed and runs the main job
# make test   sets up what is needed and runs lint, types, import rules and tests
# make clean  removes the virtual environment and the caches of the tools

PYTHON ?= $(shell command -v python3.11 || command -v python3)
BIN := .venv/bin

export OPENBLAS_NUM_THREADS := 1
export PIP_CONSTRAINT := constraints.txt
export PIP_DISABLE_PIP_VERSION_CHECK := 1

.PHONY: run test lint clean

run: .venv/ready-to-run
	$(BIN)/railslide run low-adhesion-stop

test: lint
	$(BIN)/python -m pytest -n 2 --dist loadfile

lint: .venv/ready-to-test
	$(BIN)/python -m ruff check .
	$(BIN)/python -m ruff format --check .
	$(BIN)/python -m mypy
	$(BIN)/lint-imports

# The environment is rebuilt in place when the wanted packages change, and left alone otherwise.
.venv/bin/python:
	@test -n "$(PYTHON)" || { echo "no python3 found: Python 3.11 is needed" >&2; exit 1; }
	@$(PYTHON) -c "import sys; sys.exit(sys.version_info < (3, 11) and 'Python 3.11 is needed, found ' + sys.version.split()[0])"
	$(PYTHON) -m venv .venv

.venv/ready-to-run: pyproject.toml constraints.txt | .venv/bin/python
	$(BIN)/python -m pip install --quiet --editable .
	@touch $@

.venv/ready-to-test: pyproject.toml constraints.txt | .venv/bin/python
	$(BIN)/python -m pip install --quiet --editable ".[dev]"
	@touch $@ .venv/ready-to-run

clean:
	rm -rf .venv .mypy_cache .pytest_cache .ruff_cache .import_linter_cache .hypothesis *.egg-info
