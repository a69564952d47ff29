#!/usr/bin/env bash
# Runs the tests that need no ROS on arm64: a Debian for it in a folder, emulated by qemu, with the numpy and scipy
# that PyPI has for it. Takes root, debootstrap, qemu-user-static and an hour; a later call uses the folder again.
# The kernel of this machine knows the emulator afterwards, until it starts again (binfmt_misc).
#
#   scripts/check_arm64.sh FOLDER [TESTS AND ARGUMENTS OF PYTEST]
set -euo pipefail
source=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd -P)
fail() { echo "check-arm64: $*" >&2; exit 1; }
step() { echo "check-arm64: $*"; }
[ $# -ge 1 ] || fail 'name a folder for the system, of 2 GB'
root=${1%/}
shift
[ "$(id -u)" = 0 ] || fail 'needs root, for chroot'
command -v debootstrap >/dev/null || fail 'needs debootstrap: sudo apt install debootstrap'
if [ "$(uname -m)" != aarch64 ]; then
  command -v qemu-aarch64-static >/dev/null || fail 'needs an emulator: sudo apt install qemu-user-static'
  kernel=/proc/sys/fs/binfmt_misc            # which knows the emulator where systemd runs
  [ -e $kernel/register ] || mount -t binfmt_misc none $kernel
  [ -e $kernel/qemu-aarch64 ] || cat /usr/lib/binfmt.d/qemu-aarch64.conf >$kernel/register
fi

if [ ! -e "$root/ready" ]; then
  step "making a system in $root"
  debootstrap --arch=arm64 --variant=minbase --include=python3-venv,ca-certificates bookworm "$root" >"$root.log" ||
    { tail -5 "$root.log" >&2; fail 'debootstrap failed'; }
  touch "$root/ready"
fi
certificates=etc/ssl/certs/ca-certificates.crt        # those that this machine trusts
if [ -e /$certificates ]; then cp /$certificates "$root/$certificates"; fi
mounted() { mountpoint -q "$root/$2" || mount -t "$1" none "$root/$2"; }
unmount() { for at in dev/pts sys proc; do if mountpoint -q "$root/$at"; then umount "$root/$at"; fi; done; }
trap unmount EXIT
mounted proc proc
mounted sysfs sys
mounted devpts dev/pts

step 'installing'
rm -rf "$root/source"
mkdir "$root/source"
tar -C "$source" --exclude='./.venv*' --exclude=./.git --exclude=./build --exclude=./install --exclude=./log \
  --exclude=./bags --exclude='*.egg-info' --exclude=__pycache__ -cf - . | tar -C "$root/source" -xf -
in_it() { chroot "$root" /usr/bin/env -i PATH=/venv/bin:/usr/bin:/bin HOME=/root LANG=C.UTF-8 PIP_CERT=/$certificates "$@"; }
[ -e "$root/venv" ] || in_it python3 -m venv /venv
in_it pip -q install --upgrade --upgrade-strategy eager '/source[test,live]' pytest-xdist

step "testing on $(in_it python -c 'import numpy, platform, scipy; print(platform.machine(), "with Python",
  platform.python_version(), "numpy", numpy.__version__, "scipy", scipy.__version__)')"
in_it sh -c 'cd /source && python -m pytest -m "not slow" -n 2 --dist loadfile --ignore=test/ros --ignore=test/live \
  --ignore=test/docs "$@"' check "$@"
step good
