# To be sourced, in bash or zsh:   . scripts/env.sh
# Afterwards `python`, `fourbar`, `fourbar_node`, `fourbar_demo` are those of this tree, and
# rclpy and fourbar_msgs import. Sourcing twice is harmless.

if [ -n "${ZSH_VERSION:-}" ]; then
  eval '_fourbar_root=${(%):-%x}'       # in eval, because bash cannot parse it
else
  _fourbar_root=${BASH_SOURCE[0]}
fi
_fourbar_root=$(CDPATH='' cd -- "$(dirname -- "$_fourbar_root")/.." && pwd -P)

_fourbar_env() {
  local venv=$_fourbar_root/.venv install=$_fourbar_root/install
  if [ ! -e "$venv/setup/ros" ] || [ ! -e "$install/local_setup.sh" ]; then
    echo "fourbar_ros is not set up yet: make setup" >&2
    return 1
  fi
  if [ "$(cat "$venv/setup/ros")" = wheels ]; then
    # All of ROS is in .venv. Whatever another workspace or ROS left in this shell would be mixed
    # into it, and the loader must not be told it was prepared already for other libraries.
    unset PYTHONPATH PYTHONHOME LD_LIBRARY_PATH COLCON_PREFIX_PATH _ROS_WHEELS_BOOTSTRAP_COMPLETE
    export AMENT_PREFIX_PATH=$venv CMAKE_PREFIX_PATH=$venv
    export RMW_IMPLEMENTATION=rmw_fastrtps_cpp      # the only one there is as a wheel
  elif [ -z "${ROS_DISTRO:-}" ]; then
    echo "fourbar_ros was set up with a sourced ROS 2: source that first, or: make clean setup" >&2
    return 1
  fi

  export VIRTUAL_ENV=$venv
  local bin=$install/fourbar_ros/lib/fourbar_ros:$venv/bin
  case $PATH in
    "$bin:"*) ;;
    *) export PATH=$bin:$PATH ;;
  esac
  export ROS_AUTOMATIC_DISCOVERY_RANGE=${ROS_AUTOMATIC_DISCOVERY_RANGE:-LOCALHOST}

  # colcon's script reads unset variables and is written for sh.
  local nounset=
  case $- in *u*) nounset=yes; set +u ;; esac
  COLCON_CURRENT_PREFIX=$install
  if [ -n "${ZSH_VERSION:-}" ]; then
    emulate sh -c '. "$COLCON_CURRENT_PREFIX/local_setup.sh"'
  else
    . "$COLCON_CURRENT_PREFIX/local_setup.sh"
  fi
  unset COLCON_CURRENT_PREFIX
  if [ -n "$nounset" ]; then set -u; fi
}

if _fourbar_env; then
  unset -f _fourbar_env; unset _fourbar_root
else
  unset -f _fourbar_env; unset _fourbar_root
  return 1
fi
