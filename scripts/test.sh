#!/bin/bash
# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
# Installs what is missing, builds and runs all tests: those of the core in build/core, configured without ROS, those
# of the ROS layer in build/. Exit code non-zero when a test fails or none was found. Arguments go to ctest.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/environment.bash"

"$package/scripts/setup.sh"
configure "$build/core" -DMULTICAM_EGOMOTION_ROS=OFF
cmake --build "$build/core" -j "$jobs" --target all tests
# The sources of the core come from ccache here.
configure "$build" -DMULTICAM_EGOMOTION_CORE_BUILD="$build/core"
cmake --build "$build" -j "$jobs" --target all tests

source_ros "$build/devel/setup.bash"
cd "$build"
exec ctest --output-on-failure --no-tests=error -j "$jobs" "$@"
