#!/usr/bin/env bash
# Runs the linters (extra `lint` of setup.py) over the tree, all of them, and fails if one complains.
# Needs no ROS: they live in .venv-lint, which is made on first use and when the list changes.
#
#   PYTHON=python3.12 scripts/lint.sh
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
venv=.venv-lint python=${PYTHON:-python3}
wanted=$("$python" scripts/requirements.py lint; cat scripts/constraints.txt)
if [ "$wanted" != "$(cat $venv/installed 2>/dev/null)" ]; then
  rm -rf "$venv"
  "$python" -m venv "$venv"
  "$python" scripts/requirements.py lint >"$venv/wanted"
  "$venv/bin/pip" -q --disable-pip-version-check install -r "$venv/wanted" -c scripts/constraints.txt
  echo "$wanted" >"$venv/installed"
fi
failed=()
run() {
  echo "lint: $1"
  "$venv/bin/$@" || failed+=("$1")
}
sources=(fourbar_ros fourbar_lab test bench docs launch setup.py)
quietly() {             # ament's wrappers list every file they check: show the findings alone
  echo "lint: $1"
  local out
  out=$("$venv/bin/$@" 2>&1) || { grep -v -e '^checking ' -e '^\* ' <<<"$out"; failed+=("$1"); }
}
run ruff check --quiet .
run mypy
run lint-imports --no-cache --no-logo
quietly ament_flake8 --config scripts/ament_flake8.ini "${sources[@]}"
# D402: a formula is no signature. D413, D417: sections list the arguments that need words.
quietly ament_pep257 --add-ignore D402 D413 D417 -- fourbar_ros fourbar_lab bench docs launch setup.py
[ ${#failed[@]} = 0 ] || { echo "lint: ${failed[*]} complained" >&2; exit 1; }
echo 'lint: nothing to complain about'
