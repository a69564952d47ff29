#!/usr/bin/env bash
# Tests a fresh clone of the last commit in a bare environment: make run, then make test.
#
#   PYTHON=python3.12 scripts/check_clean.sh           with the packages that requirements/ pins
#   PYTHON=python3.12 scripts/check_clean.sh oldest    with numpy 1.26.4 and scipy 1.11.4 (Ubuntu 24.04)
#
# Needs the package registry, about 2 GB in TMPDIR, and some ten minutes. ARGS goes to pytest.
set -euo pipefail
source=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd -P)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
git clone -q "$source" "$work/fresh"
cd "$work/fresh"
if [ "${1:-}" = oldest ]; then
  sed -i -E 's/^numpy==[0-9.]+/numpy==1.26.4/' requirements/ros.txt
  sed -i -E 's/^scipy==[0-9.]+/scipy==1.11.4/' requirements/test.txt
  grep -q '^numpy==1.26.4' requirements/ros.txt && grep -q '^scipy==1.11.4' requirements/test.txt
elif [ "$#" != 0 ]; then
  echo "usage: check_clean.sh [oldest]" >&2
  exit 2
fi
# Nothing of the caller's shell, but what reaches the package registry.
keep=(HOME="$work/home" PATH="$PATH" LANG=C.UTF-8 TMPDIR="$work" PYTHON="${PYTHON:-}" ARGS="${ARGS:-}")
for name in HTTP_PROXY HTTPS_PROXY http_proxy https_proxy NO_PROXY no_proxy PIP_INDEX_URL \
  PIP_EXTRA_INDEX_URL PIP_CERT PIP_CONFIG_FILE PIP_FIND_LINKS SSL_CERT_FILE REQUESTS_CA_BUNDLE; do
  if [ -n "${!name:-}" ]; then keep+=("$name=${!name}"); fi
done
mkdir "$work/home"
if [ -e "$HOME/.config/pip/pip.conf" ]; then
  mkdir -p "$work/home/.config/pip"
  cp "$HOME/.config/pip/pip.conf" "$work/home/.config/pip/"
fi
env -i "${keep[@]}" make run
env -i "${keep[@]}" make test
env -i "${keep[@]}" bash -c '. scripts/env.sh
python -c "import platform, numpy, scipy
print(\"Python\", platform.python_version(), \"numpy\", numpy.__version__, \"scipy\", scipy.__version__, \": good\")"'
