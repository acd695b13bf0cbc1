#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
"""What only a running node meets: missing inputs, other nodes that publish the same, overload, signals.

The number of signals is that of the environment's MULTICAM_EGOMOTION_SIGNALS.
"""

import os
import random
import signal
import socket
import struct
import subprocess
import sys
import time
import unittest
import xmlrpc.client

import rosgraph
import rospy
import rostest
from egomotion_process import EgoMotionProcess, wait_for
from geometry_msgs.msg import TransformStamped
from multicam_egomotion.msg import EgoMotion
from nav_msgs.msg import Odometry
from sensor_msgs.msg import CameraInfo, Image, Imu
from tf2_msgs.msg import TFMessage

BAG, RIG = sys.argv[1:3] if len(sys.argv) > 2 else ("", "")
RATE = float(sys.argv[3]) if len(sys.argv) > 3 else 1.0
SIGNALS = int(os.environ.get("MULTICAM_EGOMOTION_SIGNALS", "5"))


def play(*arguments):
    topics = ["--topics", "/cam0/image_raw", "/cam1/image_raw", "/imu"]
    return subprocess.Popen(["rosbag", "play", "--quiet", "--clock", *arguments, "--bags", BAG, *topics],
                            stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)


def stop(process):
    process.terminate()
    process.wait()


def camera_info(frame, focal_length=300.0):
    info = CameraInfo(width=640, height=480, distortion_model="plumb_bob", D=[0.0] * 5)
    info.header.frame_id = frame
    info.K = [focal_length, 0, 320, 0, focal_length, 240, 0, 0, 1 if focal_length > 0 else 0]
    return info


def transform(parent, child):
    one = TransformStamped()
    one.header.frame_id, one.child_frame_id = parent, child
    one.header.stamp = rospy.Time(1)
    one.transform.rotation.w = 1.0
    return one


def deaf_subscriber(topic):
    """Subscribes, and never reads what is sent."""
    master = rosgraph.Master("/deaf")
    publisher = xmlrpc.client.ServerProxy(master.lookupNode(dict_of_publishers(master)[topic]))
    _, _, (_, host, port) = publisher.requestTopic("/deaf", topic, [["TCPROS"]])
    connection = socket.socket()
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    connection.connect((host, port))
    fields = [f.encode() for f in ("callerid=/deaf", f"topic={topic}", "type=*", "md5sum=*", "tcp_nodelay=1")]
    header = b"".join(struct.pack("<I", len(field)) + field for field in fields)
    connection.sendall(struct.pack("<I", len(header)) + header)
    return connection


def dict_of_publishers(master):
    return {topic: nodes[0] for topic, nodes in master.getSystemState()[0]}


