#!/usr/bin/env bash
# What `make run` was asked for, checked before minutes of set-up: check_run.sh SCENE SECONDS
set -eu
cd "$(dirname "${BASH_SOURCE[0]}")/.."
scene=$1 seconds=$2
if [ ! -f "$scene" ] && [ ! -f "config/$scene.yaml" ]; then
  echo "SCENE=$scene: no such file, and no scene of this name; known:" config/*.yaml >&2
  exit 1
fi
if ! [[ $seconds =~ ^([0-9]+\.?[0-9]*|\.[0-9]+)$ ]] || [[ $seconds =~ ^[0.]*$ ]]; then
  echo "SECONDS=$seconds: must be a positive number" >&2
  exit 1
fi
# A scene that cannot be is said now too, where the environment is there already.
if [ -x .venv/bin/python ] && [ -e .venv/setup/ros ] && .venv/bin/python -c 'import numpy, rich, yaml' 2>/dev/null; then
  .venv/bin/python -c 'import sys
from fourbar_ros import FourBarError, load_scene
try:
    load_scene(sys.argv[1])
except FourBarError as error:
    sys.exit(f"SCENE: {error}")' "$scene"
fi
