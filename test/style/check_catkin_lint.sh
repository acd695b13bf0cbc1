#!/bin/sh
# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
# catkin_lint on the package; exit code 77 (skipped) where it is missing. Ignored: setup.sh and its like belong to the
# source tree and are not installed; a library built on catkin and OpenCV has their headers in its interface.
set -eu
cd "$(dirname "$0")/../.."
command -v catkin_lint >/dev/null || { echo "catkin_lint not found"; exit 77; }
exec catkin_lint -W1 --strict --offline --ignore uninstalled_script --ignore external_interface_path .
