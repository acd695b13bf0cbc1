#!/bin/bash
# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
# run_fuzzer.sh BUILD NAME SECONDS: a fuzzer on its corpus; what it finds is kept in BUILD/fuzz.
set -euo pipefail
binary=$1/test/$2_fuzzer
found=$1/fuzz/$2
mkdir -p "$found/corpus"
if "$binary" -max_total_time="$3" -timeout=20 -rss_limit_mb=3000 -max_len=4096 -print_final_stats=1 \
  -artifact_prefix="$found/" "$found/corpus" "$(dirname "$0")/corpus/$2" >"$found/log" 2>&1; then
  echo "$2: nothing found in $3 s, $(sed -n 's/stat::number_of_executed_units: *//p' "$found/log") inputs"
else
  tail -n 60 "$found/log"
  echo "$2: failed, see $found"
  exit 1
fi
