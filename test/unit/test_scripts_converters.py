# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
"""Tests of the bag converters on small made-up recordings; test_scripts_real_data.py has those on real ones."""

import unittest

import numpy as np
import rosbag
import yaml
from PIL import Image

from scripts_test_case import EPOCH_NS, TemporaryDirectoryTest, run, winding_trajectory

import euroc_to_bag
import kitti_odometry
import kitti_raw
import kitti_to_bag
import rotations
import trajectory_errors
from smoothing_spline import GRAVITY, SmoothTrajectory
from trajectory_io import NS, read_tum


def write_image(path, width=32, height=24, colour=False):
    path.parent.mkdir(parents=True, exist_ok=True)
    shape = (height, width, 3) if colour else (height, width)
    Image.fromarray(np.random.default_rng(0).integers(0, 255, shape).astype(np.uint8)).save(path)


class ConverterTest(TemporaryDirectoryTest):
    def setUp(self):
        super().setUp()
        self.bag = self.dir / "out.bag"

    def assert_fails_naming(self, *texts, main, arguments):
        code, _, err = run(main, *arguments)
        self.assertEqual(code, 1)
        for text in texts:
            self.assertIn(text, err)
        self.assertEqual(list(self.dir.glob("out.bag*")), [], "a failed conversion leaves no bag")


class SmoothingSplineTest(unittest.TestCase):
    def test_noise_is_removed_and_motion_kept(self):
        truth = winding_trajectory(rate_hz=10.0)
        random = np.random.default_rng(2)
        times = (truth.stamps_ns - truth.stamps_ns[0]) / NS
        noisy = truth.positions + 0.01 * random.normal(size=truth.positions.shape)
        smooth = SmoothTrajectory(times, noisy, truth.rotations, 0.7, 2.5)
        residual = (smooth.position_spline(times) - truth.positions)[10:-10]
        self.assertLess(trajectory_errors.rms(residual), 0.006)
        acceleration = smooth.position_spline(times, 2)[10:-10]
        expected = np.stack([0 * times, -0.5 * np.sin(0.5 * times), -0.192 * np.sin(0.8 * times)], 1)[10:-10]
        self.assertLess(trajectory_errors.rms(acceleration - expected), 0.12)

    def test_acceleration_is_continuous(self):
        truth = winding_trajectory(count=30)
        times = (truth.stamps_ns - truth.stamps_ns[0]) / NS
        smooth = SmoothTrajectory(times, truth.positions, truth.rotations, 2.0, 2.0)
        knots = times[1:-1]
        for function in (lambda t: smooth.position_spline(t, 2), smooth.angular_rate):
            np.testing.assert_allclose(function(knots - 1e-9), function(knots + 1e-9), atol=1e-5)

    def test_perfect_derived_imu_integrates_to_the_poses(self):
        truth = winding_trajectory(rate_hz=10.0, count=100)
        imu = kitti_odometry.derive_imu(truth, seed=1, noise=0.0)
        start = (truth.stamps_ns - truth.stamps_ns[0]) / NS
        smooth = SmoothTrajectory(start, truth.positions, truth.rotations, kitti_odometry.POSITION_CUTOFF_HZ,
                                  kitti_odometry.ROTATION_CUTOFF_HZ)
        p, v = smooth.position_spline([0.0])[0], smooth.position_spline([0.0], 1)[0]
        R, gravity = smooth.rotation([0.0])[0], np.array([0.0, 0.0, -GRAVITY])
        for i, dt in enumerate(np.diff(imu.stamps_ns) / NS):
            R_next = R @ rotations.exp(0.5 * (imu.angular_rates[i] + imu.angular_rates[i + 1]) * dt)
            a = 0.5 * (R @ imu.specific_forces[i] + R_next @ imu.specific_forces[i + 1]) + gravity
            p, v, R = p + v * dt + 0.5 * a * dt ** 2, v + a * dt, R_next
        self.assertEqual(imu.stamps_ns[-1], truth.stamps_ns[-1])
        self.assertLess(np.linalg.norm(p - truth.positions[-1]), 0.02)
        self.assertLess(np.degrees(trajectory_errors.rotation_angle(R, truth.rotations[-1])), 0.05)

    def test_noise_has_the_stated_size_and_the_seed_repeats_it(self):
        truth = winding_trajectory(rate_hz=10.0)
        clean = kitti_odometry.derive_imu(truth, seed=1, noise=0.0)
        noisy, again = kitti_odometry.derive_imu(truth, seed=1), kitti_odometry.derive_imu(truth, seed=1)
        np.testing.assert_array_equal(noisy.angular_rates, again.angular_rates)
        error = np.degrees(noisy.angular_rates - clean.angular_rates)
        self.assertAlmostEqual(np.linalg.norm(error.mean(axis=0)), 0.5, delta=0.02)
        self.assertAlmostEqual(error.std(axis=0).mean(), 0.1, delta=0.01)
        self.assertAlmostEqual((noisy.specific_forces - clean.specific_forces).std(), 0.05, delta=0.005)
        self.assertAlmostEqual(noisy.gyroscope_noise_density, np.radians(0.1) / 10.0)


