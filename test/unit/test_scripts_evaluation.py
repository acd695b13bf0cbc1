# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
"""Tests of evaluate.py and of the trajectory files and rotations under it, on made-up trajectories."""

import json
import pathlib
import tempfile
import unittest

import genpy.dynamic
import numpy as np
import rosbag
import rospy
from geometry_msgs.msg import PoseWithCovariance, Vector3
from nav_msgs.msg import Odometry
from std_msgs.msg import Header

from scripts_test_case import EPOCH_NS, PACKAGE, TemporaryDirectoryTest, run, winding_trajectory

import evaluate
import rotations
import trajectory_errors
from trajectory_io import NS, Trajectory, read_trajectory, write_tum


class RotationsTest(unittest.TestCase):
    def test_round_trips(self):
        vectors = np.random.default_rng(1).normal(size=(200, 3))
        vectors *= np.minimum(1.0, 3.1 / np.linalg.norm(vectors, axis=1, keepdims=True))
        vectors[0] = 0.0
        vectors[1] = [1e-12, 0.0, 0.0]
        vectors[2] = [np.pi - 1e-7, 0.0, 0.0]
        np.testing.assert_allclose(rotations.log(rotations.exp(vectors)), vectors, atol=1e-9)

    def test_slerp_is_half_way(self):
        a, b = rotations.exp([[0.1, 0.2, 0.3]]), rotations.exp([[0.5, -0.2, 1.0]])
        half = rotations.slerp(a, b, np.array([0.5]))
        np.testing.assert_allclose(trajectory_errors.rotation_angle(a, half),
                                   trajectory_errors.rotation_angle(half, b), atol=1e-12)


class TrajectoryFilesTest(TemporaryDirectoryTest):
    def test_tum_keeps_nanoseconds(self):
        truth = winding_trajectory(count=20)
        write_tum(self.dir / "a.tum", truth)
        again = read_trajectory(self.dir / "a.tum", "odometry")
        np.testing.assert_array_equal(again.stamps_ns, truth.stamps_ns)
        np.testing.assert_allclose(again.rotations, truth.rotations, atol=1e-8)

    def test_unknown_format_is_refused(self):
        (self.dir / "a.txt").write_text("1 2 3\n")
        code, _, err = run(evaluate.main, self.dir / "a.txt", self.dir / "a.txt")
        self.assertEqual(code, 1)
        self.assertIn("found 3 columns, expected 8 (TUM) or 12 (KITTI)", err)


