#!/bin/sh
# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
# Every C++ source is as clang-format 14 leaves it; exit code 77 (skipped) where that version is missing.
set -eu
cd "$(dirname "$0")/../.."
formatter=$(command -v clang-format-14 || command -v clang-format || true)
case "$("${formatter:-false}" --version 2>/dev/null || true)" in
  *"version 14."*) ;;
  *) echo "clang-format 14 not found"; exit 77 ;;
esac
find include src python examples test -name '*.h' -o -name '*.cpp' -o -name '*.inc' | sort | xargs "$formatter" --dry-run -Werror
