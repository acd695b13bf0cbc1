#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
"""A minute's closed loop (egomotion_sim loop) played live for long: memory and latency stay, warnings do not pile up.

test_soak.py LOOP.bag SECONDS
"""

import math
import sys
import time
import unittest
import xmlrpc.client

import numpy as np
import rosbag
import rosgraph
import rospy
import rostest
from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Log

BAG, DURATION = sys.argv[1:3] if len(sys.argv) > 2 else ("", "0")
NS = 1_000_000_000
LAP_NS = 60 * NS
NODE = "/egomotion"


def memory_mb(pid):
    """Memory of a process that is no file's."""
    with open(f"/proc/{pid}/status") as status:
        return next(int(line.split()[1]) for line in status if line.startswith("RssAnon:")) / 1024.0


class Soak(unittest.TestCase):
    def setUp(self):
        self.latencies, self.positions, self.warnings = [], {}, []
        rospy.Subscriber("odometry", Odometry, self.note_odometry, queue_size=100)
        rospy.Subscriber("/rosout", Log, self.note_log, queue_size=100)
        self.pid = self.pid_of_node(30.0)

    def pid_of_node(self, patience_s):
        master = rosgraph.Master("/soak")
        deadline = time.monotonic() + patience_s
        while True:
            try:
                return xmlrpc.client.ServerProxy(master.lookupNode(NODE)).getPid("/soak")[2]
            except (OSError, rosgraph.MasterError):  # not started yet
                self.assertLess(time.monotonic(), deadline, f"{NODE} has not started within {patience_s} s")
                time.sleep(0.2)

    def note_odometry(self, message):
        now_ns = rospy.Time.now().to_nsec()
        p = message.pose.pose.position
        self.latencies.append((now_ns, 1e-6 * (now_ns - message.header.stamp.to_nsec())))
        self.positions[message.header.stamp.to_nsec()] = (p.x, p.y, p.z)

    def note_log(self, message):
        if message.level >= Log.WARN and message.name == NODE:
            self.warnings.append(message.msg)

    def messages(self, publishers, end_ns):
        """(nanoseconds since the start, publisher, message) of lap after lap."""
        lap = 0
        while True:
            with rosbag.Bag(BAG) as bag:
                begin_ns = next(bag.read_messages("/cam0/image_raw"))[1].header.stamp.to_nsec()
                for topic, message, _ in bag.read_messages(list(publishers)):
                    since_ns = message.header.stamp.to_nsec() - begin_ns
                    if not 0 <= since_ns < LAP_NS:
                        continue
                    if lap * LAP_NS + since_ns > end_ns:
                        return
                    yield lap * LAP_NS + since_ns, publishers[topic], message
            lap += 1

    def play(self, seconds):
        """Memory [(ns, MB)] and image stamps while playing."""
        with rosbag.Bag(BAG) as bag:
            types = bag.get_type_and_topic_info().topics
            kinds = {topic: type(next(bag.read_messages(topic))[1])
                     for topic in types if topic == "/imu" or topic.endswith("image_raw")}
        publishers = {topic: rospy.Publisher(topic, kind, queue_size=20)
                      for topic, kind in kinds.items()}
        while any(publisher.get_num_connections() == 0 for publisher in publishers.values()):
            time.sleep(0.1)
        start_ns = rospy.Time.now().to_nsec()
        memory, stamps = [], []
        for since_ns, publisher, message in self.messages(publishers, int(seconds * NS)):
            stamp_ns = start_ns + since_ns
            time.sleep(max(0.0, 1e-9 * (stamp_ns - rospy.Time.now().to_nsec())))
            message.header.stamp = rospy.Time(*divmod(stamp_ns, NS))
            publisher.publish(message)
            if publisher.name == "/cam0/image_raw":
                stamps.append(stamp_ns)
            if not memory or stamp_ns - memory[-1][0] > NS:
                memory.append((stamp_ns, memory_mb(self.pid)))
        time.sleep(1.0)
        return memory, stamps

    def test_nothing_grows(self):
        seconds = float(DURATION)
        memory, stamps = self.play(seconds)
        begin_ns, end_ns = stamps[0], stamps[-1]

        def quarter(samples, index):
            share = [4 * (stamp - begin_ns) / (end_ns - begin_ns) for stamp, _ in samples]
            return np.array([value for (_, value), q in zip(samples, share) if index <= q < index + 1])

        for index in range(4):
            latency = quarter(self.latencies, index)
            print(f"quarter {index + 1}: memory {quarter(memory, index).mean():.2f} MB, latency median "
                  f"{np.median(latency):.1f} ms, p99 {np.quantile(latency, 0.99):.1f} ms, {len(latency)} poses")
        laps = [math.dist(self.positions[stamp], self.positions[stamp + LAP_NS])
                for stamp in self.positions if stamp + LAP_NS in self.positions]
        if laps:
            print(f"distance between places a lap apart: median {np.median(laps):.3f} m")
        print(f"{len(self.warnings)} warnings" + "".join(f"\n  {text}" for text in self.warnings[:20]))

        self.assertGreater(len(self.latencies), 0.98 * len(stamps))
        self.assertLess(quarter(memory, 3).mean(), 1.02 * quarter(memory, 1).mean())
        self.assertLess(np.quantile(quarter(self.latencies, 3), 0.99),
                        1.25 * np.quantile(quarter(self.latencies, 1), 0.99) + 5.0)
        self.assertLess(len(self.warnings), 3 + seconds / 60)


if __name__ == "__main__":
    rospy.init_node("soak")
    rostest.rosrun("multicam_egomotion", "soak", Soak)
