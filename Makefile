# Everything works from a fresh clone: the first target that needs it sets up .venv with the pinned dependencies.
# PYTHON=... chooses the interpreter; without it the first suitable one of these is taken.
CANDIDATES := python3 python3.13 python3.12 python3.11
PYTHON ?=
BIN := .venv/bin
STAMP := .venv/.stamp
PIP := -m pip --disable-pip-version-check --quiet
PYTEST := $(BIN)/python -m pytest

.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
.PHONY: help demo test test-all deep mutants coverage verification lint format docs bench bare constraints clean

help: ## list the targets
	@sed -n 's/^\([a-z-]*\):.*## \(.*\)/  make \1|\2/p' $(MAKEFILE_LIST) | awk -F'|' '{printf "%-20s %s\n", $$1, $$2}'

$(STAMP): pyproject.toml constraints.txt
	@usable='import sys, venv, ensurepip; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 13))'; \
	for python in $(or $(PYTHON),$(CANDIDATES)); do \
		if "$$python" -c "$$usable" >/dev/null 2>&1; then found=$$python; break; fi; \
	done; \
	if [ -z "$$found" ]; then \
		echo "equipoise needs Python 3.11, 3.12 or 3.13 with its venv module; tried: $(or $(PYTHON),$(CANDIDATES))." >&2; \
		echo "Install one (on Debian: apt-get install python3 python3-venv) or name it: make PYTHON=/path/to/python3.12" >&2; \
		exit 1; \
	fi; \
	echo "Setting up .venv with $$("$$found" --version) and the pinned dependencies: a minute or two"; \
	"$$found" -m venv .venv
	@$(BIN)/python $(PIP) install -c constraints.txt pip hatchling editables
	@$(BIN)/python $(PIP) install -c constraints.txt --no-build-isolation -e '.[cad,proof,report,room,sim,study,view]' --group dev
	@touch $@

demo: $(STAMP) ## the main job on a real robot, start to finish
	@$(BIN)/equipoise demo

test: $(STAMP) ## the tests, but for those that are marked slow
	$(PYTEST) -n 2 -m "not slow"

test-all: $(STAMP) ## all tests; those in a browser afterwards, one at a time
	$(PYTEST) -n 2 -m "not browser"
	$(PYTEST) -m browser

deep: $(STAMP) ## long campaigns: twenty times what test-all tries of them
	EQUIPOISE_DEEP=1 $(PYTEST) -n 2 -m deep

mutants: $(STAMP) ## break the source at 400 places drawn at random, and ask the tests of each: hours
	$(BIN)/python tests/mutants.py

coverage: $(STAMP) ## branch coverage of energy, balance, synthesis and hardware by the tests that are not slow
	@$(BIN)/python $(PIP) install -c constraints.txt --group mutation
	$(BIN)/python -m coverage run --branch --source=src/equipoise -m pytest -q -m "not slow"
	$(BIN)/python -m coverage report --include='*/energy/*,*/balance.py,*/synthesis/*,*/hardware/*'

verification: $(STAMP) ## the verification manual, docs/verification.md
	$(BIN)/python tests/verification.py --write

lint: $(STAMP) ## style, format, types, import contracts and circles
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/pyright
	$(BIN)/lint-imports
	$(BIN)/python tests/check_imports.py

format: $(STAMP) ## put the sources into the format that lint asks for
	$(BIN)/ruff check --fix
	$(BIN)/ruff format

docs: $(STAMP) ## the documentation, into docs/_build/html
	$(BIN)/sphinx-build -q -W --keep-going -j auto -b html docs docs/_build/html
	$(BIN)/python docs/check_site.py docs/_build/html
	@echo "Open docs/_build/html/index.html"

bench: $(STAMP) ## the benchmarks
	$(BIN)/python benchmarks/run.py

bare: $(STAMP) ## install the wheel without extras into a throw-away environment and start it
	@echo "Trying the bare install, without extras, in a throw-away environment"
	@set -e; dir=$$(mktemp -d); trap 'rm -rf "$$dir"' EXIT; \
	$(BIN)/python $(PIP) wheel --no-deps --no-build-isolation --wheel-dir "$$dir" .; \
	$(BIN)/python -m venv "$$dir/venv"; \
	"$$dir/venv/bin/python" $(PIP) install -c constraints.txt "$$dir"/equipoise-*.whl; \
	cd "$$dir"; \
	venv/bin/python -c 'import equipoise'; \
	venv/bin/equipoise --help

constraints: $(STAMP) ## compile constraints.txt anew from pyproject.toml (add UPGRADE=1 for the newest versions)
	@$(BIN)/python -c 'import tomllib; print(*sum(tomllib.load(open("pyproject.toml", "rb"))["dependency-groups"].values(), []), sep="\n")' | \
	CUSTOM_COMPILE_COMMAND='make constraints' $(BIN)/pip-compile --quiet $(if $(UPGRADE),--upgrade) \
		--all-extras --allow-unsafe --strip-extras --no-annotate \
		--no-emit-index-url --no-emit-find-links --no-emit-trusted-host \
		--output-file constraints.txt pyproject.toml -

clean: ## remove what the other targets made
	rm -rf .venv docs/_build docs/_generated build dist .pytest_cache .ruff_cache .hypothesis .benchmarks .import_linter_cache
	find src tests -name __pycache__ -type d -prune -exec rm -rf {} +
