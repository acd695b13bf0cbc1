#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
"""Runs one rostest in a scratch ROS_HOME; exit code 0 passed, 1 failed (by the XML results), 77 skipped.

run_rostest.py NAME FILE.test SCRATCH [--needs PATH] [arg:=value ...]
"""

import argparse
import os
import pathlib
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ElementTree


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("name")
    parser.add_argument("file")
    parser.add_argument("scratch", type=pathlib.Path)
    parser.add_argument("--needs", help="skip when this path does not exist")
    arguments, launch_arguments = parser.parse_known_args()
    if arguments.needs and not os.path.exists(arguments.needs):
        print(f"SKIPPED {arguments.name}: {arguments.needs} does not exist")
        return 77

    shutil.rmtree(arguments.scratch, ignore_errors=True)
    results = arguments.scratch / "results"
    results.mkdir(parents=True)
    environment = dict(os.environ, ROS_HOME=str(arguments.scratch), ROS_TEST_RESULTS_DIR=str(results))
    code = subprocess.call(["rostest", arguments.file, *launch_arguments], env=environment)

    tests = failures = 0
    for path in results.rglob("*.xml"):
        root = ElementTree.parse(path).getroot()
        for suite in [root] if root.tag == "testsuite" else root.iter("testsuite"):
            tests += int(suite.get("tests", 0))
            failures += int(suite.get("failures", 0)) + int(suite.get("errors", 0))
            for case in suite.iter("testcase"):
                for fault in list(case.iter("failure")) + list(case.iter("error")):
                    print(f"{case.get('name')}: {fault.get('message') or ''}\n{fault.text or ''}")
    print(f"{arguments.name}: {tests} tests, {failures} failures, rostest's exit code {code}")
    return 0 if tests > 0 and failures == 0 and code == 0 else 1


if __name__ == "__main__":
    sys.exit(main())
