#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
"""egomotion_bag: what it says and writes of the calibration; complete files, or a clear error, when it is interrupted
and when the disk is full.

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

import numpy as np
import rosbag
import yaml

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "scripts"))
import rig_variants  # noqa: E402
import rotations  # noqa: E402

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

    def command(self, bag, **options):
        options = {"rig": RECORDING + ".rig.yaml", **options}
        words = [word for name, path in options.items() if path for word in ("--" + name.replace("_", "-"), path)]
        return [EXECUTABLE, "--bag", bag, *words]

    def run_and_report(self, bag, **options):
        """Runs to the end; the report, and what was printed."""
        report = self.path("report.json")
        done = subprocess.run(self.command(bag, report=report, **options), stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True, timeout=120)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(pathlib.Path(report).read_text()), done.stdout

    def write(self, name, content):
        path = self.path(name)
        pathlib.Path(path).write_text(yaml.safe_dump(content))
        return path

    def test_a_turned_camera_is_turned_back(self):
        truth = rig_variants.read_rig(pathlib.Path(RECORDING + ".rig.yaml"))
        given, written, output_bag = self.path("turned.yaml"), self.path("written.yaml"), self.path("calibrated.bag")
        rig_variants.write_turned(pathlib.Path(given), truth, 1, "y", 0.3)
        report, text = self.run_and_report(RECORDING + ".bag", rig=given, write_rig=written, output_bag=output_bag)

        (camera,) = report["calibration"]
        self.assertEqual(camera["camera"], "cam1")
        np.testing.assert_allclose(camera["rotation_deg"], [0.0, -0.3, 0.0], atol=0.03)
        self.assertTrue(all(0.0 < sigma < 0.03 for sigma in camera["sigma_deg"]))
        self.assertLess(abs(camera["focal_length_percent"]), 0.1)
        self.assertLess(camera["static_error_px"], 0.1)
        self.assertEqual(report["messages"], [])
        self.assertIn("cam1 turned by ", text)

        result, given_rig = (rig_variants.read_rig(pathlib.Path(path)) for path in (written, given))
        true_pose, pose = (np.array(rig["cameras"][1]["T_body_cam"]) for rig in (truth, result))
        error = rotations.log(true_pose[:3, :3].T @ pose[:3, :3])
        self.assertLess(np.degrees(np.linalg.norm(error)), 0.03)
        self.assertEqual(pose[:3, 3].tolist(), true_pose[:3, 3].tolist())
        sigmas = result["cameras"][1]["sigmas"]
        self.assertGreaterEqual(sigmas["rotation_deg"], max(0.005, 0.999 * max(camera["sigma_deg"])))
        self.assertLess(sigmas["rotation_deg"], 0.03)
        np.testing.assert_allclose(result["cameras"][0]["T_body_cam"], truth["cameras"][0]["T_body_cam"], atol=1e-12)
        changed = {"T_body_cam", "sigmas"}
        for before, after in zip(given_rig["cameras"], result["cameras"]):
            self.assertEqual({key: value for key, value in before.items() if key not in changed},
                             {key: value for key, value in after.items() if key not in changed})
        self.assertEqual(given_rig["cameras"][0]["sigmas"], result["cameras"][0]["sigmas"])

        with rosbag.Bag(output_bag) as bag:
            messages = [message for _, message, _ in bag.read_messages(topics=["calibration"])]
        stamps = [message.header.stamp.to_sec() for message in messages]
        self.assertEqual(len(messages), 5)  # of 4 s
        self.assertTrue(all(later - earlier >= 1.0 for earlier, later in zip(stamps, stamps[1:])))
        rotation = messages[-1].cameras[0].rotation
        np.testing.assert_allclose(np.degrees([rotation.x, rotation.y, rotation.z]), [0.0, -0.3, 0.0], atol=0.03)
        self.assertTrue(messages[-1].cameras[0].overlaps)

        report, _ = self.run_and_report(self.short, rig=written)
        np.testing.assert_allclose(report["calibration"][0]["rotation_deg"], 0.0, atol=0.03)

    def test_a_rig_without_calibration_is_copied(self):
        rig = rig_variants.read_rig(pathlib.Path(RECORDING + ".rig.yaml"))
        one_camera = self.write("one_camera.yaml", {**rig, "cameras": rig["cameras"][:1]})
        fixed = self.write("fixed_config.yaml", {"calibrate_online": False})
        for name, options in (("one camera", {"rig": one_camera}), ("switched off", {"config": fixed})):
            with self.subTest(name):
                copy, again = self.path("copy.yaml"), self.path("again.yaml")
                output_bag = self.path("copy.bag")
                report, text = self.run_and_report(self.short, write_rig=copy, output_bag=output_bag, **options)
                self.assertEqual(report["calibration"], [])
                self.assertNotIn("turned by", text)
                with rosbag.Bag(output_bag) as bag:
                    self.assertEqual(bag.get_message_count(topic_filters=["calibration"]), 0)
                self.run_and_report(self.short, write_rig=again, **{**options, "rig": copy})
                before, after = (rig_variants.read_rig(pathlib.Path(path)) for path in
                                 (options.get("rig", RECORDING + ".rig.yaml"), again))
                for one, other in zip(before["cameras"], after["cameras"]):
                    np.testing.assert_allclose(one.pop("T_body_cam"), other.pop("T_body_cam"), atol=1e-12)
                np.testing.assert_allclose(before["imu"].pop("T_body_imu"), after["imu"].pop("T_body_imu"), atol=1e-12)
                self.assertEqual(before, after)

    def test_the_rig_of_camera_info_and_tf_is_written(self):
        written = self.path("from_topics.yaml")
        self.run_and_report(RECORDING + ".bag", rig=None, write_rig=written)
        truth = rig_variants.read_rig(pathlib.Path(RECORDING + ".rig.yaml"))
        result = rig_variants.read_rig(pathlib.Path(written))
        for camera, (one, other) in enumerate(zip(truth["cameras"], result["cameras"])):
            np.testing.assert_allclose(one["T_body_cam"], other["T_body_cam"], atol=1e-3 if camera else 1e-9)
            self.assertEqual(other["image_topic"], f"/cam{camera}/image_raw")
        report, _ = self.run_and_report(self.short, rig=written)
        self.assertGreater(report["poses"], 10)

    def test_the_rig_that_is_read_is_not_overwritten(self):
        rig = pathlib.Path(self.path("read.yaml"))
        rig.write_text(pathlib.Path(RECORDING + ".rig.yaml").read_text())
        link = pathlib.Path(self.path("link.yaml"))
        link.symlink_to(rig)
        done = subprocess.run(self.command(self.short, rig=str(rig), write_rig=str(link)), stderr=subprocess.PIPE,
                              text=True, timeout=60)
        self.assertEqual(done.returncode, 1)
        self.assertIn(f"--write-rig: found '{link}', which this run reads, expected another file", done.stderr)
        self.assertEqual(rig.read_text(), pathlib.Path(RECORDING + ".rig.yaml").read_text())

    def test_messages_tell_what_was_wrong_at_the_end(self):
        one_eyed = self.path("one_eyed.bag")
        with rosbag.Bag(self.short) as short, rosbag.Bag(one_eyed, "w") as bag:
            begin = short.get_start_time()
            for topic, message, stamp in short.read_messages():
                if topic != "/cam1/image_raw" or stamp.to_sec() - begin < 0.7:
                    bag.write(topic, message, stamp)
        report, text = self.run_and_report(one_eyed)
        self.assertEqual(report["messages"], ["no images of cam1"])
        self.assertIn("at the end: no images of cam1", text)

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
        for output in ("trajectory", "kitti", "report", "write_rig"):
            with self.subTest(output):
                self.expect_failure("/dev/full", "No space left on device", **{output: "/dev/full"})

    def test_files_that_cannot_grow(self):
        for output, limit in (("trajectory", 500), ("output_bag", 3000), ("output_bag", 20000)):
            with self.subTest(output, limit=limit):
                path = self.path("limited")
                self.expect_failure(path, "File too large", limit, **{output: path})

    def test_a_folder_that_does_not_exist(self):
        for output in ("trajectory", "kitti", "output_bag", "report", "write_rig"):
            with self.subTest(output):
                self.expect_failure("/does/not/exist", "No such file or directory", **{output: "/does/not/exist"})


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
