# `make demo` needs python3 (3.11 or newer, with venv) and make; everything else goes into .venv in this folder.
PYTHON ?= python3
VENV := .venv
PY := $(VENV)/bin/python
PIP := $(PY) -m pip install --quiet --disable-pip-version-check --prefer-binary
OUT ?= out/horus-2b

.PHONY: help demo test validate docs bench lint clean

help:
	@echo "make demo      HORUS-2B from its shape to its flying qualities; writes $(OUT)/report.html"
	@echo "make test      the test suite"
	@echo "make validate  published cases on fine meshes, with the table of deviations"
	@echo "make docs      the documentation, into site/"
	@echo "make bench     seconds per stage, against the baseline of this machine"
	@echo "make lint      ruff: rules and format"

# The stamps make a second run skip pip; a changed pyproject.toml installs again.
$(VENV)/.installed: pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
	  { echo "spaceplane needs Python 3.11 or newer; $(PYTHON) is `$(PYTHON) --version 2>&1`. Try: make PYTHON=python3.12"; exit 1; }
	@$(PYTHON) -c 'import venv, ensurepip' 2>/dev/null || \
	  { echo "$(PYTHON) has no venv module. On Debian and Ubuntu: sudo apt install python3-venv"; exit 1; }
	@test -x $(PY) || { echo "Creating $(VENV) ..."; $(PYTHON) -m venv $(VENV); }
	@echo "Installing spaceplane into $(VENV) ..."
	@$(PIP) -e .
	@touch $@

$(VENV)/.installed-dev: $(VENV)/.installed
	@echo "Installing the test and documentation tools into $(VENV) ..."
	@$(PIP) -e '.[dev,docs]'
	@touch $@

# `analyse` exits 1 when a flow condition did not converge; the report is complete all the same and names it.
demo: $(VENV)/.installed
	@rm -f $(OUT)/report.html
	@$(VENV)/bin/spaceplane analyse horus-2b --out $(OUT) || \
	  { test $$? -eq 1 && test -f $(OUT)/report.html && echo "The report is complete and marks what did not converge."; }

test: $(VENV)/.installed-dev
	@$(PY) -m pytest

validate: $(VENV)/.installed
	@$(VENV)/bin/spaceplane validate --out out/validation

docs: $(VENV)/.installed-dev
	@$(PY) docs/generate.py --check
	@NO_MKDOCS_2_WARNING=1 $(PY) -m mkdocs build --strict --quiet --site-dir site
	@echo "Documentation: site/index.html"

bench: $(VENV)/.installed
	@$(PY) benchmarks/run.py

lint: $(VENV)/.installed-dev
	@$(PY) -m ruff check .
	@$(PY) -m ruff format --check .

clean:
	rm -rf out site .pytest_cache .ruff_cache
	find src tests -name __pycache__ -type d -prune -exec rm -rf {} +
