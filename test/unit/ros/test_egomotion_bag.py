#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
"""egomotion_bag when it is interrupted and when the disk is full: complete files, or a clear error.

test_egomotion_bag.py EGOMOTION_BAG RECORDING (its path without .bag); the number of signals is that of the
environment's MULTICAM_EGOMOTION_SIGNALS.
"""

import json
import os
import pathlib
import random
import resource
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import rosbag

EXECUTABLE, RECORDING = sys.argv[1:3] if len(sys.argv) > 2 else ("", "")
SIGNALS = int(os.environ.get("MULTICAM_EGOMOTION_SIGNALS", "5"))


def catches_sigterm(pid):
    for line in pathlib.Path(f"/proc/{pid}/status").read_text().splitlines():
        if line.startswith("SigCgt:"):
            return bool(int(line.split()[1], 16) >> (signal.SIGTERM - 1) & 1)
    return False


class EgoMotionBag(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.short = os.path.join(cls.folder.name, "short.bag")
        with rosbag.Bag(RECORDING + ".bag") as bag, rosbag.Bag(cls.short, "w") as short:
            begin = bag.get_start_time()
            for topic, message, stamp in bag.read_messages(topics=["/cam0/image_raw", "/cam1/image_raw", "/imu"]):
                if stamp.to_sec() - begin > 1.0:
                    break
                short.write(topic, message, stamp)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def command(self, bag, **outputs):
        options = [word for name, path in outputs.items() for word in ("--" + name.replace("_", "-"), path)]
        return [EXECUTABLE, "--bag", bag, "--rig", RECORDING + ".rig.yaml", *options]

    def test_signals_at_random_times_leave_complete_files(self):
        randomness = random.Random(1)
        outputs = {"trajectory": self.path("out.tum"), "kitti": self.path("out.txt"), "report": self.path("out.json"),
                   "output_bag": self.path("out.bag")}
        begin = time.monotonic()
        subprocess.run(self.command(RECORDING + ".bag", **outputs), stdout=subprocess.DEVNULL, check=True, timeout=120)
        whole_run = time.monotonic() - begin
        poses, interrupted = 0, 0
        for number in range(SIGNALS):
            for path in outputs.values():
                pathlib.Path(path).unlink(missing_ok=True)
            process = subprocess.Popen(self.command(RECORDING + ".bag", **outputs), stdout=subprocess.DEVNULL,
                                       stderr=subprocess.PIPE, text=True)
            while process.poll() is None and not catches_sigterm(process.pid):
                time.sleep(0.001)
            time.sleep(randomness.uniform(0.0, 0.8 * whole_run))
            begin = time.monotonic()
            process.send_signal((signal.SIGINT, signal.SIGTERM)[number % 2])
            _, errors = process.communicate(timeout=20)
            seconds = time.monotonic() - begin
            self.assertEqual(process.returncode, 0, errors)
            starved = os.getloadavg()[0] > os.cpu_count()
            self.assertLess(seconds, 5.0 if starved else 1.0)
            report = json.loads(pathlib.Path(outputs["report"]).read_text())
            self.assertEqual(report["interrupted"], "interrupted" in errors, errors)
            interrupted += report["interrupted"]  # on a machine whose load changes, a run may end before its signal
            trajectory = pathlib.Path(outputs["trajectory"]).read_text()
            self.assertEqual(trajectory.count("\n"), report["poses"])
            self.assertTrue(all(len(line.split()) == 8 for line in trajectory.splitlines()))
            kitti = pathlib.Path(outputs["kitti"]).read_text()
            self.assertTrue(all(len(line.split()) == 12 for line in kitti.splitlines()))
            with rosbag.Bag(outputs["output_bag"]) as bag:
                self.assertGreaterEqual(bag.get_message_count(topic_filters=["odometry"]), report["poses"])
            poses += report["poses"]
        self.assertGreater(poses, 0)
        self.assertGreater(interrupted, SIGNALS / 2)

    def expect_failure(self, path, reason, limit=None, **outputs):
        def limit_files():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
        done = subprocess.run(self.command(self.short, **outputs), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                              text=True, timeout=60, preexec_fn=limit_files if limit else None)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn(f"egomotion_bag: '{path}'", done.stderr)
        self.assertIn(reason, done.stderr)

    def test_full_disk_is_said(self):
        for output in ("trajectory", "kitti", "report"):
            with self.subTest(output):
                self.expect_failure("/dev/full", "No space left on device", **{output: "/dev/full"})

    def test_files_that_cannot_grow(self):
        for output, limit in (("trajectory", 500), ("output_bag", 3000), ("output_bag", 20000)):
            with self.subTest(output, limit=limit):
                path = self.path("limited")
                self.expect_failure(path, "File too large", limit, **{output: path})

    def test_a_folder_that_does_not_exist(self):
        for output in ("trajectory", "kitti", "output_bag", "report"):
            with self.subTest(output):
                self.expect_failure("/does/not/exist", "No such file or directory", **{output: "/does/not/exist"})


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
