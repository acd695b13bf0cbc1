# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
"""KITTI raw drives, `_sync` (rectified, 10 Hz) or `_extract` (distorted, OXTS at 100 Hz): base_link is the OXTS.

Every camera and the OXTS keep their own stamps. The calibration files are in the directory above the drive's.
"""

import datetime

import numpy as np

from dataset_files import (InputError, read_lines, read_numbers, require_count, require_directory, require_file,
                           require_increasing)
from kitti_odometry import rectified_camera_offset
from rig_bag import Camera, ImuSensor
from trajectory_io import NS, Trajectory

EARTH_RADIUS = 6378137.0  # [m]
EPOCH = datetime.datetime(1970, 1, 1)

# Columns of an OXTS line.
LATITUDE, LONGITUDE, ALTITUDE, ROLL, PITCH, YAW = range(6)
ACCELERATION = slice(11, 14)   # ax ay az: specific force in vehicle axes (forward, left, up) [m/s^2]
ANGULAR_RATE = slice(17, 20)   # wx wy wz in the same axes [rad/s]
OXTS_COLUMNS = 20

# Noise densities (gyroscope, its walk, accelerometer, its walk). At 10 Hz a sample stands for 100 ms of motion that
# nobody saw: the densities stand for that, some 0.5 deg/s and 0.3 m/s^2 a sample, and not for the sensor.
NOISE_EXTRACT = (5e-4, 1e-5, 1e-2, 1e-4)
NOISE_SYNC = (3e-3, 1e-5, 1e-1, 1e-4)
FAST_RATE_HZ = 50.0


def read_calibration(path):
    """`key: numbers` lines as a dictionary of arrays; other lines are left out."""
    values = {}
    for line in read_lines(path):
        key, _, numbers = line.partition(":")
        try:
            values[key] = np.array(numbers.split(), dtype=float)
        except ValueError:
            continue
    return values


def calibration_value(values, path, key, shape):
    """One entry of a calibration file as an array of the given shape."""
    if key not in values:
        raise InputError(f"{path}: found no {key}, expected {int(np.prod(shape))} numbers")
    require_count(f"{path}, {key}", values[key].size, int(np.prod(shape)), "numbers", "the file format")
    return values[key].reshape(shape)


def read_rigid_transform(path):
    """T (4, 4) of a calibration file with R and T."""
    values = read_calibration(path)
    T = np.eye(4)
    T[:3, :3] = calibration_value(values, path, "R", (3, 3))
    T[:3, 3] = calibration_value(values, path, "T", (3,))
    return T


def inverse(T):
    """Inverse of a rigid transform (4, 4)."""
    result = np.eye(4)
    result[:3, :3] = T[:3, :3].T
    result[:3, 3] = -T[:3, :3].T @ T[:3, 3]
    return result


def read_stamps(path):
    """UTC stamps [ns] of lines `2011-09-26 13:02:44.334126592`."""
    stamps = []
    for number, line in enumerate(read_lines(path), start=1):
        try:
            whole, _, fraction = line.partition(".")
            seconds = (datetime.datetime.strptime(whole, "%Y-%m-%d %H:%M:%S") - EPOCH) // datetime.timedelta(seconds=1)
            stamps.append(seconds * NS + int((fraction + "000000000")[:9]))
        except ValueError:
            raise InputError(f"{path}, line {number}: found {line!r}, expected YYYY-MM-DD HH:MM:SS.fraction") from None
    return np.array(stamps, dtype=np.int64)


def numbered_files(directory, suffix, stamps_path, stamp_count):
    """(first number, files) of files named by their line of timestamps.txt (from 0); a gap is an error.

    Fewer files than stamps are an excerpt of the drive and said on stdout: the numbers tell the stamps.
    """
    files = sorted(require_directory(directory).glob("*" + suffix))
    if not files or not all(path.stem.isdigit() for path in files):
        raise InputError(f"{directory}: found {len(files)} {suffix} files, "
                         f"expected {stamp_count} named by their number")
    first, last = int(files[0].stem), int(files[-1].stem)
    for number, path in enumerate(files, start=first):
        if int(path.stem) != number:
            raise InputError(f"{directory}: found no {number:010d}{suffix}, expected all of {first} to {last}")
    if last >= stamp_count:
        raise InputError(f"{stamps_path}: found {stamp_count} stamps, expected {last + 1} ({files[-1]} exists)")
    if len(files) < stamp_count:
        print(f"{directory}: an excerpt, numbers {first} to {last}; {stamps_path.name} has {stamp_count} stamps")
    return first, files


def require_same_excerpt(cameras):
    """The cameras of a synchronized drive have the same image numbers, of an excerpt too."""
    spans = [(camera.image_paths[0].stem, camera.image_paths[-1].stem) for camera in cameras]
    for camera, span in zip(cameras, spans):
        if span != spans[0]:
            raise InputError(f"{camera.image_paths[0].parent}: found images {span[0]} to {span[1]}, "
                             f"expected {spans[0][0]} to {spans[0][1]} (as in {cameras[0].image_paths[0].parent})")


