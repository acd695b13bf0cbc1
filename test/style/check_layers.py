#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
"""A layer includes only itself and those below it, the core no ROS header, and every source has its license."""

import pathlib
import re
import sys

PACKAGE = pathlib.Path(__file__).resolve().parents[2]
BELOW = {
    "geometry": set(),
    "imu": {"geometry"},
    "solvers": {"geometry"},
    "estimation": {"geometry", "imu", "solvers"},
    "tracking": {"geometry", "imu", "solvers"},
    "odometry": {"geometry", "imu", "solvers", "estimation", "tracking"},
}
ROS_HEADER = re.compile(r"^(ros|rosbag|nodelet|pluginlib|tf2|tf2_\w+|cv_bridge|image_transport|diagnostic_updater"
                        r"|\w+_msgs|\w+_srvs)/")


def faults(path, layer):
    """Yields what is wrong with a source of a layer (None: any layer may be included)."""
    text = path.read_text()
    if "SPDX-License-Identifier: BSD-3-Clause" not in text[:400]:
        yield "found no SPDX-License-Identifier, expected BSD-3-Clause in the first lines"
    if layer not in BELOW:
        return
    for header in re.findall(r'^\s*#include\s+["<]([^">]+)[">]', text, re.MULTILINE):
        own = re.match(r"multicam_egomotion/(?:(\w+)/)?", header)
        if ROS_HEADER.match(header) or (own and own.group(1) is None):
            yield f"found {header}, expected no header of ROS in the core"
        elif own and own.group(1) not in BELOW[layer] | {layer}:
            yield f"found {header}, expected only layers below {layer}: {', '.join(sorted(BELOW[layer])) or 'none'}"


def main():
    count = 0
    for root in ("include/multicam_egomotion", "src", "python", "examples", "test", "scripts"):
        for path in sorted((PACKAGE / root).rglob("*")):
            if path.suffix not in (".h", ".cpp", ".inc", ".py", ".sh", ".bash"):
                continue
            layer = path.relative_to(PACKAGE / root).parts[0] if root != "test" else None
            for fault in faults(path, layer):
                print(f"{path.relative_to(PACKAGE)}: {fault}")
                count += 1
    return 1 if count else 0


if __name__ == "__main__":
    sys.exit(main())
