#!/usr/bin/env bash
# Makes what is published: dist/ with sdist and wheel, which `twine check` takes and which, installed into bare
# environments, alone and with all extras, run every command (scripts/check_pip.py); and, for ROS tools, CHANGELOG.rst.
# On a commit with a tag, as the workflow that publishes, the tag must be the version and the changelog dated.
#
#   make release
#   git add -f CHANGELOG.rst && git commit -m "Release 2.0.0" && git tag 2.0.0 && git push origin main 2.0.0
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
fail() { echo "release: $*" >&2; exit 1; }

version=$(sed -n "s/^__version__ = '\(.*\)'$/\1/p" fourbar_ros/__init__.py)
tag=$(git describe --exact-match --tags HEAD 2>/dev/null || true)
dated=$(grep -cE "^## ${version//./\\.} \([0-9]{4}-[0-9]{2}-[0-9]{2}\)" CHANGELOG.md || true)
for file in package.xml msg_defs/package.xml scripts/tf2_msgs/package.xml; do
  grep -q "<version>$version</version>" "$file" || fail "$file has not the version $version"
done
if [ -n "$tag" ]; then
  [ "$tag" = "$version" ] || fail "the tag is $tag, the version $version"
  [ "$dated" = 1 ] || fail "CHANGELOG.md has no section $version with a date"
fi

rm -rf dist
environments=(--only "" all)
[ -z "${QUICK:-}" ] || environments=(--quick)
"${PYTHON:-python3}" scripts/check_pip.py --dist "$PWD/dist" "${environments[@]}"
"${PYTHON:-python3}" scripts/changelog.py >CHANGELOG.rst
echo "release: $(cd dist && echo *) and CHANGELOG.rst are good"
[ "$dated" = 1 ] || echo "release: before the tag, give *Unreleased* in CHANGELOG.md the number $version and a date"
