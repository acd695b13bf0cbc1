# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
"""The paper's experiments with few trials: what must come out whatever the machine."""

import filecmp
import os
import pathlib
import subprocess
import tempfile
import unittest

from scripts_test_case import PACKAGE

import numpy as np

from paper_claims_noise import PITCH
from paper_numbers import SEQUENCES, SOLVERS
from paper_results import AXIS_NOISES, MOTIONS, OURS, SELECTIONS, KittiTable, NoiseFigure, read_rows

FOUR_POINTS = {"4pt-lee", "4pt-liu", "4pt-sweeney", "4pt-vertical", "4pt-axis"}
FIGURES = (("fig4_image_noise.csv", "noise_px"), ("fig5_pitch_noise.csv", "noise_deg"),
           ("fig6_roll_noise.csv", "noise_deg"))
ERRORS = ("rotation", "translation")


def run_experiments(out, *arguments):
    """Runs paper_experiments."""
    if "PAPER_EXPERIMENTS" not in os.environ:
        raise unittest.SkipTest("PAPER_EXPERIMENTS names no executable")
    subprocess.run([os.environ["PAPER_EXPERIMENTS"], "--out", str(out), *map(str, arguments)], check=True,
                   stderr=subprocess.DEVNULL)


def same_files(test, one, other):
    """The names of all files but that of the run times, which have to be equal."""
    names = [path.name for path in one.iterdir() if path.name != "table1_runtime.csv"]
    test.assertEqual(filecmp.cmpfiles(one, other, names, shallow=False), (names, [], []))
    return names


class PaperTest(unittest.TestCase):
    """Runs reproduce_paper.sh --quick once, without real data."""

    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.dir = pathlib.Path(cls.temporary.name) / "report"
        cls.empty = pathlib.Path(cls.temporary.name) / "empty"
        cls.empty.mkdir()
        command = [str(PACKAGE / "scripts/reproduce_paper.sh"), "--quick", "--out", str(cls.dir), "--data",
                   str(cls.empty)]
        if "PAPER_EXPERIMENTS" in os.environ:
            command += ["--executable", os.environ["PAPER_EXPERIMENTS"]]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def figures(self):
        return [NoiseFigure(self.dir / name, column) for name, column in FIGURES]

    def test_every_solver_is_in_every_table(self):
        for name in ("table1_runtime.csv", "fig3_stability.csv", "fig4_image_noise.csv"):
            self.assertEqual(set(SOLVERS), {row["solver"] for row in read_rows(self.dir / name)}, name)
        for name in ("fig5_pitch_noise.csv", "fig6_roll_noise.csv"):
            self.assertEqual(FOUR_POINTS, {row["solver"] for row in read_rows(self.dir / name)}, name)

    def test_errors_grow_with_image_noise(self):
        figure = self.figures()[0]
        for motion in MOTIONS:
            for selection in SELECTIONS:
                for solver, noise in figure.curves():
                    for error in ERRORS:
                        curve = figure.median(motion, selection, noise, solver, error)
                        self.assertGreater(curve[-1], curve[1], (motion, selection, solver, error))
                        self.assertGreater(curve[1], curve[0], (motion, selection, solver, error))

    def test_rotation_errors_grow_with_tilt_noise(self):
        for figure in self.figures()[1:]:
            for motion in MOTIONS:
                for solver, noise in figure.curves():
                    curve = figure.median(motion, "nearest", noise, solver, "rotation")
                    self.assertGreater(np.mean(curve[-3:]), np.mean(curve[:3]), (motion, solver, noise))

    def test_the_same_polynomial_gives_the_same_curve(self):
        image, pitch, roll = self.figures()
        pairs = [(image, "4pt-lee", "4pt-vertical", "none"), (image, "4pt-sweeney", "4pt-axis", "none")]
        for figure in (pitch, roll):
            pairs += [(figure, "4pt-lee", "4pt-vertical", "tilt")]
            pairs += [(figure, "4pt-sweeney", "4pt-axis", noise) for noise in AXIS_NOISES]
        for figure, one, other, noise in pairs:
            for motion in MOTIONS:
                # Of solutions with as many votes the first counts, and the solvers list them in different orders.
                for selection, tolerance in (("nearest", 1e-3), ("vote", 0.1)):
                    for error in ERRORS:
                        curves = [np.array(figure.median(motion, selection, noise, solver, error))[1:]
                                  for solver in (one, other)]
                        np.testing.assert_allclose(*curves, rtol=tolerance,
                                                   err_msg=f"{one}, {other}, {motion}, {selection}, {noise}")

    def test_exact_solvers_are_exact_without_noise(self):
        for row in read_rows(self.dir / "fig3_quantiles.csv"):
            if row["solver"] != "4pt-liu":
                self.assertLess(float(row["log10_median"]), -12.0, row)
            else:
                self.assertGreater(float(row["log10_median"]), -6.0, row)

    def test_sequences_that_are_not_there_have_no_data(self):
        for name in ("table2_rotation.csv", "table3_translation.csv"):
            table = KittiTable(self.dir / name)
            self.assertEqual(table.places, [(sequence, "no data") for sequence in SEQUENCES])
            for place in table.places:
                for method in SOLVERS + OURS:
                    self.assertTrue(np.isnan(table.value(place, method)))

    def test_report_has_every_table_and_figure(self):
        report = (self.dir / "report.md").read_text()
        for title in ("Table I:", "Table II:", "Table III:", "Fig. 3", "Fig. 4", "Fig. 5", "Fig. 6", "Fig. 7"):
            self.assertIn("## " + title, report)
        for picture in ("fig3_stability.png", "fig4_image_noise_nearest.png", "fig6_roll_noise_vote.png"):
            self.assertIn(picture, report)
            self.assertGreater((self.dir / picture).stat().st_size, 10000)
        claims = (self.dir / "claims.md").read_text()
        for text, _ in PITCH:
            self.assertIn(text, claims)

    def test_results_do_not_depend_on_the_number_of_threads(self):
        outs = [self.dir.parent / f"threads{count}" for count in (1, 3)]
        for out, count in zip(outs, (1, 3)):
            run_experiments(out, "--trials", 10, "--threads", count)
        self.assertEqual(len(same_files(self, *outs)), 8)


if __name__ == "__main__":
    unittest.main()
