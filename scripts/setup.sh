#!/usr/bin/env bash
# Makes .venv, installs what is needed, and builds fourbar_msgs and fourbar_ros into install/ (and tf2_msgs, which
# ROS's wheels lack). A later call redoes only what changed; after one that was interrupted it starts again.
#
#   scripts/setup.sh         enough to run the node
#   scripts/setup.sh test    and what tests, benchmarks and plots need
#
# PYTHON=python3.12 chooses the interpreter. Where a ROS 2 is sourced it is used; otherwise ROS 2 Jazzy comes as
# wheels into .venv. What each step printed is in log/setup/.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
root=$(pwd -P) py=$(pwd -P)/.venv/bin/python stamps=.venv/setup

die() { printf 'set-up: %s\n' "$@" >&2; exit 1; }

(LC_ALL=C; [[ $root =~ ^[A-Za-z0-9._/+-]+$ ]]) ||
  die "this folder's path, $root, holds a character that colcon, CMake or ROS's generators cannot take;" \
    'letters a to z, digits and . _ + - are safe.  Move the folder.'
exec 9<scripts/setup.sh
flock -n 9 || { echo 'another set-up of this folder is running: waiting for it'; flock 9; }

# step TEXT LOG COMMAND...   shows TEXT and the seconds; the command's own output goes to the log
step() {
  local text=$1 log=log/setup/$2.log start=$SECONDS
  shift 2
  mkdir -p log/setup
  printf '%s ... ' "$text"
  if "$@" >"$log" 2>&1 </dev/null; then printf '%d s\n' $((SECONDS - start)); return; fi
  printf 'failed\n'
  die "$(grep -m1 -iE '(^|[^a-z])error( |:)' "$log" || tail -n 1 "$log")" "All of its output: $log"
}

# ---- the environment: the user's conda, virtual environment and settings must not leak in

if [ -n "${CONDA_PREFIX:-}" ]; then unset CC CXX CPPFLAGS CFLAGS CXXFLAGS LDFLAGS; fi      # conda's own compilers
unset VIRTUAL_ENV PYTHONHOME PYTHONSTARTUP PYTHONOPTIMIZE "${!COLCON_@}" \
  PIP_TARGET PIP_PREFIX PIP_ROOT PIP_REQUIRE_VIRTUALENV MAKEFLAGS MFLAGS MAKELEVEL CMAKE_GENERATOR DESTDIR
export PIP_USER=0 COLCON_HOME=$root/log/setup/colcon PIP_DISABLE_PIP_VERSION_CHECK=1

ros=wheels python=${PYTHON:-python3}
if [ -n "${ROS_DISTRO:-}" ] && [[ ":${AMENT_PREFIX_PATH:-}:" != *":$root/.venv:"* ]]; then
  if rclpy=$("$python" -c 'import rclpy; print(rclpy.__file__)' 2>/dev/null); then
    ros="$ROS_DISTRO $rclpy"
  else
    echo "ROS 2 '$ROS_DISTRO' is sourced but $python cannot import rclpy: using wheels instead"
  fi
fi
if [ "$ros" = wheels ]; then
  unset PYTHONPATH LD_LIBRARY_PATH AMENT_PREFIX_PATH CMAKE_PREFIX_PATH _ROS_WHEELS_BOOTSTRAP_COMPLETE
  fits='import sys; sys.exit(not ((3, 11) <= sys.version_info < (3, 14) and sys.platform == "linux"))'
  # without PYTHON the one chosen before, or the first that the wheels fit
  for candidate in ${PYTHON:-"$py" python3 python3.12 python3.11 python3.13 /usr/bin/python3}; do
    if "$candidate" -c "$fits" 2>/dev/null; then python=$candidate; break; fi
  done
fi
base=$("$python" -c 'import sys; print(getattr(sys, "_base_executable", None) or sys.executable)' 2>/dev/null) ||
  die "$python is not a Python that runs."
about=$("$base" -c 'import sys; print("Python %d.%d at" % sys.version_info[:2], sys.base_prefix)')

# ---- .venv

