# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
# Sourced by test.sh and demo.sh: the system's tools first, then ROS Noetic where it is in /opt (Ubuntu 20.04).
export PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin
package=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$package/build
jobs=$(nproc)

# The setup files of ROS read unset variables.
source_ros() {
  set +u
  # shellcheck disable=SC1090
  . "$1"
  set -u
}

if [[ -f /opt/ros/noetic/setup.bash ]]; then
  source_ros /opt/ros/noetic/setup.bash
fi

# Nodes find each other on this machine whatever its name resolves to; logs stay in the build directory.
unset ROS_HOSTNAME
export ROS_IP=127.0.0.1
export ROS_HOME=$build/ros_home

# configure BUILD_DIR [CMAKE_ARGUMENT ...]: what is compiled from nothing more often than after an edit is compiled in
# batches of files (a unity build); their generated text is the same in every build directory, for ccache.
configure() {
  local directory=$1
  shift
  if [[ -f $directory/CMakeCache.txt && ! -f $directory/build.ninja ]]; then  # of another generator
    rm -rf "$directory"/{CMakeCache.txt,CMakeFiles}
  fi
  cmake -S "$package" -B "$directory" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_UNITY_BUILD=ON \
    "-DCMAKE_CXX_COMPILER_LAUNCHER=env;CCACHE_BASEDIR=$directory;ccache" "$@"
}
