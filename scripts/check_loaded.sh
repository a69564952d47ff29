#!/usr/bin/env bash
# Runs make test several times while busy loops take the processor: no test may depend on how fast
# the machine is. The loops belong to the session of the tests: the kernel shares the processors
# by sessions first (autogroup), so loops of another session would take one share together.
#
#   TIMES=3 LOOPS=6 PYTHON=python3.12 ARGS="test/ros" scripts/check_loaded.sh
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
loops=()
trap 'kill "${loops[@]}"' EXIT
for _ in $(seq "${LOOPS:-6}"); do
  while :; do :; done &
  loops+=($!)
done
for i in $(seq "${TIMES:-3}"); do
  echo "run $i of ${TIMES:-3} under ${#loops[@]} busy loops"
  make test
done
