# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
"""A camera and IMU rig, written as the package's rig YAML, and recordings of it, written as a bag.

Frames: T_a_b maps coordinates of b into a. Cameras are optical frames (x right, y down, z forward).
"""

import dataclasses
import heapq
import os
import pathlib
from typing import List, Optional, Tuple

import genpy.dynamic
import numpy as np
import rosbag
import rospy
from geometry_msgs.msg import TransformStamped
from nav_msgs.msg import Odometry
from sensor_msgs.msg import CameraInfo, Image, Imu

import rotations
from dataset_files import read_image
from trajectory_io import write_tum

BODY_FRAME = "base_link"
GROUND_TRUTH_TOPIC = "/ground_truth"

# tf2_msgs/TFMessage made from its definition: the Python package of tf2_msgs is needed for nothing else.
TFMessage = genpy.dynamic.generate_dynamic(
    "tf2_msgs/TFMessage",
    "geometry_msgs/TransformStamped[] transforms\n" + "=" * 80
    + "\nMSG: geometry_msgs/TransformStamped\n" + TransformStamped._full_text)["tf2_msgs/TFMessage"]


@dataclasses.dataclass
class Camera:
    """One camera of the rig and where its images are."""

    name: str                          # also frame_id and topic prefix
    resolution: Tuple[int, int]        # width, height [px]
    intrinsics: List[float]            # fx, fy, cx, cy [px]
    distortion_model: str              # none | radtan | equidistant
    distortion: List[float]
    T_body_cam: np.ndarray             # (4, 4)
    stamps_ns: np.ndarray              # (n,) of the images
    image_paths: List[pathlib.Path]    # (n,)
    projection: Optional[np.ndarray] = None  # (3, 4) P of rectified images
    position_sigma_m: Optional[float] = None  # where the calibration is better than rig files are taken to be


@dataclasses.dataclass
class ImuSensor:
    """The IMU of the rig and its samples; noise is continuous-time."""

    T_body_imu: np.ndarray             # (4, 4)
    rate_hz: float
    gyroscope_noise_density: float     # [rad/s/sqrt(Hz)]
    gyroscope_random_walk: float       # [rad/s^2/sqrt(Hz)]
    accelerometer_noise_density: float  # [m/s^2/sqrt(Hz)]
    accelerometer_random_walk: float   # [m/s^3/sqrt(Hz)]
    stamps_ns: np.ndarray              # (n,)
    angular_rates: np.ndarray          # (n, 3) [rad/s]
    specific_forces: np.ndarray        # (n, 3) [m/s^2]
    topic: str = "/imu"
    frame_id: str = "imu"


def beside(bag_path, suffix):
    """The file `<bag name without .bag><suffix>` beside a bag."""
    bag_path = pathlib.Path(bag_path)
    stem = bag_path.name[:-4] if bag_path.name.endswith(".bag") else bag_path.name
    return bag_path.with_name(stem + suffix)


def write_recording(bag_path, cameras, imu=None, ground_truth=None):
    """Writes the bag (time order, lz4), `.rig.yaml` and, with ground truth, `.groundtruth.tum` beside it."""
    bag_path = pathlib.Path(bag_path)
    bag_path.parent.mkdir(parents=True, exist_ok=True)
    streams = [_image_messages(camera) for camera in cameras]
    if imu is not None:
        streams.append(_imu_messages(imu))
    if ground_truth is not None:
        streams.append(_ground_truth_messages(ground_truth))
    counts = {}
    unfinished = bag_path.with_name(bag_path.name + ".unfinished")
    try:
        with rosbag.Bag(str(unfinished), "w", compression="lz4") as bag:
            for stamp_ns, topic, message in heapq.merge(*streams, key=lambda item: item[0]):
                if not counts:
                    bag.write("/tf_static", _static_transforms(cameras, imu, stamp_ns), _time(stamp_ns))
                bag.write(topic, message, _time(stamp_ns))
                counts[topic] = counts.get(topic, 0) + 1
        os.replace(unfinished, bag_path)
    finally:
        if unfinished.exists():
            unfinished.unlink()
    beside(bag_path, ".rig.yaml").write_text(rig_yaml(cameras, imu))
    if ground_truth is not None:
        write_tum(beside(bag_path, ".groundtruth.tum"), ground_truth)
    print(f"{bag_path}: " + ", ".join(f"{topic} {count}" for topic, count in sorted(counts.items())))