identity=$(printf '%s\n' "$root" "$ros" "$about")
if [ "$(cat $stamps/identity 2>/dev/null)" != "$identity" ] || [ -e $stamps/unfinished ]; then
  if [ -e .venv ]; then echo '.venv is half done, or of another folder, Python or ROS: making it anew'; fi
  if [ "$ros" = wheels ] && { ! "$base" -c "$fits" || [ "$(uname -m)" != x86_64 ]; }; then
    die "ROS 2 Jazzy has wheels for CPython 3.11 to 3.13 on Linux x86_64, and this is $about on $(uname -sm)." \
      'Name another with  make PYTHON=python3.12 ...  or source a ROS 2 of your own first.'
  fi
  include=$("$base" -c 'import venv, ensurepip, sysconfig; print(sysconfig.get_path("include"))' 2>/dev/null || true)
  [ -e "$include/Python.h" ] || die "$about lacks venv or its headers.  sudo apt install python3-venv python3-dev"
  for tool in "${CC:-cc}" "${CXX:-c++}" make; do
    command -v "${tool%% *}" >/dev/null || die "$tool is missing.  sudo apt install gcc g++ make"
  done
  rm -rf .venv build install
  step "$about into .venv" venv "$base" -m venv $([ "$ros" = wheels ] || echo --system-site-packages) .venv
  mkdir $stamps
  touch $stamps/unfinished
  [ "$ros" = wheels ] && echo wheels >$stamps/ros || echo sourced >$stamps/ros
  echo "$identity" >$stamps/identity
fi

# ---- what goes into it: of setup.py, in the versions of constraints.txt

extras=(run dynamics bag plot) constraints=scripts/constraints.txt text=packages
if [ "$ros" = wheels ]; then
  extras+=(ros) text='ROS 2 Jazzy and packages (over 100 MB)'
else            # its messages are compiled against its numpy
  sed "s/^numpy==.*/numpy==$("$py" -c 'import numpy; print(numpy.__version__)')/; /^scipy==/d" $constraints \
    >$stamps/constraints.txt
  constraints=$stamps/constraints.txt
fi
if [ "${1:-}" = test ]; then extras+=(test); fi
"$py" scripts/requirements.py "${extras[@]}" >$stamps/wanted
if ! [ -e $stamps/installed ] || cat $stamps/wanted $constraints | grep -qvxFf $stamps/installed; then
  touch $stamps/unfinished
  step "$text into .venv" pip "$py" -m pip install -r $stamps/wanted -c $constraints
  if [ "$ros" = wheels ]; then      # CMake refuses the folders of the machine that built them
    find .venv/share/*/cmake -name '*.cmake' -exec sed -i -E 's#/opt/python/cp3[^;"]*;?##g' {} +
  fi
  cat $stamps/wanted $constraints >$stamps/installed
  rm $stamps/unfinished
fi

# ---- the packages: fourbar_ros as links into this tree, so that an edited .py or .yaml needs no build

hash_of() { sha256sum "$@" | cat - $stamps/identity | sha256sum; }
declare -A built=([fourbar_msgs]=$(hash_of scripts/only_python.cmake $(find msg_defs -type f | sort))
  [fourbar_ros]=$(find config launch -type f | sort | hash_of - setup.py setup.cfg package.xml))
if [ "$ros" = wheels ]; then built[tf2_msgs]=$(hash_of $(find scripts/tf2_msgs -type f | sort)); fi
stale=()
for package in "${!built[@]}"; do
  [ "$(cat "install/$package/.built" 2>/dev/null)" = "${built[$package]}" ] || stale+=("$package")
done
if [ "${#stale[@]}" -gt 0 ]; then
  rm -rf build/sources "${stale[@]/#/build/}" "${stale[@]/#/install/}"
  mkdir -p build/sources
  cp -r scripts/tf2_msgs build/sources/tf2_msgs       # a copy, so that it never stands before a real tf2_msgs
  rm build/sources/tf2_msgs/COLCON_IGNORE
  only=()
  if [ "$ros" = wheels ]; then
    export AMENT_PREFIX_PATH=$root/.venv CMAKE_PREFIX_PATH=$root/.venv
    only=("-DCMAKE_PROJECT_INCLUDE=$root/scripts/only_python.cmake")
  fi
  VIRTUAL_ENV=$root/.venv PATH=$root/.venv/bin:$PATH step "building ${stale[*]}" build \
    "$py" -c 'import sys; from colcon_core.command import main; sys.exit(main())' \
    --log-base log build --base-paths . msg_defs build/sources/tf2_msgs --packages-select "${stale[@]}" \
    --symlink-install --event-handlers console_direct+ \
    --cmake-args -DCMAKE_BUILD_TYPE=Release -DBUILD_TESTING=OFF "-DPython3_EXECUTABLE=$py" "${only[@]}"
  for package in "${stale[@]}"; do echo "${built[$package]}" >"install/$package/.built"; done
fi
