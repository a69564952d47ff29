# Thin: scripts/setup.sh does the set-up, scripts/env.sh puts its results on the path.
SHELL := /bin/bash
SCENE ?= config/paper.yaml
SECONDS ?= 5
MINUTES ?= 60
QUICK ?=
WORKERS ?= 4
ARGS ?=
SPREAD = -n $(WORKERS) --dist loadfile --no-loadscope-reorder --durations=12
export PYTHON

env := . scripts/env.sh

.DEFAULT_GOAL := help
.PHONY: help setup run test test-slow test-all coverage lint check-pip release check-clean check-oldest check-loaded soak bench docs clean

help:
	@echo 'fourbar_ros: exact motion, loads and extrema of planar linkages;'
	@echo 'a ROS 2 node and a Python library'
	@echo
	@echo '  make run        run a linkage in the node: live table, extrema, recorded bag, bag recomputed'
	@echo '                    SCENE=$(SCENE)  SECONDS=$(SECONDS)'
	@echo '  make test       run the tests, except the slow ones: five minutes    ARGS="-k loads" is passed to pytest'
	@echo '  make test-slow  run the slow ones, all of them'
	@echo '  make test-all   run all tests, to the end'
	@echo '                    WORKERS=$(WORKERS) processes, of which many wait; 0: one that prints'
	@echo '  make coverage   run the tests as make test does; lines and branches covered, in all processes'
	@echo '  make lint       run ruff, mypy, import-linter and the ament linters'
	@echo '  make check-pip  test the ways of installing without ROS: the wheel alone and with each extra, every command'
	@echo '                    PYTHON="python3.11 python3.14" with each of these, ARGS="--only all" with one extra'
	@echo '  make release    make dist/ and CHANGELOG.rst: twine check, installed into a bare environment, every command'
	@echo '                    QUICK=1: one command'
	@echo '  make check-clean   make run and make test in a fresh clone with a bare environment'
	@echo '  make check-oldest  the same with numpy 1.26 and scipy 1.11, as in Ubuntu 24.04'
	@echo '  make check-loaded  make test three times while six busy loops take the processor'
	@echo '  make soak       flood the node: garbage, clock steps, a slow disk, restarts; then hostile'
	@echo '                  parameters of every scene    MINUTES=60 of each'
	@echo '  make bench      measure accuracy, speed, extrema, node and recorder   ARGS="speed"'
	@echo '  make docs       build the site into build/site; a broken link or a stale measurement fails'
	@echo '  make setup      only set up: .venv, ROS 2, build'
	@echo '  make clean      remove .venv build install log'
	@echo
	@echo 'Each target first sets up what is missing: minutes the first time, seconds later.'
	@echo 'PYTHON=python3.12 selects the interpreter (3.11 to 3.13).'
	@echo 'A sourced ROS 2 is used; otherwise ROS 2 Jazzy is installed from PyPI into .venv.'
	@echo 'In your own shell:  . scripts/env.sh   then  fourbar --help,  fourbar_node,  python'

setup:
	@scripts/setup.sh
	@echo 'ready:  . scripts/env.sh'

run:
	@[ -f '$(SCENE)' ] || [ -f 'config/$(SCENE).yaml' ] || { echo 'SCENE=$(SCENE): no such file or scene' >&2; exit 1; }
	@scripts/setup.sh
	@$(env) && fourbar_demo '$(SCENE)' --seconds '$(SECONDS)'

test:
	@scripts/setup.sh test
	@$(env) && python -m pytest -m 'not slow' $(SPREAD) $(ARGS)

test-slow:
	@scripts/setup.sh test
	@$(env) && python -m pytest -m slow --hypothesis-profile=long $(SPREAD) $(ARGS)

test-all:
	@scripts/setup.sh test
	@$(env) && python -m pytest --hypothesis-profile=long $(SPREAD) $(ARGS)

coverage:
	@scripts/setup.sh test
	@$(env) && export COVERAGE_FILE=$(CURDIR)/.coverage && coverage erase && \
	  { coverage run -m pytest -m 'not slow' $(SPREAD) $(ARGS); status=$$?; coverage combine -q; \
	    coverage report --sort=cover; exit $$status; }

lint:
	@scripts/lint.sh

check-pip:
	@python3 scripts/check_pip.py $(ARGS)

release:
	@QUICK='$(QUICK)' scripts/release.sh

# Of the caller's shell only what reaches the package registry is kept.
check-clean check-oldest:
	@work=$$(mktemp -d) && trap "rm -rf $$work" EXIT && git clone -q . $$work/fresh && cd $$work/fresh && \
	  { [ $@ = check-clean ] || sed -i -E 's/^(numpy==).*/\11.26.4/; s/^(scipy==).*/\11.11.4/' scripts/constraints.txt; } && \
	  env -i HOME=$$work PATH="$$PATH" LANG=C.UTF-8 PYTHON='$(PYTHON)' ARGS='$(ARGS)' \
	    $$(env | grep -E '^(HTTPS?_PROXY|https?_proxy|NO_PROXY|no_proxy|PIP_[A-Z_]+|SSL_CERT_FILE)=') make run test

check-loaded:
	@trap 'kill $$(jobs -p)' EXIT; for i in 1 2 3 4 5 6; do while :; do :; done & done; \
	  for i in 1 2 3; do $(MAKE) test || exit; done

soak:
	@scripts/setup.sh test
	@$(env) && SOAK_MINUTES=$(MINUTES) python -m pytest test/ros/test_soak.py test/ros/test_hostile_parameters.py -x -s $(ARGS)

bench:
	@scripts/setup.sh test
	@$(env) && python -m bench $(ARGS)

docs:
	@scripts/setup.sh
	@[ -x .venv-docs/bin/mkdocs ] || { .venv/bin/python -m venv .venv-docs && .venv/bin/python scripts/requirements.py docs | xargs .venv-docs/bin/pip -q install -c scripts/constraints.txt; }
	@site=$$(.venv/bin/python -c 'import sysconfig; print(sysconfig.get_path("purelib"))') && \
	  PYTHONPATH=$(CURDIR):$$site NO_MKDOCS_2_WARNING=1 .venv-docs/bin/mkdocs build -q --strict -f docs/site/mkdocs.yml
	@echo 'built: build/site/index.html'

clean:
	rm -rf .venv-docs .venv/setup install/*/.built .venv .venv-lint .venv-peers build install log
