# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
"""The paper's experiments on KITTI 03, where it is (MULTICAM_EGOMOTION_DATA or ../shared/data)."""

import unittest

import numpy as np

from scripts_test_case import TemporaryDirectoryTest, real_data
from test_scripts_paper import run_experiments, same_files

from paper_results import KittiTable


class KittiTest(TemporaryDirectoryTest):
    def setUp(self):
        super().setUp()
        # Alone, whatever other sequences there are.
        self.data = self.dir / "data"
        for name in ("sequences/03", "poses/03.txt"):
            path = self.data / name
            path.parent.mkdir(parents=True)
            path.symlink_to(real_data(f"kitti_odometry_excerpt/{name}").resolve())

    def test_medians_of_the_whole_chain(self):
        out = self.dir / "report"
        run_experiments(out, "--trials", 1, "--ransac-seeds", 1, "--data", self.data)
        for file, highest in (("table2_rotation.csv", 0.030), ("table3_translation.csv", 0.75)):
            table = KittiTable(out / file)
            self.assertEqual(table.measured_sequences(), [("03", "images")])
            self.assertLessEqual(table.value(("03", "images"), "ours"), highest, file)
            self.assertEqual(table.value(("03", "images"), "ours", "failed"), 0)
            self.assertTrue(np.isnan(table.value(("07", "no data"), "ours")))

    def test_results_do_not_depend_on_the_number_of_threads(self):
        outs = [self.dir / f"threads{count}" for count in (1, 3)]
        for out, count in zip(outs, (1, 3)):
            run_experiments(out, "--trials", 1, "--ransac-seeds", 2, "--frames", 10, "--threads", count, "--data",
                            self.data)
        same_files(self, *outs)


if __name__ == "__main__":
    unittest.main()
