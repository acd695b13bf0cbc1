#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
"""Wrong configurations: the node exits with 1 and names the parameter; a nodelet manager lives on."""

import subprocess
import sys
import unittest

import rosnode
import rospy
import rostest
from roslib.packages import find_node

RIG = sys.argv[1] if len(sys.argv) > 1 else ""


def run(command, timeout=20):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=timeout)
    return done.returncode, done.stdout


class BadConfiguration(unittest.TestCase):
    def expect_refusal(self, parameters, *words):
        name = self.id().rsplit(".", 1)[-1]  # of its own: parameters stay on the server
        for key, value in parameters.items():
            rospy.set_param(f"/{name}/{key}", value)
        code, output = run(find_node("multicam_egomotion", "egomotion_node") + [f"__name:={name}"])
        self.assertEqual(code, 1, output)
        for word in words:
            self.assertIn(word, output)

    def test_unknown_choice(self):
        self.expect_refusal({"rig_file": RIG, "solver": "8pt"}, "solver", "8pt", "4pt-vertical")

    def test_out_of_range(self):
        self.expect_refusal({"rig_file": RIG, "tracker/features_per_camera": -3}, "features_per_camera", "-3")

    def test_wrong_type(self):
        self.expect_refusal({"rig_file": RIG, "use_imu": "perhaps"}, "use_imu", "perhaps", "true or false")

    def test_missing_rig_file(self):
        self.expect_refusal({"rig_file": "/does/not/exist.yaml"}, "rig_file", "/does/not/exist.yaml")

    def test_missing_mask(self):
        self.expect_refusal({"rig_file": RIG, "mask_files": ["/no/mask.png", ""]}, "mask_files", "/no/mask.png")

    def test_manager_lives_on(self):
        code, output = run(["rosrun", "nodelet", "nodelet", "load", "multicam_egomotion/EgoMotionNodelet", "manager",
                            "__name:=refused", "_solver:=8pt"])
        self.assertNotEqual(code, 0, output)
        self.assertTrue(rosnode.rosnode_ping("/manager", max_count=1))


if __name__ == "__main__":
    rostest.rosrun("multicam_egomotion", "bad_configuration", BadConfiguration)
