#!/bin/bash
# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
# AddressSanitizer and UndefinedBehaviorSanitizer over the unit tests and the offline fault table, in build/sanitized.
# test_sanitized.sh [--all] [CTEST_ARGUMENT ...]; --all takes the rostests, the fuzzers' corpora, the tests that are
# long because they repeat trials, and every check of the sanitizers. Without it those checks are left out that take
# most time: null, alignment, pointers and objects, and the stack after return.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/environment.bash"

sanitized=$build/sanitized
if [[ ${1:-} == --all ]]; then
  shift
  sanitizers="address;undefined"
  flags="-O1 -g1"
  stack_use_after_return=1
  targets=(all tests)
  filter=(-E '^(style_|test_scripts|consumer_)')  # consumers are not built with the sanitizers
else
  sanitizers="address;bool;bounds;enum;float-cast-overflow;integer-divide-by-zero;return;shift;signed-integer-overflow;unreachable"
  flags="-O2 -g0"
  stack_use_after_return=0
  targets=(test_{geometry,solvers,estimation,imu,tracking,odometry,fault_table,ros_layer})
  long='Accuracy|Recorded|Starts|Euroc|EgoMotion|SystematicDrift|GyroscopeCheck|Window|ManyRuns|WidePrior'
  other='style_|test_scripts|test_(recordings|simulator|ego_motion|egomotion_bag)|rostest_|recording_|consumer_|install_|example_|python_|fuzz_'
  filter=(-E "^($other)|$long")
fi

"$package/scripts/setup.sh"
configure "$sanitized" -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG="$flags" \
  -DMULTICAM_EGOMOTION_SANITIZE="$sanitizers"
cmake --build "$sanitized" -j "$jobs" --target "${targets[@]}"

source_ros "$sanitized/devel/setup.bash"
export ASAN_OPTIONS=strict_string_checks=1:detect_stack_use_after_return=$stack_use_after_return
export UBSAN_OPTIONS=print_stacktrace=1
# Programs that load the nodelet are not built with the sanitizer: its library has to come first.
EGOMOTION_LAUNCH_PREFIX="env LD_PRELOAD=$(g++ -print-file-name=libasan.so):$(g++ -print-file-name=libstdc++.so)"
export EGOMOTION_LAUNCH_PREFIX
cd "$sanitized"
exec ctest --output-on-failure --no-tests=error -j "$jobs" "${filter[@]}" "$@"
