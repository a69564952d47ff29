#!/usr/bin/env bash
# Proves the way without ROS: builds sdist and wheel from it, installs the wheel into a fresh venv, runs every
# command there, and some tests of the unpacked sdist. Needs the package registry; writes to a temporary folder.
#
#   PYTHON=python3.12 scripts/check_pip.sh          DIST=FOLDER keeps sdist and wheel there, once they are good
#   scripts/check_pip.sh quick                      the wheel alone, and one command
set -euo pipefail
source=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd -P)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
unset PYTHONPATH VIRTUAL_ENV AMENT_PREFIX_PATH
fail() { echo "check-pip: $*" >&2; exit 1; }
step() { echo "check-pip: $*"; }
keep() { if [ -n "${DIST:-}" ]; then mkdir -p "$DIST" && cp "$wheel" "$sdist" "$DIST"; fi; step good; }

step building
mkdir "$work/source"
tar -C "$source" --exclude='./.venv*' --exclude=./.git --exclude=./build --exclude=./install \
  --exclude=./log --exclude=./bags --exclude=./dist --exclude='*.egg-info' --exclude=__pycache__ -cf - . | tar -C "$work/source" -xf -
"${PYTHON:-python3}" -m venv "$work/builder"
"$work/builder/bin/pip" -q install build twine
"$work/builder/bin/python" -m build -q --outdir "$work/dist" "$work/source" >"$work/build.log" 2>&1 ||
  { tail -20 "$work/build.log" >&2; fail 'the build failed'; }
"$work/builder/bin/twine" check --strict "$work"/dist/* >"$work/twine.log" || { cat "$work/twine.log" >&2; fail 'twine check'; }
wheel=$(echo "$work"/dist/*.whl) sdist=$(echo "$work"/dist/*.tar.gz)

step 'installing the wheel alone'
"${PYTHON:-python3}" -m venv "$work/venv"
pip=$work/venv/bin/pip
"$pip" -q install "$wheel"
mkdir "$work/empty"
cd "$work/empty"
export PATH=$work/venv/bin:$PATH

# runs CODE COMMAND...   keeps its output; an error must be one line
runs() {
  local expected=$1 code=0
  shift
  "$@" >out 2>err || code=$?
  [ "$code" = "$expected" ] || { cat out err >&2; fail "$* ended with $code, not $expected"; }
  [ "$expected" = 0 ] || [ "$(wc -l <err)" = 1 ] || { cat err >&2; fail "$*: the error is not one line"; }
}

runs 0 fourbar --version
echo "  $(du -sm --exclude=__pycache__ --exclude='pip*' --exclude='setuptools*' --exclude=pkg_resources \
  "$work"/venv/lib/python*/site-packages | cut -f1) MB"
runs 0 fourbar show paper --at 60
grep -q '856.3641368' out || fail 'show paper: not the shaking force of 60 degrees'
if [ "${1:-}" = quick ]; then keep; exit; fi
for scene in "$work"/source/config/*.yaml; do runs 0 fourbar show "$(basename "$scene" .yaml)"; done
runs 0 fourbar scene check cylinder
runs 0 fourbar reproduce
runs 0 fourbar table engine f41 -o engine.csv
runs 0 fourbar describe paper -o paper.urdf
runs 0 fourbar generate paper -o code
for command in 'fourbar bag info x' 'fourbar simulate motor --until 0.5' 'fourbar record start' 'fourbar replay x' \
  'fourbar draw paper --at 60 -o x.png' 'fourbar study x.yaml -o x' 'fourbar balance paper' 'fourbar live paper' \
  fourbar_node 'fourbar_demo paper'; do
  runs 1 $command
  grep -qE 'requires .*: (pip install|source a ROS 2)' err || { cat err >&2; fail "$command does not say what to install"; }
  echo "  $(cat err)"
done
python - "$work/source/README.md" <<'PY'
import contextlib, io, sys
text = open(sys.argv[1], encoding='utf-8').read()
out = io.StringIO()
with contextlib.redirect_stdout(out):
    exec(text.split('```python\n')[1].split('```')[0])
assert out.getvalue() == text.split('```text\n')[1].split('```')[0], out.getvalue()
from importlib.metadata import metadata
about = metadata('fourbar_ros')
assert about['Summary'] and about.get_all('Classifier') and 'fourbar_ros' in (about.get_payload() or about['Description'])
from importlib.resources import files
assert (files('fourbar_ros') / 'py.typed').is_file()
PY

step 'with bags and motion from torque'
"$pip" -q install "$wheel[bag,dynamics]"
runs 1 fourbar bag info x
grep -q 'no such' err || { cat err >&2; fail 'bag info x'; }
runs 0 fourbar simulate motor --until 0.5

step 'with pictures'
"$pip" -q install "$wheel[plot]"
runs 0 fourbar draw paper --at 60 -o x.png
runs 0 fourbar reproduce --html x.html

step 'with the page'
"$pip" -q install "$wheel[live]"
fourbar live paper --no-browser --port 8437 >out 2>err &
for _ in $(seq 60); do grep -q http out && break; sleep 0.5; done
python -c 'import urllib.request; assert b"fourbar live" in urllib.request.urlopen("http://127.0.0.1:8437").read()' ||
  { cat out err >&2; fail 'no page'; }
kill $!

step 'tests of the unpacked sdist'
tar xzf "$sdist"
"$pip" -q install "$wheel[test]"
cd fourbar_ros-*
# with the newest numpy and scipy, which `make test` does not take
python -m pytest -q test/scene test/cli test/test_fence.py test/docs test/drawing/test_tables.py test/dynamics \
  test/balancing test/numerics -m 'not slow' || fail 'the sdist cannot be tested'
keep
