#!/bin/bash
# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
# AddressSanitizer and UndefinedBehaviorSanitizer over the unit tests and the offline fault table, in build/sanitized.
# test_sanitized.sh [--all] [CTEST_ARGUMENT ...]; --all takes the rostests, and the tests that are long because they
# repeat trials, as well.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/environment.bash"

sanitized=$build/sanitized
targets=(all tests)
filter=(-E '^(style_|test_scripts)')
if [[ ${1:-} == --all ]]; then
  shift
else
  long='Accuracy|Recorded|Starts|Euroc|EgoMotion|SystematicDrift|GyroscopeCheck|Window|test_simulator|test_ego_motion'
  filter=(-E "^(style_|test_scripts|test_recordings|test_egomotion_bag|rostest_|recording_|consumer_|install_|example_|python_)|$long")
  targets=(test_{geometry,solvers,estimation,imu,tracking,odometry,fault_table,ros_layer})
  for source in "$package"/test/fuzz/{,ros/}*_fuzzer.cpp; do targets+=("$(basename "$source" .cpp)"); done
fi

"$package/scripts/setup.sh"
configure "$sanitized" -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG="-O1 -g1" \
  -DMULTICAM_EGOMOTION_SANITIZE="address;undefined"
cmake --build "$sanitized" -j "$jobs" --target "${targets[@]}"

source_ros "$sanitized/devel/setup.bash"
export ASAN_OPTIONS=strict_string_checks=1:detect_stack_use_after_return=1 UBSAN_OPTIONS=print_stacktrace=1
# Programs that load the nodelet are not built with the sanitizer: its library has to come first.
EGOMOTION_LAUNCH_PREFIX="env LD_PRELOAD=$(g++ -print-file-name=libasan.so):$(g++ -print-file-name=libstdc++.so)"
export EGOMOTION_LAUNCH_PREFIX
cd "$sanitized"
exec ctest --output-on-failure --no-tests=error -j "$jobs" "${filter[@]}" "$@"
