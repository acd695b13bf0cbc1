#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
"""wrong_rigs.py on two seconds of one scenario: its tables are complete and its numbers finite.

test_wrong_rigs.py EGOMOTION_BAG EGOMOTION_SIM
"""

import json
import math
import pathlib
import sys
import unittest

RUNNER, SIMULATOR = sys.argv[1:3] if len(sys.argv) > 2 else ("", "")
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from scripts_test_case import TemporaryDirectoryTest, run  # noqa: E402

import wrong_rigs  # noqa: E402

PARTS = ("scale", "direction", "rotation")


def numbers_in(value):
    """All numbers within lists and dictionaries."""
    if isinstance(value, dict):
        value = value.values()
    elif not isinstance(value, list):
        return [value] if isinstance(value, (int, float)) else []
    return [number for one in value for number in numbers_in(one)]


class WrongRigs(TemporaryDirectoryTest):
    def run_script(self, *arguments):
        file = self.dir / "out.json"
        code, out, err = run(wrong_rigs.main, "--runner", RUNNER, "--json", file, *arguments)
        self.assertEqual(code, 0, err)
        result = json.loads(file.read_text())
        self.assertTrue(all(map(math.isfinite, numbers_in(result))))
        return out, result

    def scenario(self):
        return self.run_script("handheld_stereo", "--work", self.dir, "--duration", 2, "--rigs", 2, "--jobs", 2,
                               "--simulator", SIMULATOR)

    def test_scenarios_then_turned_cameras(self):
        out, result = self.scenario()
        scenario = result["scenarios"]["handheld_stereo"]
        self.assertEqual(list(scenario["rigs"]), ["1", "2"])
        runs = [scenario["exact"], *scenario["rigs"].values()]
        for one in runs:
            self.assertNotIn("error", one)
            self.assertEqual(set(one["nees"]), set(PARTS))
        self.assertEqual(len({one["ate_mm"] for one in runs}), 3, "three different rigs")
        for summary in (scenario["summary"], result["pooled"]):
            self.assertEqual((summary["rigs"], summary["failed"]), (2, 0))
            for part in PARTS:
                nees = summary["nees"][part]
                self.assertAlmostEqual(nees["mean_per_dof"], sum(one["nees"][part] for one in runs[1:]) / 2)
                self.assertIn(nees["inside"], (0, 1, 2))
        rows = [line.split()[0] for line in out.splitlines() if line]
        self.assertEqual(rows, ["handheld_stereo:", "rig", "exact", "1", "2", "median", "worst", "inside", "scenario",
                                "handheld_stereo", "all"])

        recording = self.dir / "handheld_stereo_2s" / "recording"
        written = (recording / "exact.bag").stat().st_mtime_ns
        self.assertEqual(self.scenario()[0], out, "the same again")
        self.assertEqual((recording / "exact.bag").stat().st_mtime_ns, written, "the recording is kept")

        out, result = self.run_script("--bag", recording / "exact.bag", "--rig", recording / "exact.rig.yaml",
                                      "--ground-truth", recording / "exact.groundtruth.tum", "--turned", "0.5")
        names = ["unturned", "cam1 x 0.5 deg", "cam1 y 0.5 deg", "cam1 z 0.5 deg"]
        self.assertEqual(list(result["turned"]), names)
        for name, one in result["turned"].items():
            self.assertNotIn("error", one)
            self.assertIn(f"{one['ate_mm']:.1f}", next(line for line in out.splitlines() if line.startswith(name)))
        self.assertEqual(result["turned"]["unturned"]["length_ratio"], 1.0)

    def test_what_cannot_be_run_is_said(self):
        code, _, err = run(wrong_rigs.main, "--work", self.dir, "--runner", self.dir / "none")
        self.assertEqual(code, 1)
        self.assertIn("egomotion_bag: found no executable", err)
        code, out, _ = run(wrong_rigs.main, "straight_line", "--work", self.dir, "--duration", 0.5, "--rigs", 1,
                           "--runner", "/bin/false", "--simulator", SIMULATOR)
        self.assertEqual(code, 1)
        self.assertIn("false: exit code 1)", out)
        rig = self.dir / "rig.yaml"
        rig.write_text("cam0: {}\n")
        code, _, err = run(wrong_rigs.main, "--bag", "none.bag", "--rig", rig, "--runner", RUNNER)
        self.assertEqual(code, 1)
        self.assertIn("rig.yaml: found no list of cameras", err)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