class EvaluateTest(unittest.TestCase):
    def setUp(self):
        self.truth = winding_trajectory()

    def moved(self, R, scale=1.0, t=(3.0, -2.0, 1.0)):
        return Trajectory(scale * self.truth.positions @ R.T + t, R @ self.truth.rotations, self.truth.stamps_ns)

    def test_each_alignment_removes_its_freedoms(self):
        zero = dict(delta=1e-9)
        yawed = evaluate.evaluate(self.truth, self.moved(rotations.exp([0.0, 0.0, 2.0])))["ate"]
        for kind in ("position_yaw", "se3", "sim3"):
            self.assertAlmostEqual(yawed[kind]["rmse_m"], 0.0, **zero)
        tilted = evaluate.evaluate(self.truth, self.moved(rotations.exp([0.2, 0.1, 1.0])))["ate"]
        self.assertGreater(tilted["position_yaw"]["rmse_m"], 0.1)
        self.assertAlmostEqual(tilted["se3"]["rmse_m"], 0.0, **zero)
        scaled = evaluate.evaluate(self.truth, self.moved(np.eye(3), scale=1.25))["ate"]
        self.assertGreater(scaled["se3"]["rmse_m"], 0.1)
        self.assertAlmostEqual(scaled["sim3"]["rmse_m"], 0.0, **zero)
        self.assertAlmostEqual(scaled["sim3"]["scale"], 0.8, **zero)

    def test_relative_errors_of_a_scaled_straight_line(self):
        t = np.arange(2400) / 20.0
        truth = Trajectory(np.outer(t, [1.0, 0.0, 0.0]), np.tile(np.eye(3), (t.size, 1, 1)),
                           EPOCH_NS + np.round(t * NS).astype(np.int64))
        estimate = Trajectory(1.02 * truth.positions, truth.rotations, truth.stamps_ns)
        segments = {s["over"]: s for s in trajectory_errors.relative_errors(truth, estimate)}
        self.assertEqual(list(segments), ["0.5 s", "1 m", "5 m", "10 m", "50 m", "100 m"])
        self.assertAlmostEqual(segments["0.5 s"]["translation_median_m"], 0.01, places=6)
        self.assertAlmostEqual(segments["100 m"]["drift_percent"], 2.0, delta=0.02)
        frames = trajectory_errors.frame_to_frame_errors(truth, estimate)
        self.assertAlmostEqual(frames["straight_ahead_median_deg"], 0.0)

    def test_percent_only_on_long_paths(self):
        long = evaluate.evaluate(self.truth, self.truth)
        self.assertIn("percent_of_path", long["ate"]["se3"])
        short = self.truth.select(slice(0, 40))
        self.assertNotIn("percent_of_path", evaluate.evaluate(short, short)["ate"]["se3"])

    def test_frame_to_frame_angles(self):
        wrong = Trajectory(self.truth.positions, self.truth.rotations.copy(), self.truth.stamps_ns)
        wrong.rotations[1::2] = wrong.rotations[1::2] @ rotations.exp([0.0, 0.0, np.radians(0.1)])
        frames = trajectory_errors.frame_to_frame_errors(self.truth, wrong)
        self.assertAlmostEqual(frames["rotation_median_deg"], 0.1, places=6)
        still = Trajectory(np.zeros((5, 3)), np.tile(np.eye(3), (5, 1, 1)), self.truth.stamps_ns[:5])
        frames = trajectory_errors.frame_to_frame_errors(still, still)
        self.assertEqual(frames["standing_frames"], 4)
        self.assertNotIn("direction_median_deg", frames)
        no_motion = Trajectory(still.positions, still.rotations, still.stamps_ns)
        frames = trajectory_errors.frame_to_frame_errors(self.truth.select(slice(0, 5)), no_motion)
        self.assertAlmostEqual(frames["direction_median_deg"], 90.0)

    def test_interpolates_between_ground_truth_stamps_but_not_over_gaps(self):
        dense, sparse = winding_trajectory(), winding_trajectory().select(slice(0, None, 2))
        report = evaluate.evaluate(sparse, dense)
        self.assertEqual((report["poses"], report["unmatched_poses"]), (399, 1))
        self.assertLess(report["ate"]["position_yaw"]["rmse_m"], 1e-3)
        gap = dense.select(np.r_[0:100, 140:400])
        self.assertEqual(evaluate.evaluate(gap, dense)["unmatched_poses"], 40)

    def test_kitti_files_are_matched_by_line_with_y_down(self):
        with tempfile.TemporaryDirectory() as directory:
            path, report = pathlib.Path(directory) / "a.txt", pathlib.Path(directory) / "r.json"
            matrices = np.concatenate([self.truth.rotations, self.truth.positions[:, :, None]], axis=2)
            np.savetxt(path, matrices.reshape(-1, 12))
            turned = rotations.exp([0.0, 1.0, 0.0])  # about y, the vertical
            np.savetxt(path.with_name("b.txt"), (turned @ matrices).reshape(-1, 12))
            self.assertEqual(run(evaluate.main, path, path.with_name("b.txt"), "--json", report)[0], 0)
            self.assertLess(json.loads(report.read_text())["ate"]["position_yaw"]["rmse_m"], 1e-9)
            np.savetxt(path.with_name("c.txt"), matrices[:-1].reshape(-1, 12))
            code, _, err = run(evaluate.main, path, path.with_name("c.txt"))
            self.assertEqual(code, 1)
            self.assertIn("found 399 poses in the estimate, expected 400", err)