def rig_yaml(cameras, imu=None):
    """Text of the rig file (format 1)."""
    lines = ["# rig of multicam_egomotion", f"body_frame: {BODY_FRAME}", "cameras:"]
    for camera in cameras:
        lines += [f"  - name: {camera.name}",
                  f"    frame_id: {camera.name}",
                  f"    image_topic: /{camera.name}/image_raw",
                  f"    camera_info_topic: /{camera.name}/camera_info",
                  "    model: pinhole",
                  f"    resolution: [{camera.resolution[0]}, {camera.resolution[1]}]  # width, height [px]",
                  f"    intrinsics: {_numbers(camera.intrinsics)}  # fx, fy, cx, cy [px]",
                  f"    distortion_model: {camera.distortion_model}",
                  f"    distortion: {_numbers(camera.distortion)}",
                  *_matrix_lines("T_body_cam", camera.T_body_cam),
                  "    time_offset_s: 0.0  # t_imu = t_camera + time_offset_s"]
        if camera.position_sigma_m is not None:
            lines += ["    sigmas:", f"      position_m: {camera.position_sigma_m}"]
    if imu is not None:
        lines += ["imu:",
                  f"  frame_id: {imu.frame_id}",
                  f"  topic: {imu.topic}",
                  *(line[2:] for line in _matrix_lines("T_body_imu", imu.T_body_imu)),
                  f"  rate_hz: {imu.rate_hz:.6g}",
                  f"  gyroscope_noise_density: {imu.gyroscope_noise_density:.6e}  # rad/s/sqrt(Hz)",
                  f"  gyroscope_random_walk: {imu.gyroscope_random_walk:.6e}  # rad/s^2/sqrt(Hz)",
                  f"  accelerometer_noise_density: {imu.accelerometer_noise_density:.6e}  # m/s^2/sqrt(Hz)",
                  f"  accelerometer_random_walk: {imu.accelerometer_random_walk:.6e}  # m/s^3/sqrt(Hz)"]
    return "\n".join(lines) + "\n"


def _numbers(values):
    return "[" + ", ".join(repr(float(value)) for value in values) + "]"


def _matrix_lines(key, matrix):
    rows = [_numbers(row) for row in np.asarray(matrix)]
    lead = f"    {key}: ["
    return [(lead if i == 0 else " " * len(lead)) + row + (",", "]")[i == 3] for i, row in enumerate(rows)]


def _time(stamp_ns):
    seconds, nanoseconds = divmod(int(stamp_ns), 1_000_000_000)
    return rospy.Time(seconds, nanoseconds)


def _set_header(message, stamp_ns, frame_id):
    message.header.stamp = _time(stamp_ns)
    message.header.frame_id = frame_id


def _set_vector(target, values):
    target.x, target.y, target.z = (float(value) for value in values)


def _set_quaternion(target, rotation):
    target.x, target.y, target.z, target.w = (float(v) for v in rotations.quaternion_from_matrix(rotation))


def _image_messages(camera):
    info = _camera_info(camera)
    for stamp_ns, path in zip(camera.stamps_ns, camera.image_paths):
        pixels, encoding = read_image(path, camera.resolution)
        image = Image(height=pixels.shape[0], width=pixels.shape[1], encoding=encoding,
                      step=pixels.strides[0], data=pixels.tobytes())
        _set_header(image, stamp_ns, camera.name)
        _set_header(info, stamp_ns, camera.name)
        yield stamp_ns, f"/{camera.name}/image_raw", image
        yield stamp_ns, f"/{camera.name}/camera_info", info


def _camera_info(camera):
    fx, fy, cx, cy = camera.intrinsics
    info = CameraInfo(width=camera.resolution[0], height=camera.resolution[1])
    info.distortion_model = "equidistant" if camera.distortion_model == "equidistant" else "plumb_bob"
    coefficients = 4 if camera.distortion_model == "equidistant" else 5
    info.D = (list(camera.distortion) + [0.0] * 5)[:coefficients]
    info.K = [fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0]
    info.R = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
    unrectified = np.array([[fx, 0.0, cx, 0.0], [0.0, fy, cy, 0.0], [0.0, 0.0, 1.0, 0.0]])
    info.P = (unrectified if camera.projection is None else camera.projection).ravel().tolist()
    return info


def _imu_messages(imu):
    for stamp_ns, rate, force in zip(imu.stamps_ns, imu.angular_rates, imu.specific_forces):
        message = Imu()
        _set_header(message, stamp_ns, imu.frame_id)
        message.orientation.w = 1.0
        message.orientation_covariance[0] = -1.0  # no orientation
        _set_vector(message.angular_velocity, rate)
        _set_vector(message.linear_acceleration, force)
        message.angular_velocity_covariance[0::4] = [imu.gyroscope_noise_density ** 2 * imu.rate_hz] * 3
        message.linear_acceleration_covariance[0::4] = [imu.accelerometer_noise_density ** 2 * imu.rate_hz] * 3
        yield stamp_ns, imu.topic, message


def _ground_truth_messages(trajectory):
    for stamp_ns, position, rotation in zip(trajectory.stamps_ns, trajectory.positions, trajectory.rotations):
        message = Odometry(child_frame_id=BODY_FRAME)
        _set_header(message, stamp_ns, "ground_truth")
        _set_vector(message.pose.pose.position, position)
        _set_quaternion(message.pose.pose.orientation, rotation)
        yield stamp_ns, GROUND_TRUTH_TOPIC, message


def _static_transforms(cameras, imu, stamp_ns):
    children = [(camera.name, camera.T_body_cam) for camera in cameras]
    if imu is not None:
        children.append((imu.frame_id, imu.T_body_imu))
    transforms = []
    for child, T_body_child in children:
        transform = TransformStamped(child_frame_id=child)
        _set_header(transform, stamp_ns, BODY_FRAME)
        _set_vector(transform.transform.translation, T_body_child[:3, 3])
        _set_quaternion(transform.transform.rotation, T_body_child[:3, :3])
        transforms.append(transform)
    return TFMessage(transforms)