class EurocToBagTest(ConverterTest):
    def setUp(self):
        super().setUp()
        self.mav0 = self.dir / "mav0"
        pose = {"rows": 4, "cols": 4, "data": np.eye(4).ravel().tolist()}
        self.stamps = [EPOCH_NS + i * 50_000_000 for i in range(5)]
        for i in range(2):
            camera = self.mav0 / f"cam{i}"
            for stamp in self.stamps:
                write_image(camera / "data" / f"{stamp}.png")
            (camera / "data.csv").write_text("#t,file\n" + "".join(f"{s},{s}.png\n" for s in self.stamps))
            shifted = dict(pose, data=[*pose["data"][:3], 0.1 * i, *pose["data"][4:]])
            (camera / "sensor.yaml").write_text(yaml.dump({
                "T_BS": shifted, "resolution": [32, 24], "intrinsics": [30.0, 31.0, 16.0, 12.0],
                "distortion_model": "radial-tangential", "distortion_coefficients": [-0.1, 0.01, 0.001, 0.002]}))
        (self.mav0 / "imu0").mkdir()
        (self.mav0 / "imu0" / "data.csv").write_text("#t,w,a\n" + "".join(
            f"{EPOCH_NS + i * 5_000_000},0.1,0.2,0.3,1,2,9.8\n" for i in range(45)))
        (self.mav0 / "imu0" / "sensor.yaml").write_text(yaml.dump({
            "T_BS": pose, "rate_hz": 200, "gyroscope_noise_density": 1.7e-4, "gyroscope_random_walk": 1.9e-5,
            "accelerometer_noise_density": 2e-3, "accelerometer_random_walk": 3e-3}))
        (self.mav0 / "state_groundtruth_estimate0").mkdir()
        (self.mav0 / "state_groundtruth_estimate0" / "data.csv").write_text("#t,p,q\n" + "".join(
            f"{stamp},1,2,3,0.5,-0.5,0.5,0.5\n" for stamp in self.stamps))

    def test_bag_has_the_recording(self):
        self.assertEqual(run(euroc_to_bag.main, self.mav0, self.bag)[0], 0)
        with rosbag.Bag(str(self.bag)) as bag:
            messages = list(bag.read_messages())
        by_topic = {}
        for topic, message, time in messages:
            by_topic.setdefault(topic, []).append(message)
            if topic != "/tf_static":
                self.assertEqual(message.header.stamp, time)
        self.assertEqual([m.header.stamp.to_nsec() for m in by_topic["/cam1/image_raw"]], self.stamps)
        image, info = by_topic["/cam1/image_raw"][0], by_topic["/cam1/camera_info"][0]
        self.assertEqual((image.width, image.height, image.step, image.encoding, image.header.frame_id),
                         (32, 24, 32, "mono8", "cam1"))
        self.assertEqual(list(info.D), [-0.1, 0.01, 0.001, 0.002, 0.0])
        self.assertEqual(info.distortion_model, "plumb_bob")
        imu = by_topic["/imu"][0]
        self.assertEqual((imu.orientation_covariance[0], imu.header.frame_id, len(by_topic["/imu"])), (-1, "imu", 45))
        transforms = {t.child_frame_id: t.transform for t in by_topic["/tf_static"][0].transforms}
        self.assertEqual(sorted(transforms), ["cam0", "cam1", "imu"])
        self.assertAlmostEqual(transforms["cam1"].translation.x, 0.1)
        self.assertEqual(len(by_topic["/ground_truth"]), 5)

    def test_rig_and_ground_truth_stand_beside_the_bag(self):
        run(euroc_to_bag.main, self.mav0, self.bag)
        rig = yaml.safe_load((self.dir / "out.rig.yaml").read_text())
        self.assertEqual(rig["cameras"][1]["T_body_cam"][0], [1.0, 0.0, 0.0, 0.1])
        self.assertEqual(rig["cameras"][0]["distortion_model"], "radtan")
        self.assertAlmostEqual(float(rig["imu"]["gyroscope_noise_density"]), 1.7e-4)
        truth = read_tum(self.dir / "out.groundtruth.tum")
        self.assertEqual(truth.stamps_ns.tolist(), self.stamps)
        np.testing.assert_allclose(truth.rotations[0], rotations.matrix_from_quaternion([-0.5, 0.5, 0.5, 0.5]),
                                   atol=1e-9)

    def test_faults_are_named(self):
        (self.mav0 / "cam1" / "data" / f"{self.stamps[2]}.png").unlink()
        self.assert_fails_naming("cam1", f"{self.stamps[2]}.png", main=euroc_to_bag.main,
                                 arguments=(self.mav0, self.bag))
        write_image(self.mav0 / "cam1" / "data" / f"{self.stamps[2]}.png", width=30)
        self.assert_fails_naming("30x24", "32x24", main=euroc_to_bag.main, arguments=(self.mav0, self.bag))
        write_image(self.mav0 / "cam1" / "data" / f"{self.stamps[2]}.png")
        write_image(self.mav0 / "cam0" / "data" / "extra.png")
        self.assert_fails_naming("cam0", "found 6 images, expected 5", main=euroc_to_bag.main,
                                 arguments=(self.mav0, self.bag))
        (self.mav0 / "imu0" / "data.csv").unlink()
        (self.mav0 / "cam0" / "data" / "extra.png").unlink()
        self.assert_fails_naming("imu0", "no such file", main=euroc_to_bag.main, arguments=(self.mav0, self.bag))


