# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
"""Tests of the bag converters on real recordings.

They look for MULTICAM_EGOMOTION_DATA or ../shared/data beside the package and skip, by name, where it is missing.
"""

import numpy as np
import rosbag

from scripts_test_case import real_data, run
from test_scripts_converters import ConverterTest

import euroc_to_bag
import kitti_odometry
import kitti_to_bag
from smoothing_spline import GRAVITY
from trajectory_io import read_kitti, read_tum


class RealDataTest(ConverterTest):
    def counts(self):
        with rosbag.Bag(str(self.bag)) as bag:
            return {topic: info.message_count for topic, info in bag.get_type_and_topic_info().topics.items()}

    def test_euroc(self):
        self.assertEqual(run(euroc_to_bag.main, real_data("euroc_mh01_excerpt") / "mav0", self.bag)[0], 0)
        counts = self.counts()
        self.assertEqual(counts["/cam0/image_raw"], counts["/cam1/image_raw"])
        self.assertGreater(counts["/imu"], 8 * counts["/cam0/image_raw"])
        self.assertGreater(len(read_tum(self.dir / "out.groundtruth.tum")), 1000)

    def test_kitti_odometry(self):
        sequence, poses = (real_data(f"kitti_odometry_excerpt/{name}") for name in ("sequences/03", "poses/03.txt"))
        self.assertEqual(run(kitti_to_bag.main, sequence, self.bag, "--poses", poses)[0], 0)
        self.assertEqual(self.counts()["/cam1/image_raw"], len(read_kitti(poses)))

    def test_kitti_derived_imu_is_plausible(self):
        sequence, poses = (real_data(f"kitti_odometry_excerpt/{name}") for name in ("sequences/03", "poses/03.txt"))
        stamps = kitti_odometry.read_stamps(sequence / "times.txt")
        truth = kitti_odometry.read_body_poses(poses, stamps, "times.txt")
        imu = kitti_odometry.derive_imu(truth, seed=1, noise=0.0)
        self.assertLess(np.abs(imu.specific_forces - [0.0, 0.0, GRAVITY]).max(), 5.0)
        self.assertLess(np.degrees(np.abs(imu.angular_rates)).max(), 45.0)

    def test_kitti_raw_with_four_cameras(self):
        drive = real_data("kitti_raw_4cam/kitti_raw/2011_09_26/2011_09_26_drive_0002_sync")
        self.assertEqual(run(kitti_to_bag.main, "--raw", drive, self.bag, "--cameras", "0,1,2,3")[0], 0)
        self.assertEqual([self.counts()[f"/cam{i}/image_raw"] for i in range(4)], [10] * 4)
