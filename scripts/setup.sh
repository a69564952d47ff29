#!/usr/bin/env bash
# Makes .venv, installs what is needed and builds fourbar_msgs and fourbar_ros into install/, and
# tf2_msgs where ROS 2 comes as wheels, which lack it.
# A later call redoes only what changed; one that was interrupted is repaired by the next.
#
#   scripts/setup.sh         enough to run the node
#   scripts/setup.sh test    and what tests, benchmarks and plots need
#
# PYTHON=python3.12 chooses the interpreter. Where a ROS 2 is sourced it is used; otherwise ROS 2
# Jazzy comes as wheels into .venv. What each step printed is in log/setup/.
set -Eeuo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
root=$(pwd -P)
venv=$root/.venv
py=$venv/bin/python
stamps=$venv/setup          # what is done, each file holding what it was done with
logs=$root/log/setup

die() { printf 'set-up: %s\n' "$@" >&2; exit 1; }
trap 'echo; die "interrupted; the next call repairs what is half done"' INT TERM
trap 'die "line $LINENO of scripts/setup.sh failed unexpectedly"' ERR

if (LC_ALL=C; [[ $root == *[!A-Za-z0-9._/+-]* ]]); then
  die "this folder's path, $root, holds a space or another character that colcon, CMake and ROS's" \
    'generators cannot take; letters a to z, digits and . _ + - are safe.  Move the folder.'
fi

# ---- one thing at a time, on the screen and in the folder

if command -v flock >/dev/null; then
  exec 9<scripts/setup.sh
  flock -n 9 || { echo 'another set-up of this folder is running: waiting for it'; flock 9; }
fi

# step TEXT LOG COMMAND...   shows TEXT and the seconds; the command's own output goes to the log
step() {
  local text=$1 log=$logs/$2.log start=$SECONDS
  shift 2
  mkdir -p "$logs"
  printf '%s ... ' "$text"
  if "$@" >"$log" 2>&1 </dev/null; then
    printf '%d s\n' $((SECONDS - start))
  else
    printf 'failed\n'
    return 1
  fi
}

# ---- the environment: the user's ROS, conda, virtual environment or settings must not leak in