class KittiOdometryToBagTest(ConverterTest):
    COUNT = 12

    def setUp(self):
        super().setUp()
        self.sequence = self.dir / "03"
        for camera in range(2):
            for i in range(self.COUNT):
                write_image(self.sequence / f"image_{camera}" / f"{i:06d}.png")
        (self.sequence / "calib.txt").write_text("P0: 30 0 16 0 0 30 12 0 0 0 1 0\nP1: 30 0 16 -15 0 30 12 0 0 0 1 0\n")
        (self.sequence / "times.txt").write_text("".join(f"{0.1 * i:e}\n" for i in range(self.COUNT)))
        self.poses = self.dir / "poses.txt"
        self.poses.write_text("".join(f"1 0 0 0 0 1 0 {-0.1 * i} 0 0 1 {i}\n" for i in range(self.COUNT)))

    def test_axes_baseline_and_derived_imu(self):
        self.assertEqual(run(kitti_to_bag.main, self.sequence, self.bag, "--poses", self.poses)[0], 0)
        rig = yaml.safe_load((self.dir / "out.rig.yaml").read_text())
        np.testing.assert_allclose(rig["cameras"][1]["T_body_cam"],
                                   [[0, 0, 1, 0], [-1, 0, 0, -0.5], [0, -1, 0, 0], [0, 0, 0, 1]], atol=1e-12)
        self.assertEqual((rig["imu"]["topic"], rig["imu"]["rate_hz"]), ("/imu_derived", 100))
        truth = read_tum(self.dir / "out.groundtruth.tum")
        np.testing.assert_allclose(truth.positions[-1], [11.0, 0.0, 1.1], atol=1e-9)
        self.assertEqual(truth.stamps_ns[1], 1_000_000_000_100_000_000)
        with rosbag.Bag(str(self.bag)) as bag:
            forces = [m.linear_acceleration.z for _, m, _ in bag.read_messages(topics=["/imu_derived"])]
        self.assertEqual(len(forces), 111)
        self.assertAlmostEqual(float(np.mean(forces)), GRAVITY, delta=0.02)

    def test_without_poses_there_is_no_imu(self):
        self.assertEqual(run(kitti_to_bag.main, self.sequence, self.bag)[0], 0)
        self.assertNotIn("imu", yaml.safe_load((self.dir / "out.rig.yaml").read_text()))
        self.assertFalse((self.dir / "out.groundtruth.tum").exists())

    def test_faults_are_named(self):
        main, arguments = kitti_to_bag.main, (self.sequence, self.bag, "--poses", self.poses)
        (self.sequence / "image_1" / "000003.png").unlink()
        self.assert_fails_naming("image_1", "found 11 images, expected 12", main=main, arguments=arguments)
        write_image(self.sequence / "image_1" / "000003.png")
        self.poses.write_text("1 0 0 0 0 1 0 0 0 0 1 0\n")
        self.assert_fails_naming("poses.txt", "found 1 poses, expected 12", main=main, arguments=arguments)
        self.poses.unlink()
        self.assert_fails_naming("poses.txt", "no such file", main=main, arguments=arguments)


