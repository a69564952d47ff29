# To be sourced, in bash or zsh:   . scripts/env.sh
# Afterwards `python`, `fourbar`, `fourbar_node`, `fourbar_demo` are those of this tree, and
# rclpy and fourbar_msgs import. Sourcing twice is harmless.

_fourbar_env() {
  local venv=$1/.venv install=$1/install nounset=
  if [ ! -e "$venv/setup/ros" ] || [ ! -e "$install/local_setup.sh" ]; then
    echo 'fourbar_ros is not set up yet: make setup' >&2
    return 1
  fi
  if [ "$(cat "$venv/setup/ros")" = wheels ]; then      # all of ROS is in .venv: no other is mixed in
    unset PYTHONPATH PYTHONHOME LD_LIBRARY_PATH COLCON_PREFIX_PATH _ROS_WHEELS_BOOTSTRAP_COMPLETE
    export AMENT_PREFIX_PATH=$venv CMAKE_PREFIX_PATH=$venv RMW_IMPLEMENTATION=rmw_fastrtps_cpp
  elif [ -z "${ROS_DISTRO:-}" ]; then
    echo 'fourbar_ros was set up with a sourced ROS 2: source that first, or: make clean setup' >&2
    return 1
  fi
  local bin=$install/fourbar_ros/lib/fourbar_ros:$venv/bin
  case $PATH in "$bin:"*) ;; *) export PATH=$bin:$PATH ;; esac
  export VIRTUAL_ENV=$venv ROS_AUTOMATIC_DISCOVERY_RANGE=${ROS_AUTOMATIC_DISCOVERY_RANGE:-LOCALHOST}

  case $- in *u*) nounset=yes; set +u ;; esac           # colcon's script is for sh without -u
  COLCON_CURRENT_PREFIX=$install
  if [ -n "${ZSH_VERSION:-}" ]; then
    emulate sh -c '. "$COLCON_CURRENT_PREFIX/local_setup.sh"'
  else
    . "$COLCON_CURRENT_PREFIX/local_setup.sh"
  fi
  unset COLCON_CURRENT_PREFIX
  [ -z "$nounset" ] || set -u
}

# zsh names a sourced file in $0
if _fourbar_env "$(CDPATH='' cd -- "$(dirname -- "${BASH_SOURCE[0]:-$0}")/.." && pwd -P)"; then
  unset -f _fourbar_env
else
  unset -f _fourbar_env
  return 1
fi