def read_camera(drive_dir, number, name, T_cam0_body):
    """Camera `number` (0, 1 grey; 2, 3 colour) as camera `name`; rectified in a _sync drive, else distorted."""
    path = drive_dir.parent / "calib_cam_to_cam.txt"
    values = read_calibration(path)

    def entry(key, shape):
        return calibration_value(values, path, f"{key}_{number:02d}", shape)

    T_cam_cam0 = np.eye(4)
    if drive_dir.name.endswith("_extract"):
        K, projection, model, distortion = entry("K", (3, 3)), None, "radtan", entry("D", (5,)).tolist()
        resolution = entry("S", (2,))
        T_cam_cam0[:3, :3], T_cam_cam0[:3, 3] = entry("R", (3, 3)), entry("T", (3,))
    else:
        projection, model, distortion = entry("P_rect", (3, 4)), "none", []
        K = projection[:, :3]
        resolution = entry("S_rect", (2,))
        T_cam_cam0[:3, :3] = calibration_value(values, path, "R_rect_00", (3, 3))
        T_cam_cam0[:3, 3] = -rectified_camera_offset(projection)
    stamps_path = drive_dir / f"image_{number:02d}" / "timestamps.txt"
    stamps = read_stamps(stamps_path)
    require_increasing(stamps_path, stamps)
    first, images = numbered_files(stamps_path.parent / "data", ".png", stamps_path, len(stamps))
    return Camera(name, tuple(int(size) for size in resolution), [K[0, 0], K[1, 1], K[0, 2], K[1, 2]], model,
                  distortion, inverse(T_cam_cam0 @ T_cam0_body),
                  stamps[first:first + len(images)], images, projection=projection)


def read_oxts(drive_dir):
    """(stamps [ns], table (n, 20)) of the OXTS; lines whose stamp does not advance are dropped and counted."""
    stamps_path = drive_dir / "oxts" / "timestamps.txt"
    stamps = read_stamps(stamps_path)
    first, files = numbered_files(stamps_path.parent / "data", ".txt", stamps_path, len(stamps))
    stamps = stamps[first:first + len(files)]
    table = np.vstack([read_numbers(path, OXTS_COLUMNS)[:1] for path in files])
    newest_before = np.concatenate([[np.iinfo(np.int64).min], np.maximum.accumulate(stamps)[:-1]])
    advancing = stamps > newest_before
    if not advancing.all():
        print(f"{stamps_path}: dropped {np.count_nonzero(~advancing)} of {len(stamps)} OXTS lines, "
              "whose stamps are not later than those before them")
    return stamps[advancing], table[advancing]


def oxts_trajectory(stamps_ns, table):
    """Ground truth: x east, y north, z up from the first position (Mercator projection, as KITTI's devkit)."""
    scale = np.cos(np.radians(table[0, LATITUDE]))
    east = scale * EARTH_RADIUS * np.radians(table[:, LONGITUDE])
    north = scale * EARTH_RADIUS * np.log(np.tan(np.pi / 4.0 + np.radians(table[:, LATITUDE]) / 2.0))
    positions = np.stack([east, north, table[:, ALTITUDE]], axis=1)
    matrices = (_axis_rotation(table[:, YAW], 2) @ _axis_rotation(table[:, PITCH], 1)
                @ _axis_rotation(table[:, ROLL], 0))
    return Trajectory(positions - positions[0], matrices, stamps_ns)


def _axis_rotation(angles, axis):
    """Rotation matrices (n, 3, 3) about coordinate axis 0, 1 or 2."""
    i, j = (axis + 1) % 3, (axis + 2) % 3
    matrices = np.tile(np.eye(3), (len(angles), 1, 1))
    matrices[:, i, i] = matrices[:, j, j] = np.cos(angles)
    matrices[:, j, i] = np.sin(angles)
    matrices[:, i, j] = -np.sin(angles)
    return matrices


def oxts_imu(stamps_ns, table):
    """The OXTS as an IMU at base_link."""
    rate_hz = (len(stamps_ns) - 1) * NS / (stamps_ns[-1] - stamps_ns[0])
    noise = NOISE_EXTRACT if rate_hz > FAST_RATE_HZ else NOISE_SYNC
    return ImuSensor(np.eye(4), round(float(rate_hz), 1), *noise, stamps_ns,
                     table[:, ANGULAR_RATE], table[:, ACCELERATION])


def read_drive(drive_dir, camera_numbers):
    """(cameras, IMU, ground truth) of a drive directory."""
    drive_dir = require_directory(drive_dir).resolve()
    if not drive_dir.name.endswith(("_sync", "_extract")):
        raise InputError(f"{drive_dir}: expected a directory name that ends in _sync or _extract")
    require_file(drive_dir.parent / "calib_cam_to_cam.txt")
    T_cam0_body = (read_rigid_transform(drive_dir.parent / "calib_velo_to_cam.txt")
                   @ read_rigid_transform(drive_dir.parent / "calib_imu_to_velo.txt"))
    cameras = [read_camera(drive_dir, number, f"cam{i}", T_cam0_body) for i, number in enumerate(camera_numbers)]
    if drive_dir.name.endswith("_sync"):
        require_same_excerpt(cameras)
    stamps, table = read_oxts(drive_dir)
    if len(stamps) < 2:
        raise InputError(f"{drive_dir / 'oxts'}: found {len(stamps)} usable lines, expected at least 2")
    return cameras, oxts_imu(stamps, table), oxts_trajectory(stamps, table)