class KittiRawToBagTest(ConverterTest):
    COUNT = 4

    def write_drive(self, kind):
        drive = self.dir / "2011_09_26" / f"2011_09_26_drive_0001_{kind}"
        for camera in range(4):
            directory = drive / f"image_{camera:02d}"
            for i in range(self.COUNT):
                write_image(directory / "data" / f"{i:010d}.png", colour=camera >= 2)
            (directory / "timestamps.txt").write_text("".join(
                f"2011-09-26 13:02:44.{100 * i + camera:03d}000001\n" for i in range(self.COUNT)))
        (drive / "oxts" / "data").mkdir(parents=True)
        (drive / "oxts" / "timestamps.txt").write_text("".join(
            f"2011-09-26 13:02:44.{10 * i:03d}000000\n" for i in range(40)))
        for i in range(40):
            values = [49.0, 8.0 + 1e-6 * i, 100.0, 0.0, 0.0, np.pi / 2] + [0.0] * 24
            values[11:14], values[17:20] = [0.1, 0.2, 9.8], [0.01, 0.02, 0.03]
            (drive / "oxts" / "data" / f"{i:010d}.txt").write_text(" ".join(map(str, values)))
        identity = "R: 1 0 0 0 1 0 0 0 1\nT: 0 0 0\n"
        (drive.parent / "calib_imu_to_velo.txt").write_text("calib_time: x\n" + identity)
        (drive.parent / "calib_velo_to_cam.txt").write_text("R: 0 -1 0 0 0 -1 1 0 0\nT: 0 0 -1\n")
        lines = []
        for camera in range(4):
            lines += [f"S_{camera:02d}: 32 24", f"S_rect_{camera:02d}: 32 24",
                      f"K_{camera:02d}: 31 0 16 0 31 12 0 0 1", f"D_{camera:02d}: -0.3 0.1 0.01 0.02 -0.05",
                      f"R_{camera:02d}: 1 0 0 0 1 0 0 0 1", f"T_{camera:02d}: {-0.25 * camera} 0 0",
                      f"R_rect_{camera:02d}: 1 0 0 0 1 0 0 0 1",
                      f"P_rect_{camera:02d}: 30 0 16 {-15 * camera} 0 30 12 0 0 0 1 0"]
        (drive.parent / "calib_cam_to_cam.txt").write_text("calib_time: x\n" + "\n".join(lines) + "\n")
        return drive

    def test_synced_drive_with_four_cameras(self):
        drive = self.write_drive("sync")
        self.assertEqual(run(kitti_to_bag.main, "--raw", drive, self.bag, "--cameras", "0,1,2,3")[0], 0)
        rig = yaml.safe_load((self.dir / "out.rig.yaml").read_text())
        self.assertEqual([camera["distortion_model"] for camera in rig["cameras"]], ["none"] * 4)
        np.testing.assert_allclose(np.array(rig["cameras"][3]["T_body_cam"])[:3, 3], [1.0, -1.5, 0.0], atol=1e-12)
        with rosbag.Bag(str(self.bag)) as bag:
            images = {t: m for t, m, _ in bag.read_messages(topics=["/cam0/image_raw", "/cam3/image_raw"])}
            imu = [m for _, m, _ in bag.read_messages(topics=["/imu"])]
        self.assertEqual([images[f"/cam{i}/image_raw"].encoding for i in (0, 3)], ["mono8", "rgb8"])
        self.assertEqual(images["/cam3/image_raw"].header.stamp.to_nsec(), 1317042164_303000001)
        self.assertEqual((imu[0].linear_acceleration.z, imu[0].angular_velocity.z, len(imu)), (9.8, 0.03, 40))
        truth = read_tum(self.dir / "out.groundtruth.tum")
        east = np.cos(np.radians(49.0)) * kitti_raw.EARTH_RADIUS * np.radians(39e-6)
        np.testing.assert_allclose(truth.positions[-1], [east, 0.0, 0.0], atol=1e-6)
        np.testing.assert_allclose(truth.rotations[0] @ [1, 0, 0], [0, 1, 0], atol=1e-9)

    def test_extracted_drive_is_distorted(self):
        drive = self.write_drive("extract")
        self.assertEqual(run(kitti_to_bag.main, "--raw", drive, self.bag)[0], 0)
        rig = yaml.safe_load((self.dir / "out.rig.yaml").read_text())
        self.assertEqual(rig["cameras"][1]["distortion"], [-0.3, 0.1, 0.01, 0.02, -0.05])
        np.testing.assert_allclose(np.array(rig["cameras"][1]["T_body_cam"])[:3, 3], [1.0, -0.25, 0.0], atol=1e-12)

    def test_faults_are_named(self):
        drive = self.write_drive("sync")
        main, arguments = kitti_to_bag.main, ("--raw", drive, self.bag)
        (drive / "image_01" / "data" / f"{3:010d}.png").unlink()
        self.assert_fails_naming("image_01", "0000000003", main=main, arguments=arguments)
        (drive / "image_01" / "data" / f"{1:010d}.png").unlink()
        self.assert_fails_naming("image_01", "found no 0000000001.png", main=main, arguments=arguments)
        (drive / "oxts" / "timestamps.txt").unlink()
        write_image(drive / "image_01" / "data" / f"{1:010d}.png")
        write_image(drive / "image_01" / "data" / f"{3:010d}.png")
        self.assert_fails_naming("oxts/timestamps.txt", main=main, arguments=arguments)
        (drive.parent / "calib_imu_to_velo.txt").unlink()
        self.assert_fails_naming("calib_imu_to_velo.txt", main=main, arguments=arguments)
