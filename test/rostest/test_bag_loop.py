#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
"""A bag played three times in a loop: the odometry goes on at once in each pass, as well as in the first."""

import threading
import time
import unittest

import numpy as np
import rospy
import rostest
from multicam_egomotion.msg import EgoMotion
from nav_msgs.msg import Odometry
from sensor_msgs.msg import Image

PASSES = 3


class Pass:
    """What one pass over the bag brought: wall times of arrival and poses by stamp."""

    def __init__(self):
        self.begin = time.monotonic()
        self.images, self.odometry, self.epochs = [], {}, []
        self.first_odometry = None

    def ate(self, truth):
        """RMSE of the positions, position and yaw aligned."""
        stamps = sorted(stamp for stamp in self.odometry if truth[0, 0] <= stamp <= truth[-1, 0])
        estimated = np.array([self.odometry[stamp] for stamp in stamps])
        expected = np.column_stack([np.interp(stamps, truth[:, 0], truth[:, axis]) for axis in (1, 2, 3)])
        estimated -= estimated.mean(axis=0)
        expected -= expected.mean(axis=0)
        yaw = np.arctan2(np.sum(estimated[:, 0] * expected[:, 1] - estimated[:, 1] * expected[:, 0]),
                         np.sum(estimated[:, 0] * expected[:, 0] + estimated[:, 1] * expected[:, 1]))
        cosine, sine = np.cos(yaw), np.sin(yaw)
        turned = estimated @ np.array([[cosine, sine, 0], [-sine, cosine, 0], [0, 0, 1]])
        return np.sqrt(np.mean(np.sum((turned - expected) ** 2, axis=1)))


class BagLoop(unittest.TestCase):
    def setUp(self):
        self.lock = threading.Lock()
        self.passes, self.truth = [], {}
        self.odometry_pass, self.last_odometry, self.last_motion, self.motion_pass = 0, 0.0, 0.0, 0
        self.subscribers = [
            rospy.Subscriber("cam0/image_raw", Image, self.receive_image, queue_size=100, buff_size=1 << 24),
            rospy.Subscriber("odometry", Odometry, self.receive_odometry, queue_size=100),
            rospy.Subscriber("ego_motion", EgoMotion, self.receive_motion, queue_size=100),
            rospy.Subscriber("ground_truth", Odometry, self.receive_truth, queue_size=1000)]

    def receive_image(self, message):
        stamp = message.header.stamp.to_sec()
        with self.lock:
            if not self.passes or stamp < self.passes[-1].images[-1]:
                self.passes.append(Pass())
            self.passes[-1].images.append(stamp)

    def receive_odometry(self, message):
        stamp, position = message.header.stamp.to_sec(), message.pose.pose.position
        with self.lock:
            self.odometry_pass += stamp < self.last_odometry
            self.last_odometry = stamp
            if self.odometry_pass < len(self.passes):
                one = self.passes[self.odometry_pass]
                one.first_odometry = one.first_odometry or time.monotonic()
                one.odometry[stamp] = (position.x, position.y, position.z)

    def receive_motion(self, message):
        stamp = message.header.stamp.to_sec()
        with self.lock:
            self.motion_pass += stamp < self.last_motion
            self.last_motion = stamp
            if self.motion_pass < len(self.passes):
                self.passes[self.motion_pass].epochs.append(message.odom_epoch)

    def receive_truth(self, message):
        position = message.pose.pose.position
        self.truth[message.header.stamp.to_sec()] = (position.x, position.y, position.z)

    def test_goes_on_in_each_pass(self):
        end = time.monotonic() + 100.0
        while len(self.passes) <= PASSES and time.monotonic() < end:
            time.sleep(0.1)
        for subscriber in self.subscribers:
            subscriber.unregister()
        self.assertGreater(len(self.passes), PASSES, "the bag did not play")
        truth = np.array([(stamp, *self.truth[stamp]) for stamp in sorted(self.truth)])
        for number, one in enumerate(self.passes[:PASSES]):
            self.assertIsNotNone(one.first_odometry, f"no odometry in pass {number}")
            delay = one.first_odometry - one.begin
            print(f"pass {number}: {len(one.images)} images, {len(one.odometry)} poses, the first after {delay:.2f} s, "
                  f"ATE {1e3 * one.ate(truth):.1f} mm")
            self.assertLess(delay, 0.5, f"pass {number}")
            self.assertGreaterEqual(len(one.odometry), 0.9 * len(one.images), f"silent in pass {number}")
            self.assertGreater(max(one.odometry), one.images[-1] - 0.2, f"silent at the end of pass {number}")
            self.assertLess(one.ate(truth), max(0.02, 1.5 * self.passes[0].ate(truth)), f"pass {number}")
            self.assertEqual(set(one.epochs), {number}, f"epochs of pass {number}")


if __name__ == "__main__":
    rospy.init_node("test_bag_loop")
    rostest.rosrun("multicam_egomotion", "bag_loop", BagLoop)
