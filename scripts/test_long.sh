#!/bin/bash
# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/environment.bash"

usage() {
  cat <<'TEXT'
usage: test_long.sh [OPTION ...] [STAGE ...]

What is too long for every change. Stages, all unless some are named:
  fuzz      each fuzzer with AddressSanitizer and UndefinedBehaviorSanitizer
  thread    nodelet and node in a replay, with ThreadSanitizer
  address   all tests with AddressSanitizer and UndefinedBehaviorSanitizer
  soak      a minute's loop again and again, in process
  live      the same through the nodelet in real time
  signals   SIGINT and SIGTERM at random times

Options:
  --fuzz-seconds N   of each fuzzer (default 600)
  --laps N           of the soak (default 60)
  --live-seconds N   of the live soak (default 600)
  --signals N        sent (default 50)
TEXT
}

fail() {
  echo "test_long.sh: $*" >&2
  exit 1
}

fuzz_seconds=600 laps=60 live_seconds=600 signals=50
stages=()
while [[ $# -gt 0 ]]; do
  case $1 in
    -h | --help) usage; exit 0 ;;
    --fuzz-seconds | --laps | --live-seconds | --signals)
      [[ ${2:-} =~ ^[0-9]+$ ]] || fail "$1: found '${2:-}', expected a number"
      name=${1#--}
      declare "${name//-/_}=$2"
      shift ;;
    fuzz | thread | address | soak | live | signals) stages+=("$1") ;;
    *) fail "found $1, expected an option or a stage (see --help)" ;;
  esac
  shift
done
[[ ${#stages[@]} -gt 0 ]] || stages=(fuzz thread address soak live signals)

"$package/scripts/setup.sh"

# ROS in a build directory, with the recordings that the rostests need.
run_rostest() {  # run_rostest BUILD NAME FILE.test [NAME:=VALUE ...]
  local directory=$1 name=$2 file=$3
  shift 3
  (
    source_ros "$directory/devel/setup.bash"
    "$directory/devel/env.sh" python3 "$package/cmake/run_rostest.py" "$name" "$package/test/rostest/$file" \
      "$directory/test/rostest/$name" "$@"
  )
}

simulate() {  # simulate SCENARIO [SECONDS]: prints the path of the bag, without .bag
  local path=$build/test/recordings/$1${2:+_${2}s}
  if [[ ! -f $path.bag || $build/devel/lib/multicam_egomotion/egomotion_sim -nt $path.bag ]]; then
    mkdir -p "$(dirname "$path")"
    "$build/devel/lib/multicam_egomotion/egomotion_sim" "$1" "$path.bag" ${2:+--duration "$2"} >&2
  fi
  echo "$path"
}

build_release() {
  configure "$build/core" -DMULTICAM_EGOMOTION_ROS=OFF
  cmake --build "$build/core" -j "$jobs" --target all tests
  configure "$build" -DMULTICAM_EGOMOTION_CORE_BUILD="$build/core"
  cmake --build "$build" -j "$jobs" --target all tests
}

stage_fuzz() {
  local fuzz=$build/fuzz packages=(clang)
  # The sanitizers' libraries are a package of their own on newer systems.
  [[ -z $(apt-cache search --names-only '^libclang-rt-dev$' 2>/dev/null) ]] || packages+=(libclang-rt-dev)
  "$package/scripts/setup.sh" "${packages[@]}"
  configure "$fuzz" -DCMAKE_CXX_COMPILER=clang++ -DCMAKE_BUILD_TYPE=RelWithDebInfo -DMULTICAM_EGOMOTION_FUZZ=ON \
    -DMULTICAM_EGOMOTION_SANITIZE="address;undefined"
  cmake --build "$fuzz" -j "$jobs" --target fuzzers
  local corpus
  for corpus in "$package"/test/fuzz/corpus/*/; do basename "$corpus"; done |
    xargs -P "$jobs" -I NAME "$package/test/fuzz/run_fuzzer.sh" "$fuzz" NAME "$fuzz_seconds"
}

stage_thread() {
  local thread=$build/thread reports=$build/thread/reports recording name
  build_release
  recording=$(simulate handheld_stereo 4)
  configure "$thread" -DCMAKE_BUILD_TYPE=RelWithDebInfo -DMULTICAM_EGOMOTION_SANITIZE=thread
  cmake --build "$thread" -j "$jobs" --target all test_replay test_services
  rm -rf "$reports"
  mkdir -p "$reports"
  # Only the odometry runs with it; what ROS does in programs that are not built with it is not its business.
  local options="suppressions=$package/test/sanitizers/thread.supp log_path=$reports/report exitcode=0"
  local libraries
  libraries=$(g++ -print-file-name=libtsan.so)
  # On one core, where OpenCV starts no threads: they are joined in a library that ThreadSanitizer does not see.
  export EGOMOTION_LAUNCH_PREFIX="taskset -c 0 setarch -R env LD_PRELOAD=$libraries 'TSAN_OPTIONS=$options'"
  run_rostest "$thread" replay_thread replay.test rate:=0.05 max_error:=0.05 bag:="$recording.bag" \
    rig:="$recording.rig.yaml"
  run_rostest "$thread" topics_only_thread topics_only.test rate:=0.05 bag:="$recording.bag"
  unset EGOMOTION_LAUNCH_PREFIX
  for name in "$reports"/*; do
    [[ ! -e $name ]] || { cat "$name"; fail "thread: found reports, expected none ($reports)"; }
  done
}

stage_address() {
  "$package/scripts/test_sanitized.sh" --all
}

stage_soak() {
  configure "$build/core" -DMULTICAM_EGOMOTION_ROS=OFF
  cmake --build "$build/core" -j "$jobs" --target loop_soak
  "$build/core/test/loop_soak" "$laps"
}

stage_live() {
  build_release
  local loop
  loop=$(simulate loop)
  run_rostest "$build" soak soak.test duration:="$live_seconds" bag:="$loop.bag" rig:="$loop.rig.yaml"
}

stage_signals() {
  build_release
  local recording
  recording=$(simulate handheld_stereo 8)
  MULTICAM_EGOMOTION_SIGNALS=$signals run_rostest "$build" signals live_faults.test bag:="$recording.bag" \
    rig:="$recording.rig.yaml"
}

for stage in "${stages[@]}"; do
  echo "== $stage"
  begin=$SECONDS
  "stage_$stage"
  echo "== $stage passed in $((SECONDS - begin)) s"
done
