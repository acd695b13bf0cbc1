# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of the Python tools share: running a script, a made-up trajectory, a temporary directory."""

import contextlib
import io
import os
import pathlib
import sys
import tempfile
import unittest

PACKAGE = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(PACKAGE / "scripts"))

import numpy as np  # noqa: E402

import rotations  # noqa: E402
from trajectory_io import NS, Trajectory  # noqa: E402

DATA = pathlib.Path(os.environ.get("MULTICAM_EGOMOTION_DATA", PACKAGE.parent / "shared" / "data"))
EPOCH_NS = 1_400_000_000_123_456_789


def real_data(name):
    """The path of a folder or file of real recordings, or a skip that names it."""
    if not (DATA / name).exists():
        raise unittest.SkipTest(f"real data {name} not found (MULTICAM_EGOMOTION_DATA)")
    return DATA / name


def run(main, *arguments):
    """(exit code, stdout, stderr) of a script's main function."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = main([str(argument) for argument in arguments])
    return code, out.getvalue(), err.getvalue()


def winding_trajectory(count=400, rate_hz=20.0):
    """A smooth walk of some 30 m with several turns, z up."""
    t = np.arange(count) / rate_hz
    positions = np.stack([1.5 * t, 2.0 * np.sin(0.5 * t), 0.3 * np.sin(0.8 * t)], axis=1)
    vectors = np.stack([0.1 * np.sin(t), 0.1 * np.cos(0.7 * t), 0.9 * t], axis=1)
    matrices = rotations.exp(vectors * [0, 0, 1]) @ rotations.exp(vectors * [1, 1, 0])
    return Trajectory(positions, matrices, EPOCH_NS + np.round(t * NS).astype(np.int64))


class TemporaryDirectoryTest(unittest.TestCase):
    """Has an empty directory `dir`, removed afterwards."""

    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.dir = pathlib.Path(directory.name)
