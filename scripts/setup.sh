#!/bin/bash
# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
# setup.sh [--rviz] [PACKAGE ...]: installs with apt what building and testing need, with --rviz what its pictures need
# as well, and the packages named, as far as it is missing; does nothing when all is there. Debian 12 has ROS 1 in its
# own archive; on Ubuntu 20.04, ROS Noetic's packages are used (/opt/ros/noetic).
set -euo pipefail
export PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin

packages=(
  # build
  g++ ninja-build cmake ccache libboost-program-options-dev libeigen3-dev libopencv-dev libyaml-cpp-dev
  pybind11-dev python3-dev
  # scripts
  python3 python3-matplotlib python3-numpy python3-pil python3-yaml
  # tests
  clang-format catkin-lint libbenchmark-dev libgtest-dev
)
if [[ ${1:-} == --rviz ]]; then
  shift
  packages+=(imagemagick libgl1-mesa-dri xvfb)  # without a screen
  if [[ -d /opt/ros/noetic ]]; then packages+=(ros-noetic-rviz); else packages+=(rviz); fi
fi
if [[ -d /opt/ros/noetic ]]; then
  for name in catkin cv-bridge diagnostic-updater dynamic-reconfigure geometry-msgs image-transport \
    message-generation message-runtime nav-msgs nodelet pluginlib rosbag rosbash roscpp roslaunch rosnode rosparam \
    rospy rosservice rostest sensor-msgs std-msgs std-srvs tf2 tf2-eigen tf2-msgs tf2-ros topic-tools; do
    packages+=("ros-noetic-$name")
  done
else
  packages+=(
    catkin libcv-bridge-dev libdiagnostic-updater-dev libdynamic-reconfigure-config-init-mutex-dev libgeometry-msgs-dev
    libimage-transport-dev libnav-msgs-dev libnodeletlib-dev libnodeletlib-tools librosbag-dev libroscpp-dev
    librostest-dev libsensor-msgs-dev libstd-msgs-dev libstd-srvs-dev libtf2-dev libtf2-eigen-dev libtf2-msgs-dev
    libtf2-ros-dev pluginlib-dev python3-diagnostic-msgs python3-dynamic-reconfigure python3-genpy python3-geometry-msgs
    python3-nav-msgs python3-rosbag python3-roslaunch python3-rosnode python3-rosparam python3-rospy python3-rosservice
    python3-rostest python3-sensor-msgs python3-std-srvs python3-tf2-msgs ros-geometry-msgs ros-message-generation
    ros-message-runtime ros-std-msgs rosbash rospack-tools topic-tools
  )
fi

packages+=("$@")

as_root() {
  if [[ $(id -u) -eq 0 ]]; then
    "$@"
  elif command -v sudo >/dev/null; then
    sudo "$@"
  else
    echo "setup.sh: found no sudo, expected it or root for: $*" >&2
    return 1
  fi
}

# roslaunch looks up localhost; a bare root file system may lack even that.
if ! getent hosts localhost >/dev/null; then
  echo '127.0.0.1 localhost' | as_root tee -a /etc/hosts >/dev/null
fi

installed=$(dpkg-query -W -f='${binary:Package} ${db:Status-Status}\n' 2>/dev/null | sed -n 's/\(:[^ ]*\)\? installed$//p')
mapfile -t missing < <(printf '%s\n' "${packages[@]}" | grep -vxF -f <(printf '%s\n' "$installed") || true)
if [[ ${#missing[@]} -eq 0 ]]; then
  exit 0
fi

echo "Installing ${missing[*]}"
install=(env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends "${missing[@]}")
# The package lists are fetched only where they are absent or too old to install from.
known=$(apt-cache policy "${missing[@]}" 2>/dev/null | grep -c '^  Candidate: [^(]' || true)
if [[ $known -lt ${#missing[@]} ]] || ! as_root "${install[@]}"; then
  as_root apt-get update
  as_root "${install[@]}"
fi