class LiveFaults(unittest.TestCase):
    def node(self, parameters=None):
        node = EgoMotionProcess(self.id().rsplit(".", 1)[-1], parameters)
        self.addCleanup(node.end)
        return node

    def latched(self, topic, message):
        publisher = rospy.Publisher(topic, type(message), queue_size=1, latch=True)
        publisher.publish(message)
        self.addCleanup(publisher.unregister)

    def test_says_what_is_missing(self):
        node = self.node({"cameras": 2})
        space = node.name.rsplit("/", 1)[0]
        for camera in (0, 1):
            missing = f"CameraInfo on {space}/cam{camera}/camera_info (no publisher)"
            self.assertTrue(node.logs(missing), node.log())
            self.assertTrue(node.logs(f"{space}/cam{camera}/image_raw (never, no publisher)"), node.log())
            self.assertTrue(node.says(missing), node.summary)
        self.assertTrue(node.logs(f"{space}/imu (never, no publisher)"), node.log())
        self.assertTrue(node.says(f"no data on {space}/cam0/image_raw (never, no publisher)"), node.summary)

        for camera in (0, 1):
            self.latched(f"{space}/cam{camera}/camera_info", camera_info(f"optical{camera}"))
        sample = Imu()
        sample.header.frame_id = "imu_link"
        self.latched(f"{space}/imu", sample)
        frames = "waiting for TF base_link -> optical0, TF base_link -> optical1, TF base_link -> imu_link"
        self.assertTrue(node.says(frames), node.summary)
        self.assertTrue(node.logs(frames), node.log())
        self.assertGreaterEqual(node.log().count("waiting for CameraInfo"), 2, "said once only")

        mounting = [transform("base_link", f"optical{camera}") for camera in (0, 1)]
        mounting[1].transform.translation.x = 0.1
        self.latched("/tf_static", TFMessage(mounting + [transform("base_link", "imu_link")]))
        self.assertTrue(node.says("waiting for data"), node.summary)

    def test_uncalibrated_camera_ends_the_node(self):
        node = self.node({"cameras": 1, "use_imu": False})
        space = node.name.rsplit("/", 1)[0]
        self.latched(f"{space}/cam0/camera_info", camera_info("base_link", focal_length=0.0))
        self.assertTrue(wait_for(lambda: node.process.poll() is not None, 15.0), node.log())
        self.assertEqual(node.process.returncode, 1)
        self.assertIn("found K[0] = 0, expected a calibrated camera", node.log())

    def test_names_another_publisher_of_the_transform(self):
        node = self.node({"rig_file": RIG})
        self.assertTrue(node.says("waiting for data"), node.summary)
        publisher = rospy.Publisher("/tf", TFMessage, queue_size=1)
        self.addCleanup(publisher.unregister)
        conflict = f"TF map -> base_link comes from {rospy.get_name()} too"

        def publish_until_said():
            publisher.publish(TFMessage([transform("map", "base_link"), transform("base_link", "lidar")]))
            time.sleep(0.1)
            return conflict in node.summary
        self.assertTrue(wait_for(publish_until_said, 10.0), node.summary)
        self.assertTrue(node.logs(conflict), node.log())
        self.assertTrue(wait_for(lambda: conflict not in node.summary, 10.0), node.summary)

    def test_unusable_stamps_are_said(self):
        node = self.node({"rig_file": RIG})
        publishers = [rospy.Publisher(f"/cam{camera}/image_raw", Image, queue_size=5) for camera in (0, 1)]
        publishers.append(rospy.Publisher("/imu", Imu, queue_size=5))
        for publisher in publishers:
            self.addCleanup(publisher.unregister)
        image = Image(width=640, height=480, step=640, encoding="mono8", data=bytes(640 * 480))

        def publish_until_said():
            for publisher in publishers:
                publisher.publish(image if publisher.type == "sensor_msgs/Image" else Imu())
            time.sleep(0.1)
            return "no new frame, although data arrive" in node.log()
        self.assertTrue(wait_for(publish_until_said, 15.0), node.log())
        for key in ("rejected images", "rejected IMU samples"):
            self.assertTrue(wait_for(lambda key=key: int(node.values.get(key, 0)) > 0, 5.0), node.values)

    def test_overload_and_a_subscriber_that_does_not_read(self):
        node = self.node({"rig_file": RIG, "tracker/features_per_camera": 800, "tracker/min_distance_px": 4})
        self.assertTrue(node.says("waiting for data"), node.summary)
        space = node.name.rsplit("/", 1)[0]
        deaf = [deaf_subscriber(f"{space}/{topic}") for topic in ("odometry", "features", "points")]
        images, poses, worked = [], [], []
        subscribers = [
            rospy.Subscriber("/cam0/image_raw", Image, lambda m: images.append(m.header.stamp.to_sec()),
                             queue_size=1000, buff_size=1 << 24),
            rospy.Subscriber(f"{space}/odometry", Odometry, lambda m: poses.append(m.header.stamp.to_sec()),
                             queue_size=1000),
            rospy.Subscriber(f"{space}/ego_motion", EgoMotion,
                             lambda m: m.status != EgoMotion.COASTING and worked.append(m.header.stamp.to_sec()),
                             queue_size=1000)]
        player = play("--rate", str(4 * RATE), "--wait-for-subscribers")
        self.assertEqual(player.wait(60), 0)
        time.sleep(2.0)
        for connection in deaf:
            connection.close()
        for subscriber in subscribers:
            subscriber.unregister()
        dropped = int(node.values["dropped images"])
        print(f"overload: {len(images)} images of cam0, {len(worked)} worked, {len(poses)} poses, {dropped} images of "
              f"both dropped, worst latency {node.worst_latency_ms:.0f} ms")
        self.assertGreater(dropped, 10)
        self.assertGreater(len(worked), 2)
        self.assertGreaterEqual(len(poses), len(worked))
        self.assertGreater(max(worked), max(images) - 0.2, "the newest images were not worked")
        # Images that are not dropped would wait for as long as they are played, 1 s / RATE, and 2 s.
        self.assertLess(node.worst_latency_ms, 2500.0 + 500.0 / RATE)
        self.assertEqual(int(node.values["internal errors"]), 0)

    def test_signals_at_random_times(self):
        player = play("--loop")
        self.addCleanup(stop, player)
        randomness, taken = random.Random(1), []
        for number in range(SIGNALS):
            node = EgoMotionProcess("signals", {"rig_file": RIG})
            self.assertTrue(wait_for(node.catches_signals, 10.0))
            time.sleep(randomness.uniform(0.0, 1.5))
            which = (signal.SIGINT, signal.SIGTERM)[number % 2]
            code, seconds = node.end(which)
            self.assertEqual(code, 0, f"signal {number}, {which.name}:\n{node.log()}")
            starved = os.getloadavg()[0] > os.cpu_count()
            self.assertLess(seconds, 5.0 if starved else 1.0, f"signal {number}, {which.name}:\n{node.log()}")
            taken.append(seconds)
        print(f"signals: {SIGNALS} clean exits, median {sorted(taken)[SIGNALS // 2]:.2f} s, worst {max(taken):.2f} s")


if __name__ == "__main__":
    rospy.init_node("test_live_faults")
    rostest.rosrun("multicam_egomotion", "live_faults", LiveFaults)
