#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
"""Writes a EuRoC (ASL format) recording as a bag, with its rig and ground truth beside it.

Stamps are the nanoseconds of the data.csv files; the body frame base_link is the IMU's. Beside OUT.bag:
OUT.rig.yaml and OUT.groundtruth.tum (T_world_body, where the recording has ground truth).
"""

import argparse
import os
import pathlib
import sys

import numpy as np
import yaml

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))  # also when started through catkin's relay
import rotations  # noqa: E402
from dataset_files import (InputError, read_lines, read_numbers, require_count, require_directory,  # noqa: E402
                           require_file, require_increasing)
from rig_bag import Camera, ImuSensor, write_recording  # noqa: E402
from trajectory_io import Trajectory  # noqa: E402

DISTORTION_MODELS = {"radial-tangential": "radtan", "radtan": "radtan", "equidistant": "equidistant"}
GROUND_TRUTH_DIRS = ("state_groundtruth_estimate0", "mocap0")

# The sensor was calibrated on a bench with many views of a target, to some tenths of a millimetre.
POSITION_SIGMA_M = 0.0005


def read_sensor_yaml(path, keys):
    """The sensor.yaml as a dictionary that has T_BS and all of `keys`."""
    try:
        sensor = yaml.safe_load(require_file(path).read_text())
    except yaml.YAMLError as error:
        raise InputError(f"{path}: not YAML ({error})") from None
    missing = [key for key in ("T_BS", *keys) if key not in (sensor or {})]
    if missing:
        raise InputError(f"{path}: found no {', '.join(missing)}, expected an ASL sensor description")
    return sensor


def transform(sensor):
    """T_body_sensor (4, 4)."""
    return np.array(sensor["T_BS"]["data"], dtype=float).reshape(4, 4)


def read_stamps(path):
    """First column [ns] of a data.csv as exact integers."""
    try:
        stamps = np.array([int(line.split(",")[0]) for line in read_lines(path)], dtype=np.int64)
    except ValueError as error:
        raise InputError(f"{path}: {error}, expected integer nanoseconds in the first column") from None
    require_increasing(path, stamps)
    return stamps


def read_camera(directory):
    """Camera of a cam<i> directory; every image that data.csv lists must exist, and no other."""
    yaml_path, csv_path = directory / "sensor.yaml", directory / "data.csv"
    sensor = read_sensor_yaml(yaml_path, ("resolution", "intrinsics", "distortion_model", "distortion_coefficients"))
    model = DISTORTION_MODELS.get(sensor["distortion_model"])
    if model is None:
        raise InputError(f"{yaml_path}: found distortion_model {sensor['distortion_model']}, "
                         f"expected one of {', '.join(DISTORTION_MODELS)}")
    names = [line.split(",")[1].strip() for line in read_lines(csv_path)]
    paths = [require_file(directory / "data" / name) for name in names]
    found = sum(1 for path in (directory / "data").iterdir() if path.suffix == paths[0].suffix)
    require_count(directory / "data", found, len(paths), "images", f"lines of {csv_path}")
    return Camera(directory.name, tuple(sensor["resolution"]), sensor["intrinsics"], model,
                  sensor["distortion_coefficients"], transform(sensor), read_stamps(csv_path), paths,
                  position_sigma_m=POSITION_SIGMA_M)


def read_imu(directory):
    """IMU of the imu0 directory."""
    noise = ("gyroscope_noise_density", "gyroscope_random_walk",
             "accelerometer_noise_density", "accelerometer_random_walk")
    sensor = read_sensor_yaml(directory / "sensor.yaml", ("rate_hz", *noise))
    values = read_numbers(directory / "data.csv", 7, ",")
    return ImuSensor(transform(sensor), float(sensor["rate_hz"]), *(float(sensor[key]) for key in noise),
                     read_stamps(directory / "data.csv"), values[:, 1:4], values[:, 4:7])


def read_ground_truth(mav_dir):
    """Trajectory of the body in the recording's world, or None when there is no ground truth directory."""
    for name in GROUND_TRUTH_DIRS:
        path = mav_dir / name / "data.csv"
        if path.parent.is_dir():
            values = read_numbers(path, 8, ",")
            q_xyzw = values[:, [5, 6, 7, 4]]
            return Trajectory(values[:, 1:4], rotations.matrix_from_quaternion(q_xyzw), read_stamps(path))
    print(f"{mav_dir}: no ground truth ({' or '.join(GROUND_TRUTH_DIRS)}), none written", file=sys.stderr)
    return None


def convert(mav_dir, bag_path):
    """Reads the mav0 directory and writes the bag and its companions."""
    mav_dir = require_directory(mav_dir)
    camera_dirs = sorted(path for path in mav_dir.glob("cam[0-9]*") if path.is_dir())
    if not camera_dirs:
        raise InputError(f"{mav_dir}: found no cam0 directory, expected cam0, cam1, ... and imu0")
    cameras = [read_camera(directory) for directory in camera_dirs]
    write_recording(bag_path, cameras, read_imu(mav_dir / "imu0"), read_ground_truth(mav_dir))


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("mav_dir", metavar="MAV0_DIR", type=pathlib.Path, help="directory with cam0, imu0, ...")
    parser.add_argument("bag", metavar="OUT.bag", type=pathlib.Path, help="bag to write")
    options = parser.parse_args(arguments)
    try:
        convert(options.mav_dir, options.bag)
    except (InputError, OSError) as error:
        print(f"{parser.prog}: error: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