class ConsistencyTest(TemporaryDirectoryTest):
    """A bag whose errors are drawn from its own covariances must be found honest, and a boastful one not."""

    def setUp(self):
        super().setUp()
        self.truth = winding_trajectory(count=1500, rate_hz=50.0)
        write_tum(self.dir / "truth.tum", self.truth)

    def ego_motion_class(self):
        separator = "\n" + "=" * 80 + "\nMSG: "
        text = (PACKAGE / "msg" / "EgoMotion.msg").read_text()
        for name, message in (("std_msgs/Header", Header), ("geometry_msgs/Vector3", Vector3)):
            text += separator + name + "\n" + message._full_text
        text += separator + "geometry_msgs/PoseWithCovariance\n" + PoseWithCovariance._full_text
        return genpy.dynamic.generate_dynamic("multicam_egomotion/EgoMotion", text)["multicam_egomotion/EgoMotion"]

    def odometry(self, stamp_ns, position, rotation, covariance):
        message = Odometry()
        message.header.stamp = rospy.Time(*divmod(int(stamp_ns), NS))
        p, q = message.pose.pose.position, message.pose.pose.orientation
        p.x, p.y, p.z = position
        q.x, q.y, q.z, q.w = rotations.quaternion_from_matrix(rotation)
        message.pose.covariance = covariance.ravel().tolist()
        return message

    def write_estimate(self, boast):
        """Errors of sigma; covariances of sigma / boast. Every tenth frame calls its scale unobservable."""
        random = np.random.default_rng(3)
        EgoMotion = self.ego_motion_class()
        half = np.random.default_rng(4).normal(size=(6, 6)) * 1e-3
        C = half @ half.T + 1e-8 * np.eye(6)
        sum_error, truth = np.zeros(6), self.truth
        with rosbag.Bag(str(self.dir / "est.bag"), "w") as bag:
            for i in range(len(truth)):
                draw = np.linalg.cholesky(C) @ random.normal(size=6)
                sum_error = random.normal(size=6) * 1e-3 * np.sqrt(i) if i else sum_error
                message = self.odometry(truth.stamps_ns[i], truth.positions[i] - sum_error[:3],
                                        rotations.exp(-sum_error[3:]) @ truth.rotations[i],
                                        np.eye(6) * max(i, 1e-3) * 1e-6 / boast ** 2)
                bag.write("/some/odometry", message, message.header.stamp)
                if i == 0:
                    continue
                p, R = trajectory_errors.relative_motion(truth, np.array([i - 1]), np.array([i]))
                message = self.odometry(truth.stamps_ns[i], p[0] - draw[:3], rotations.exp(-draw[3:]) @ R[0],
                                        C / boast ** 2)
                bag.write("/some/relative_pose", message, message.header.stamp)
                record = EgoMotion(has_relative_pose=True)
                record.header.stamp = message.header.stamp
                record.previous_stamp = rospy.Time(*divmod(int(truth.stamps_ns[i - 1]), NS))
                record.scale_state = record.SCALE_OBSERVABLE if i % 10 else record.SCALE_UNOBSERVABLE
                bag.write("/some/ego_motion", record, message.header.stamp)

    def report(self, boast):
        self.write_estimate(boast)
        code, out, err = run(evaluate.main, self.dir / "truth.tum", self.dir / "est.bag",
                             "--json", self.dir / "r.json", "--plot", self.dir / "r.png")
        self.assertEqual(code, 0, err)
        self.assertIn("NEES", out)
        return json.loads((self.dir / "r.json").read_text())

    def test_honest_covariances(self):
        report = self.report(boast=1.0)
        for group, parts in (("frame to frame", ("rotation", "direction", "scale", "scale where observable")),
                             ("accumulated", ("position", "rotation", "pose"))):
            for part in parts:
                values = report["nees"][group][part]
                self.assertAlmostEqual(values["mean_per_dof"], 1.0, delta=0.12, msg=f"{group} {part}")
                self.assertAlmostEqual(values["inside_95_percent"], 95.0, delta=2.0, msg=f"{group} {part}")
        self.assertEqual(report["scale_states"]["UNOBSERVABLE"]["frames"], 149)
        self.assertTrue((self.dir / "r.png").read_bytes().startswith(b"\x89PNG"))
        code, out, _ = run(evaluate.main, "--summary", self.dir)
        self.assertEqual(code, 0)
        self.assertRegex(out, r"\nr +1500 ")

    def test_boastful_covariances_are_found_out(self):
        values = self.report(boast=2.0)["nees"]["frame to frame"]["rotation"]
        self.assertAlmostEqual(values["mean_per_dof"], 4.0, delta=0.5)
        self.assertLess(values["inside_95_percent"], 80.0)


