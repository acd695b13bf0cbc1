#!/bin/bash
# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/environment.bash"

usage() {
  cat <<'TEXT'
usage: reproduce_paper.sh [--quick] [--data DIR] [--out DIR] [--executable FILE]

Repeats every table and figure of the paper's section V and leaves a report.
  --quick            few trials and the first frames of each sequence: a minute at most
  --data DIR         searched for KITTI: odometry folders (sequences/NN, poses/NN.txt) and drives with tracks.csv;
                     default $MULTICAM_EGOMOTION_DATA, else ../shared/data beside the package, else none
  --out DIR          for CSV files, figures, report.md and claims.md; default paper_report/ under the package
  --executable FILE  paper_experiments that is already there; default: it is built
TEXT
}

fail() {
  echo "reproduce_paper.sh: $*" >&2
  exit 1
}

arguments=()
data=${MULTICAM_EGOMOTION_DATA:-}
[[ -n $data || ! -d $package/../shared/data ]] || data=$package/../shared/data
out=$package/paper_report
executable=
while [[ $# -gt 0 ]]; do
  case $1 in
    -h | --help) usage; exit 0 ;;
    --quick) arguments+=(--trials 100 --frames 30 --ransac-seeds 1) ;;
    --data | --out | --executable) [[ $# -ge 2 ]] || fail "$1: found nothing, expected a value"
      case $1 in
        --data) data=$2 ;;
        --out) out=$2 ;;
        --executable) executable=$2 ;;
      esac
      shift ;;
    *) fail "found $1 (see --help)" ;;
  esac
  shift
done

if [[ -z $executable ]]; then
  "$package/scripts/setup.sh"
  configure "$build/core" -DMULTICAM_EGOMOTION_ROS=OFF
  cmake --build "$build/core" -j "$jobs" --target paper_experiments
  executable=$build/core/paper_experiments
fi
"$executable" --out "$out" ${data:+--data "$data"} "${arguments[@]}"
"$package/scripts/plot_paper.py" "$out"
echo "$out: report.md, claims.md"