drop_from_path() { PATH=":$PATH:"; PATH=${PATH//":$1:"/:}; PATH=${PATH#:}; PATH=${PATH%:}; }

drop_from_path "$venv/bin"
if [ -n "${CONDA_PREFIX:-}" ]; then
  drop_from_path "$CONDA_PREFIX/bin"
  unset CC CXX CPPFLAGS CFLAGS CXXFLAGS LDFLAGS         # conda's compilers set them to its own
fi
unset VIRTUAL_ENV PYTHONHOME PYTHONSTARTUP PYTHONOPTIMIZE "${!COLCON_@}" \
  PIP_TARGET PIP_PREFIX PIP_ROOT PIP_REQUIRE_VIRTUALENV \
  MAKEFLAGS MFLAGS MAKELEVEL CMAKE_GENERATOR DESTDIR
export PIP_USER=0                       # against a pip.conf that says otherwise
export COLCON_HOME=$logs/colcon         # not ~/.colcon: its defaults.yaml may change the layout

ros=wheels
if [ -n "${ROS_DISTRO:-}" ] && [[ ":${AMENT_PREFIX_PATH:-$venv}:" != *":$venv:"* ]]; then
  for python in "${PYTHON:-python3}" /usr/bin/python3; do
    if rclpy=$("$python" -c 'import rclpy; print(rclpy.__file__)' 2>/dev/null); then
      ros="$ROS_DISTRO $rclpy"
      break
    fi
  done
  if [ "$ros" = wheels ]; then
    echo "ROS 2 '$ROS_DISTRO' is sourced but ${PYTHON:-python3} cannot import rclpy: using wheels instead"
  elif [ "$ROS_DISTRO" != jazzy ]; then
    echo "note: ROS 2 '$ROS_DISTRO' is sourced; this project is made for and tested with jazzy"
  fi
fi
if [ "$ros" = wheels ]; then
  unset PYTHONPATH LD_LIBRARY_PATH AMENT_PREFIX_PATH CMAKE_PREFIX_PATH _ROS_WHEELS_BOOTSTRAP_COMPLETE
fi

# ---- the Python

version() { "$1" -c 'import platform; print(platform.python_version())' 2>/dev/null; }

# Says why ROS's wheels do not fit this interpreter; nothing when they do.
misfit() {
  "$1" - <<'PY'
import platform
import sys
if not (3, 10) <= sys.version_info < (3, 14) or sys.implementation.name != 'cpython':
    print('ROS 2 Jazzy has wheels for CPython 3.10 to 3.13, and this is %s %s'
          % (platform.python_implementation(), platform.python_version()))
elif sys.platform != 'linux' or platform.machine() != 'x86_64' or sys.maxsize < 2**32:
    print('ROS 2 Jazzy has wheels for Linux on x86_64 only, and this is %s on %s'
          % (platform.system(), platform.machine()))
elif platform.libc_ver()[0] != 'glibc' or [int(n) for n in platform.libc_ver()[1].split('.')[:2]] < [2, 28]:
    print('ROS 2 Jazzy has wheels for glibc 2.28 or newer, and this is %s %s' % platform.libc_ver())
PY
}

if [ "$ros" != wheels ]; then
  :                                                     # the one that imports rclpy
elif [ -n "${PYTHON:-}" ]; then
  python=$PYTHON
  version "$python" >/dev/null || die "PYTHON=$python is not a Python that runs."
elif version "$py" >/dev/null; then
  python=$py                                            # the one chosen before
else
  python=
  for candidate in python3 python3.12 python3.11 python3.13 python3.10 /usr/bin/python3; do
    if version "$candidate" >/dev/null; then
      python=${python:-$candidate}
      if [ -z "$(misfit "$candidate")" ]; then python=$candidate; break; fi
    fi
  done
  [ -n "$python" ] || die 'no Python found.  sudo apt install python3 python3-venv python3-dev'
fi
# The interpreter behind a virtual environment, which may be the active one or this tree's own.
base=$("$python" -c 'import sys; print(getattr(sys, "_base_executable", None) or sys.executable)')
about=$("$base" -c 'import sys; print("Python %d.%d at" % sys.version_info[:2], sys.base_prefix)')
identity=$(printf '%s\n' "$root" "$ros" "$about")

# ---- what must be there before anything is made

check_tools() {
  local reason xy missing=()
  if [ "$ros" = wheels ]; then
    reason=$(misfit "$base")
    [ -z "$reason" ] || die "$reason ($base)." \
      'Name another with  make PYTHON=python3.12 ...  or source a ROS 2 of your own first.'
  fi
  xy=$("$base" -c 'import sys; print("%d.%d" % sys.version_info[:2])')
  "$base" -c 'import venv, ensurepip' 2>/dev/null || missing+=("python$xy-venv")
  [ -e "$("$base" -c 'import sysconfig; print(sysconfig.get_path("include"))')/Python.h" ] ||
    missing+=("python$xy-dev")
  have "${CC:-cc}" || missing+=(gcc)
  have "${CXX:-c++}" || missing+=(g++)
  have make || missing+=(make)
  if [ "${#missing[@]}" -gt 0 ]; then
    die "missing for $about: ${missing[*]}.  sudo apt install ${missing[*]}"
  fi
  if [ "$ros" != wheels ] && ! "$base" -c 'import colcon_core' 2>/dev/null; then
    die 'ROS 2 is sourced but colcon is missing.  sudo apt install python3-colcon-common-extensions'
  fi
}

have() { command -v "${1%% *}" >/dev/null; }           # the first word: CC may be 'ccache gcc'

# ---- .venv

# make_venv WHY
make_venv() {
  check_tools
  if [ -n "$1" ]; then echo "$1: making it anew"; fi
  rm -rf "$stamps"                      # first, so that an interrupted removal leaves no claims
  rm -rf .venv build install
  local args=()
  if [ "$ros" != wheels ]; then args=(--system-site-packages); fi
  step "$about into .venv" venv "$base" -m venv "${args[@]}" .venv ||
    die "python -m venv failed: see log/setup/venv.log"
  mkdir "$stamps"
  if [ "$ros" = wheels ]; then echo wheels; else echo sourced; fi >"$stamps/ros"
  echo "$identity" >"$stamps/identity"
}

if [ ! -e .venv ]; then
  make_venv ''
elif [ ! -e "$stamps/identity" ] || [ -e "$stamps/unfinished" ]; then
  make_venv '.venv was left half done'
elif [ "$(cat "$stamps/identity")" != "$identity" ] || ! version "$py" >/dev/null; then
  make_venv '.venv is of another folder, Python or ROS'
fi

# ---- what goes into it

hash_of() { { echo "$identity"; for file; do echo "$file"; cat "$file"; done; } | sha256sum | cut -d' ' -f1; }
done_with() { [ "$(cat "$1" 2>/dev/null)" = "$2" ]; }

why_pip_failed() {
  local log=$logs/$1.log
  if grep -qiE 'CERTIFICATE_VERIFY_FAILED|TLS CA certificate' "$log"; then
    echo "the package registry's certificate is not trusted here: set PIP_CERT to your CA file."
  elif grep -qE 'NewConnectionError|Connection refused|ConnectTimeout|Name or service|name resolution|Network is unreachable|ProxyError|ReadTimeout|RemoteDisconnected|Connection aborted|Max retries' "$log"; then
    echo 'the package registry cannot be reached: check the network, or set PIP_INDEX_URL or HTTPS_PROXY.'
  elif grep -q 'No space left on device' "$log"; then
    echo 'the disk is full: the set-up needs about 1 GB.'
  else
    echo "pip failed. $(grep -m1 '^ERROR: No matching' "$log" || grep -m1 '^ERROR' "$log" || true)"
  fi
}

# The wheels' CMake files name the include folders of the machine that built them, and CMake refuses
# folders that do not exist. The build finds Python's and numpy's own, so drop them.
drop_baked_paths() {
  find "$venv"/share/*/cmake -name '*.cmake' -exec grep -qF /opt/python/cp3 {} \; \
    -exec sed -i -E 's#/opt/python/cp3[^;"]*;?##g' {} +
}

# install NAME TEXT FILE...   pip-installs the requirement files unless they were, as they are now
install() {
  local name=$1 text=$2 hash
  shift 2
  hash=$(hash_of "$@")
  if done_with "$stamps/$name" "$hash"; then return 0; fi
  local args=() file
  for file; do args+=(-r "$file"); done
  if [ "$ros" != wheels ]; then
    "$py" -c 'import numpy; print("numpy==" + numpy.__version__)' >"$stamps/keep.txt"
    args+=(-c "$stamps/keep.txt")
  fi
  touch "$stamps/unfinished"
  if ! step "$text" "$name" "$py" -m pip --disable-pip-version-check install "${args[@]}"; then
    # pip changes nothing before it has everything, so a failed download leaves .venv as it was.
    grep -q 'Installing collected packages' "$logs/$name.log" || rm "$stamps/unfinished"
    die "$(why_pip_failed "$name")" "All of pip's output: log/setup/$name.log"
  fi
  if [ "$ros" = wheels ]; then drop_baked_paths; fi
  rm "$stamps/unfinished"
  echo "$hash" >"$stamps/$name"
}

run_files=(requirements/python.txt)
text='Python packages'
if [ "$ros" = wheels ]; then
  run_files=(requirements/ros.txt requirements/python.txt)
  text='ROS 2 Jazzy and Python packages (over 100 MB)'
fi
if [ "${1:-}" = test ]; then
  install pip-test "$text, test packages into .venv" "${run_files[@]}" requirements/test.txt
  hash_of "${run_files[@]}" >"$stamps/pip"
else
  install pip "$text into .venv" "${run_files[@]}"
fi

# ---- the packages

# fourbar_ros is installed as links into this tree, so an edited .py or .yaml needs no build; what
# does is a change of its metadata or of the list of files it shares. (A plain `colcon build` turns
# the links into copies: setup.py in build/ is then no link any more.)
build_files=("${run_files[0]}" scripts/only_python.cmake)
msgs_hash=$(find msg_defs -type f -print0 | sort -z | xargs -0 sha256sum | cat - "${build_files[@]}" | hash_of -)
tf2_hash=$(find scripts/tf2_msgs -type f -print0 | sort -z | xargs -0 sha256sum | cat - "${build_files[@]}" | hash_of -)
package_hash=$({ find config launch -type f 2>/dev/null || true; } | sort | cat - setup.py setup.cfg package.xml | hash_of -)

stale=()
if [ "$ros" = wheels ] &&
  { ! done_with install/tf2_msgs/.built "$tf2_hash" || [ ! -d build/tf2_msgs ]; }; then
  stale+=(tf2_msgs)
fi
if ! done_with install/fourbar_msgs/.built "$msgs_hash" || [ ! -d build/fourbar_msgs ]; then
  stale+=(fourbar_msgs)
fi
if ! done_with install/fourbar_ros/.built "$package_hash" || [ ! -L build/fourbar_ros/setup.py ]; then
  stale+=(fourbar_ros)
fi

if [ "${#stale[@]}" -gt 0 ]; then
  check_tools
  for package in "${stale[@]}"; do
    rm -f "install/$package/.built"
    rm -rf "build/$package" "install/$package"
  done
  # A copy: scripts/tf2_msgs is hidden from colcon, so that it never stands before a real tf2_msgs.
  rm -rf build/sources
  mkdir -p build/sources
  cp -r scripts/tf2_msgs build/sources/tf2_msgs
  rm build/sources/tf2_msgs/COLCON_IGNORE
  only=()
  if [ "$ros" = wheels ]; then
    export AMENT_PREFIX_PATH=$venv CMAKE_PREFIX_PATH=$venv
    only=("-DCMAKE_PROJECT_INCLUDE=$root/scripts/only_python.cmake")
  fi
  # VIRTUAL_ENV and PATH as when activated, for what CMake runs.
  # BUILD_TESTING is off because the message package has no tests and its linters are no wheels.
  VIRTUAL_ENV=$venv PATH=$venv/bin:$PATH step "building ${stale[*]}" build \
    "$py" -c 'import sys; from colcon_core.command import main; sys.exit(main())' \
    --log-base log build --base-paths . msg_defs build/sources/tf2_msgs --packages-select "${stale[@]}" \
    --symlink-install --event-handlers console_direct+ \
    --cmake-args -DCMAKE_BUILD_TYPE=Release -DBUILD_TESTING=OFF "-DPython3_EXECUTABLE=$py" "${only[@]}" ||
    die "the build failed; its first error:" "$(grep -m1 -iE '(^|[^a-z])error( |:)' "$logs/build.log" || echo unknown)" \
      'All of its output: log/setup/build.log'
  for package in "${stale[@]}"; do
    case $package in
      tf2_msgs) echo "$tf2_hash" ;;
      fourbar_msgs) echo "$msgs_hash" ;;
      fourbar_ros) echo "$package_hash" ;;
    esac >"install/$package/.built"
  done
fi
