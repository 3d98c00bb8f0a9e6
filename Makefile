# make study   the main studies, from their files to results/index.html (4 minutes on two cores)
# make paper   the figures and statements of the paper, in results/paper (about 20 minutes on two idle
#              cores, 35 of processor time, nearly all of it for the 3-D model)
# make all     every study, the large ones too, and the paper (one to two hours)
# make test    the checks, and the tests of up to a minute
# make long    the tests that take longer: the 3-D model and its decks on finer meshes
# make chaos   what crashes, full disks, lost workers and hostile files must not do (4 minutes)
# make kratos  the 3-D model against Kratos Multiphysics, in a coarse case (2 minutes)
# make oldest  quick unit tests with the lowest versions that pyproject.toml allows (3 minutes)
# make docs    the site, in site/index.html: its notebooks and small studies are solved (6 minutes)
# make stored  answers and pictures of the gallery's large studies, in docs/stored: those without any
#              that are current (a minute to half an hour each), or STORED='sobol_large witness'
# make site    the same, then its pages, links and code blocks are tested
# make release sdist and wheel in dist/, checked; nothing is uploaded or tagged
# make bench   the kernel's cost, in times an elastic C stencil (needs gcc); that of single runs and
#              batches, in times their kernels; both schemes' cost and error; estimated cost;
#              how often the intervals of Sobol indices hold: wants an idle machine
# make scaling overhead, throughput, threads and peak memory of a study: SCALING_ARGS=--full for a
#              million runs
# make mutants the tests' own test: faults seeded into the kernels, and what catches each
# make lint | coverage | constraints | clean
# Settings: PYTHON=python3.12  CORES=4  STUDIES=velocity,sobol  PYTEST_ARGS="-k contact"
PYTHON ?= python3
CORES ?= all
STUDIES ?= velocity discretisation material model_form ishigami sobol_slow sobol sobol_fast verification
PYTEST_ARGS ?=
SCALING_ARGS ?=
STORED ?=
UV ?= uv
OLDEST_TESTS ?= jit solver/test_jit.py model/test_quantities.py study analysis
VENV ?= .venv
OLDEST ?= .venv-oldest

BIN := $(VENV)/bin
# Named for this folder and this Python: a copied checkout would otherwise run the other's code.
KEY := $(shell { pwd -P; $(PYTHON) -c 'import sys; print(sys.version_info[:2])'; } 2>&1 | cksum | cut -d ' ' -f 1)
MADE := $(VENV)/made-$(KEY)
MADE_OLDEST := $(OLDEST)/made-$(KEY)
# Without it every step compiles its libraries' bytecode again, for seconds.
unexport PYTHONDONTWRITEBYTECODE
IN_VENV := PATH="$(abspath $(BIN)):$$PATH"
PIP := $(BIN)/python -m pip --disable-pip-version-check
# By uv in a quarter of pip's time; pip knows package indices and certificates of its own settings.
PINNED = --constraint constraints.txt --editable '.[$*]'
# Its default of 100/1s has it look around once a second for every job done: half a core in the end.
SNAKEMAKE := $(IN_VENV) snakemake --cores $(CORES) --keep-going --rerun-incomplete \
  --max-jobs-per-timespan 100/5s

.PHONY: writable study paper all test lint kernels pytest long chaos kratos oldest docs stored site release bench scaling mutants coverage constraints unlock clean
.DEFAULT_GOAL := study

STOPPED := echo; echo 'Not finished, or a check failed: see the messages above and the logs in results/*/logs.'; \
  echo 'What is done is kept: the same command goes on from there (`make unlock` first, if it says locked).'; \
  exit 1

# Environment, results and Snakemake's notes go into this folder.
writable:
	@test -w . || { echo 'You cannot write to $(CURDIR), where results and environment go.'; \
	  echo 'Clone it into a folder of your own: git clone $(CURDIR) ~/impactlab'; exit 1; }

# All kernels at once: they share what they have in common, and checks need them all.
study: writable $(MADE)-workflow
	@$(IN_VENV) impactlab compile
	@$(SNAKEMAKE) --quiet all --config studies='$(STUDIES)' || { $(STOPPED); }
	@echo; echo 'Done. Open results/index.html'

paper: writable $(MADE)-workflow
	@$(SNAKEMAKE) --quiet all -- paper || { $(STOPPED); }
	@echo; echo 'Done. Open results/paper/claims.html'

all: writable $(MADE)-workflow
	@$(SNAKEMAKE) --quiet all -- all paper || { $(STOPPED); }
	@echo; echo 'Done. Open results/index.html and results/paper/claims.html'

# Types are checked on one core while kernels compile.
test: $(MADE)-dev
	$(MAKE) --jobs 2 --output-sync=target lint kernels
	$(MAKE) pytest

lint: $(MADE)-dev
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(IN_VENV) snakemake --lint

# At once: they share what they have in common.
kernels: $(MADE)-dev
	$(IN_VENV) impactlab compile --wings

pytest: kernels
	$(IN_VENV) python -m pytest -n auto --dist worksteal $(PYTEST_ARGS)

long: $(MADE)-dev
	$(IN_VENV) python -m pytest -n 3 --dist worksteal -m long $(PYTEST_ARGS)

chaos: $(MADE)-dev
	$(IN_VENV) python -m pytest -n 2 --dist worksteal -m chaos $(PYTEST_ARGS)

