# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
"""KITTI odometry sequences: rectified cameras, base_link at the left grey camera with the axes of REP-103.

With ground truth poses, an IMU at base_link is derived from a smoothing spline through them.
"""

import numpy as np

from dataset_files import InputError, read_image, read_lines, require_count, require_directory, require_increasing
from rig_bag import Camera, ImuSensor
from smoothing_spline import SmoothTrajectory
from trajectory_io import NS, Trajectory, read_kitti

BASE_EPOCH_S = 1_000_000_000  # times.txt starts at 0, but a ROS stamp of 0 means "no stamp"
FIRST_COLOUR_CAMERA = 2

# x forward, y left, z up of base_link in the axes x right, y down, z forward of the camera.
R_BODY_CAMERA = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])

# Derived IMU. Rotation keeps all that poses at 10 Hz can tell: images agree with KITTI's rotations up to there (a
# cut-off of 2.5 Hz would take 0.025 deg of real motion from frame to frame). Of the positions, 1 to 2 mm above 1.5 Hz
# are noise, which two derivatives would make 0.5 m/s^2.
IMU_TOPIC = "/imu_derived"
IMU_RATE_HZ = 100
POSITION_CUTOFF_HZ = 1.5
ROTATION_CUTOFF_HZ = 5.0
GYROSCOPE_SIGMA = np.radians(0.1)      # [rad/s] per sample
GYROSCOPE_BIAS = np.radians(0.5)       # [rad/s] constant, in a random direction
ACCELEROMETER_SIGMA = 0.05             # [m/s^2] per sample
GYROSCOPE_RANDOM_WALK = 1e-5           # [rad/s^2/sqrt(Hz)] the bias is constant; a filter wants some
ACCELEROMETER_RANDOM_WALK = 1e-4       # [m/s^3/sqrt(Hz)]


def read_projections(path):
    """Calibration file `P0: 12 numbers` ... as a dictionary of arrays (3, 4)."""
    projections = {}
    for line in read_lines(path):
        key, _, numbers = line.partition(":")
        if key.startswith("P") and key[1:].isdigit():
            require_count(f"{path}, {key}", len(numbers.split()), 12, "numbers", "a 3x4 matrix")
            projections[int(key[1:])] = np.array(numbers.split(), dtype=float).reshape(3, 4)
    return projections


def rectified_camera_offset(projection):
    """Origin of a rectified camera in the axes of rectified camera 0 (3,) [m], from P = K [I | -origin]."""
    return -np.linalg.solve(projection[:, :3], projection[:, 3])


def read_stamps(path):
    """Stamps [ns] of times.txt, moved to the base epoch."""
    stamps = np.array([int(round(float(line) * NS)) for line in read_lines(path)], dtype=np.int64)
    require_increasing(path, stamps)
    return stamps + BASE_EPOCH_S * NS


def numbered_images(directory, stamps_path, count):
    """The PNG images of a directory in the order of their numbers; as many as there are stamps."""
    images = sorted(require_directory(directory).glob("*.png"))
    require_count(directory, len(images), count, "images", f"lines of {stamps_path}")
    return images


def read_camera(sequence_dir, number, name, stamps_ns):
    """Rectified camera `number` (0, 1 grey; 2, 3 colour) as camera `name` of the rig."""
    calibration = sequence_dir / "calib.txt"
    projections = read_projections(calibration)
    if number not in projections:
        raise InputError(f"{calibration}: found no P{number}, expected the projection of camera {number}")
    P = projections[number]
    images = numbered_images(sequence_dir / f"image_{number}", sequence_dir / "times.txt", len(stamps_ns))
    pixels, _ = read_image(images[0])
    T_body_cam = np.eye(4)
    T_body_cam[:3, :3] = R_BODY_CAMERA
    T_body_cam[:3, 3] = R_BODY_CAMERA @ rectified_camera_offset(P)
    return Camera(name, (pixels.shape[1], pixels.shape[0]), [P[0, 0], P[1, 1], P[0, 2], P[1, 2]], "none", [],
                  T_body_cam, stamps_ns, images, projection=P)


def read_body_poses(poses_path, stamps_ns, times_path):
    """Ground truth of base_link; the world is its first pose, hence z against camera-0 y of that pose."""
    cameras = read_kitti(poses_path)
    require_count(poses_path, len(cameras), len(stamps_ns), "poses", f"lines of {times_path}")
    R_0 = cameras.rotations[0]
    positions = (cameras.positions - cameras.positions[0]) @ R_0 @ R_BODY_CAMERA.T
    matrices = R_BODY_CAMERA @ R_0.T @ cameras.rotations @ R_BODY_CAMERA.T
    return Trajectory(positions, matrices, stamps_ns)


def derive_imu(trajectory, seed, noise=1.0):
    """IMU at base_link from the first to the last pose; `noise` 0 makes it perfect (no noise, no bias)."""
    if len(trajectory) < 3:
        raise InputError(f"found {len(trajectory)} poses, expected at least 3 to derive an IMU from")
    origin = trajectory.stamps_ns[0]
    times = (trajectory.stamps_ns - origin) / NS
    smooth = SmoothTrajectory(times, trajectory.positions, trajectory.rotations,
                              POSITION_CUTOFF_HZ, ROTATION_CUTOFF_HZ)
    stamps = np.arange(0, trajectory.stamps_ns[-1] - origin, NS // IMU_RATE_HZ, dtype=np.int64)
    stamps = np.append(stamps, trajectory.stamps_ns[-1] - origin)
    random = np.random.default_rng(seed)
    direction = random.normal(size=3)
    bias = GYROSCOPE_BIAS * direction / np.linalg.norm(direction)
    rates = smooth.angular_rate(stamps / NS)
    forces = smooth.specific_force(stamps / NS)
    rates = rates + noise * (bias + GYROSCOPE_SIGMA * random.normal(size=rates.shape))
    forces = forces + noise * ACCELEROMETER_SIGMA * random.normal(size=forces.shape)
    root_rate = np.sqrt(IMU_RATE_HZ)
    return ImuSensor(np.eye(4), IMU_RATE_HZ, GYROSCOPE_SIGMA / root_rate, GYROSCOPE_RANDOM_WALK,
                     ACCELEROMETER_SIGMA / root_rate, ACCELEROMETER_RANDOM_WALK,
                     stamps + origin, rates, forces, topic=IMU_TOPIC)


def read_sequence(sequence_dir, camera_numbers, poses_path, seed):
    """(cameras, derived IMU or None, ground truth or None) of a sequence directory."""
    times_path = require_directory(sequence_dir) / "times.txt"
    stamps = read_stamps(times_path)
    cameras = [read_camera(sequence_dir, number, f"cam{i}", stamps) for i, number in enumerate(camera_numbers)]
    if poses_path is None:
        return cameras, None, None
    ground_truth = read_body_poses(poses_path, stamps, times_path)
    return cameras, derive_imu(ground_truth, seed), ground_truth
