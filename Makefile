# Thin: scripts/setup.sh makes and keeps everything, scripts/env.sh puts it on the path.
SHELL := /bin/bash
SCENE ?= config/paper.yaml
SECONDS ?= 5
MINUTES ?= 60
ARGS ?=
export PYTHON

env := . scripts/env.sh

.DEFAULT_GOAL := help
.PHONY: help setup run test test-all check-pip soak bench clean

help:
	@echo 'fourbar_ros: exact motion, loads and extrema of four-bars, slider-cranks, inverted slider-cranks;'
	@echo 'a ROS 2 node and a Python library'
	@echo
	@echo '  make run        a linkage through the node: live table, extrema, bag, bag checked'
	@echo '                    SCENE=$(SCENE)  SECONDS=$(SECONDS)'
	@echo '  make test       the tests but the slow ones      ARGS="-k loads" goes to pytest'
	@echo '  make test-all   all tests'
	@echo '  make check-pip  the library without ROS: sdist, wheel, fresh venv, every command'
	@echo '  make soak       an hour of floods, garbage, restarts    MINUTES=60'
	@echo '  make bench      what a step, a search for extrema, a message costs here   ARGS=...'
	@echo '  make setup      only what the others do first: .venv, ROS 2, build'
	@echo '  make clean      removes .venv build install log'
	@echo
	@echo 'Each sets up what is missing, the first time some minutes, later only what changed.'
	@echo 'PYTHON=python3.12 chooses the interpreter (3.10 to 3.13).'
	@echo 'A sourced ROS 2 is used; without one ROS 2 Jazzy comes from PyPI into .venv.'
	@echo 'For your own shell:  . scripts/env.sh   then  fourbar --help,  fourbar_node,  python'

setup:
	@scripts/setup.sh
	@echo 'ready:  . scripts/env.sh'

run:
	@scripts/check_run.sh '$(SCENE)' '$(SECONDS)'
	@scripts/setup.sh
	@$(env) && fourbar_demo '$(SCENE)' --seconds '$(SECONDS)'

test:
	@scripts/setup.sh test
	@$(env) && python -m pytest -m 'not slow' $(ARGS)

test-all:
	@scripts/setup.sh test
	@$(env) && python -m pytest $(ARGS)

check-pip:
	@scripts/check_pip.sh

soak:
	@scripts/setup.sh test
	@$(env) && SOAK_MINUTES=$(MINUTES) python -m pytest test/ros/test_soak.py -x -s $(ARGS)

bench:
	@scripts/setup.sh test
	@$(env) && python -m bench $(ARGS)

clean:
	rm -rf .venv/setup install/*/.built .venv .venv-peers build install log