kratos: $(MADE)-dev $(MADE)-kratos
	$(IN_VENV) python -m pytest -m kratos $(PYTEST_ARGS)

# What calls other libraries, and kernels against plain Python; other tests of kernels and of the model
# know no library's version, nor do those of series, which compile more kernels. Deprecations in old
# libraries are not errors.
oldest: $(MADE_OLDEST)
	PATH="$(abspath $(OLDEST)/bin):$$PATH" python -m pytest -n auto -W default --disable-warnings \
	  -m 'not slow and not long and not chaos' $(addprefix tests/unit/,$(OLDEST_TESTS)) \
	  --ignore tests/unit/study/test_series.py $(PYTEST_ARGS)

# Sphinx deals out pages once, as many to each job: with one for every core one core ends long before.
docs: $(MADE)-docs
	$(IN_VENV) python -m sphinx -W --keep-going --quiet \
	  --jobs $$($(BIN)/python -c 'import os; print(2 * os.cpu_count())') -d build/docs docs site
	@echo 'Done. Open site/index.html'

stored: $(MADE)-docs
	$(IN_VENV) python docs/made.py $(STORED)

site: docs $(MADE)-dev
	$(IN_VENV) python -m pytest -n auto --dist worksteal -m site $(PYTEST_ARGS)

# In an environment of its own, whose metadata may be newer than what .venv knows. Changelog and address
# last: until they are stated, what was built is for a trial.
release: $(MADE)-dev
	$(IN_VENV) python -m pytest tests/unit/test_packaging.py $(PYTEST_ARGS)
	rm -rf dist
	$(PYTHON) -m venv --clear build/release
	build/release/bin/python -m pip --disable-pip-version-check install --quiet build 'twine>=7'
	build/release/bin/python -m build
	build/release/bin/python -m twine check --strict dist/*
	@! grep '^## .*(unreleased)' CHANGELOG.md || { \
	  echo 'CHANGELOG.md: give this version its date before you upload dist/.'; exit 1; }
	@! grep '^repository = ""' pyproject.toml || { \
	  echo 'pyproject.toml: state the repository, or no link of the README works on the package index.'; \
	  exit 1; }

bench: $(MADE)-dev
	$(IN_VENV) python tests/benchmarks/kernel.py
	$(IN_VENV) python tests/benchmarks/calls.py
	$(IN_VENV) python tests/benchmarks/schemes.py
	$(IN_VENV) python tests/benchmarks/cost.py
	$(IN_VENV) python tests/benchmarks/sobol_coverage.py

scaling: $(MADE)-dev
	$(IN_VENV) python tests/benchmarks/scaling.py $(SCALING_ARGS)

mutants: $(MADE)-dev
	$(BIN)/python tests/mutations/run.py

# Compiled kernels hide from coverage: here they run as plain Python, on the small cases only.
coverage: $(MADE)-dev
	$(IN_VENV) NUMBA_DISABLE_JIT=1 python -m pytest tests/unit -m 'not slow and not long and not chaos and not kratos' \
	  --cov --cov-report=term-missing:skip-covered $(PYTEST_ARGS)

# Newest versions for every Python and platform; needs uv (https://docs.astral.sh/uv).
constraints:
	$(UV) pip compile pyproject.toml --all-extras --universal --python-version 3.11 \
	  --fork-strategy fewest --upgrade --no-emit-index-url --no-emit-find-links \
	  --no-header --no-annotate --quiet --output-file constraints.txt

unlock: $(MADE)-workflow
	$(SNAKEMAKE) --unlock

# Keeps results.
clean:
	rm -rf $(VENV) $(OLDEST) build dist site jupyter_execute docs/gallery .coverage htmlcov .hypothesis .import_linter_cache \
	  .mypy_cache .pytest_cache .ruff_cache

$(MADE):
	@$(PYTHON) -c 'import sys; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 13))' 2>/dev/null || { \
	  echo 'impactlab needs Python 3.11, 3.12 or 3.13; $(PYTHON) is:' `$(PYTHON) -V 2>&1 | head -n 1`; \
	  echo 'Name another one: make $(MAKECMDGOALS) PYTHON=python3.12'; exit 1; }
	@$(PYTHON) -c 'import ensurepip, venv' 2>/dev/null || { \
	  echo '$(PYTHON) cannot make environments: its parts venv and ensurepip are missing.'; \
	  echo 'Debian and Ubuntu: sudo apt install python3-venv'; exit 1; }
	$(PYTHON) -m venv --clear $(VENV)
	@touch $@

$(MADE)-%: $(MADE) pyproject.toml constraints.txt
	@echo 'Installing into $(VENV) (a minute the first time) ...'
	@$(PIP) install --quiet --no-compile --constraint constraints.txt uv
	@$(BIN)/uv pip install --python $(BIN)/python --quiet --no-cache $(PINNED) || \
	  $(PIP) install --quiet --no-compile $(PINNED)
	@touch $@

$(MADE_OLDEST): pyproject.toml
	$(PYTHON) -m venv --clear $(OLDEST)
	$(OLDEST)/bin/python -m pip --disable-pip-version-check install --quiet uv
	VIRTUAL_ENV=$(OLDEST) $(OLDEST)/bin/uv pip install --quiet --resolution lowest-direct --editable '.[dev]'
	@touch $@