class SummaryTest(TemporaryDirectoryTest):
    """Reports of several bags in a directory."""

    def write(self, name, content):
        (self.dir / name).write_text(content if isinstance(content, str) else json.dumps(content))

    @staticmethod
    def run_report(poses=100, p99_ms=12.5, late_images=2):
        return {"frames": 100, "poses": poses, "cpu_s": 3.0, "peak_memory_mb": 80.0,
                "stages": {"frame": {"count": 100, "median_ms": 8.0, "p99_ms": p99_ms}},
                "faults": {"late_images": late_images, "time_jumps": 1}}

    def evaluation_report(self):
        truth = winding_trajectory()
        estimate = Trajectory(truth.positions * 1.01, truth.rotations, truth.stamps_ns)
        return evaluate.evaluate(truth, estimate)

    def test_reports_of_both_tools_become_one_line(self):
        self.write("town.json", self.run_report())
        self.write("town.evaluation.json", self.evaluation_report())
        self.write("town.log", "100 frames\n")
        self.write("forest.report.json", self.run_report(p99_ms=20.5))
        self.write("settings.json", {"a": 1})
        self.write("readme.txt", "not a report")
        code, out, err = run(evaluate.main, "--summary", self.dir, "--json", self.dir.parent / f"{self.dir.name}.out")
        merged = pathlib.Path(f"{self.dir}.out")
        self.addCleanup(merged.unlink)
        self.assertEqual(code, 0, err)
        self.assertRegex(out, r"\ntown +100 +3 +12.5 ")
        self.assertRegex(out, r"\nforest +100 +3 +20.5 ")
        self.assertRegex(out, r"\nmedian +100 +3 +16.5 ")
        self.assertRegex(out, r" 0\.99\d\d ")  # scale of the estimate to the truth
        self.assertIn("2 bags, 0 failed", out)
        summary = json.loads(merged.read_text())
        self.assertEqual(set(summary["bags"]), {"town", "forest"})
        self.assertEqual(set(summary["bags"]["town"]), {"run", "evaluation"})
        self.assertEqual(summary["medians"]["p99_ms"], 16.5)

    def test_failed_bags_are_named(self):
        self.write("good.json", self.run_report())
        self.write("good.log", "fine\n")
        self.write("no_poses.json", self.run_report(poses=0))
        self.write("crashed.log", "some frames\negomotion_bag: no images in the bag\n\n")
        self.write("silent.log", "")
        self.write("cut.json", '{"frames": 1')
        code, out, _ = run(evaluate.main, "--summary", self.dir)
        self.assertEqual(code, 1)
        self.assertIn("5 bags, 4 failed:", out)
        self.assertIn("  no_poses: no pose\n", out)
        self.assertIn("  crashed: egomotion_bag: no images in the bag\n", out)
        self.assertIn("  silent: no report, and nothing in its log", out)
        self.assertRegex(out, r"  cut: cut\.json is no JSON")

    def test_a_directory_without_reports_is_refused(self):
        self.write("settings.json", {"a": 1})
        code, _, err = run(evaluate.main, "--summary", self.dir)
        self.assertEqual(code, 1)
        self.assertIn("found no report of egomotion_bag or evaluate.py among 1 .json files", err)
