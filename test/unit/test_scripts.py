#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
"""Runs all tests of the Python tools (test_scripts_*.py), naming each, also those that are skipped."""

import pathlib
import sys
import unittest

if __name__ == "__main__":
    directory = pathlib.Path(__file__).resolve().parent
    tests = unittest.defaultTestLoader.discover(str(directory), pattern="test_scripts_*.py")
    sys.exit(not unittest.TextTestRunner(verbosity=2).run(tests).wasSuccessful())
