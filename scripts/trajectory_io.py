# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
"""Trajectories in memory and on disk: TUM (`t x y z qx qy qz qw`), KITTI (12 numbers a line) and rosbag odometry."""

import dataclasses
import pathlib
from typing import Optional

import numpy as np

import rotations
from dataset_files import InputError, read_lines, require_count, require_file, require_increasing

NS = 1_000_000_000


@dataclasses.dataclass
class Trajectory:
    """Poses of a body in a fixed world frame: p_world = rotations @ p_body + positions."""

    positions: np.ndarray                     # (n, 3) [m]
    rotations: np.ndarray                     # (n, 3, 3) R_world_body
    stamps_ns: Optional[np.ndarray] = None    # (n,) int64 [ns]; None where the format has no stamps
    covariances: Optional[np.ndarray] = None  # (n, 6, 6) x y z [m], rotx roty rotz [rad]
    y_down: bool = False                      # the world is a KITTI camera's: y down; otherwise z is up

    def __len__(self):
        return len(self.positions)

    def select(self, index):
        """The poses of an index array, slice or mask."""
        stamps_ns = None if self.stamps_ns is None else self.stamps_ns[index]
        covariances = None if self.covariances is None else self.covariances[index]
        return Trajectory(self.positions[index], self.rotations[index], stamps_ns, covariances, self.y_down)

    def path_lengths(self):
        """Distance travelled from the first pose to each pose [m]."""
        steps = np.linalg.norm(np.diff(self.positions, axis=0), axis=1)
        return np.concatenate([[0.0], np.cumsum(steps)])

    def interpolate(self, stamps_ns, max_gap_s=0.5):
        """Poses at other stamps (linear, slerp) and a mask of the stamps inside, in gaps of at most `max_gap_s`."""
        own = self.stamps_ns
        after = np.clip(np.searchsorted(own, stamps_ns, side="left"), 1, len(own) - 1)
        before = after - 1
        gap = own[after] - own[before]
        fraction = (stamps_ns - own[before]) / gap
        inside = (stamps_ns >= own[0]) & (stamps_ns <= own[-1])
        inside &= (gap <= max_gap_s * NS) | (fraction == 0.0) | (fraction == 1.0)
        positions = self.positions[before] + fraction[:, None] * (self.positions[after] - self.positions[before])
        turned = rotations.slerp(self.rotations[before], self.rotations[after], fraction)
        return Trajectory(positions, turned, np.asarray(stamps_ns)), inside


def stamp_ns(text):
    """Exact nanoseconds of a decimal number of seconds (exponents allowed)."""
    if "e" in text.lower():
        return int(round(float(text) * NS))
    sign = -1 if text.startswith("-") else 1
    whole, _, fraction = text.lstrip("+-").partition(".")
    return sign * (int(whole or 0) * NS + int((fraction + "000000000")[:9]))


def stamp_text(ns):
    """Seconds with nine decimals of integer nanoseconds."""
    return f"{int(ns) // NS}.{int(ns) % NS:09d}"


def read_tum(path):
    """Trajectory of a TUM file; stamps must increase."""
    rows = [line.replace(",", " ").split() for line in read_lines(path)]
    for number, row in enumerate(rows, start=1):
        require_count(f"{path}, pose {number}", len(row), 8, "columns", "TUM: t x y z qx qy qz qw")
    try:
        stamps = np.array([stamp_ns(row[0]) for row in rows], dtype=np.int64)
        values = np.array([[float(cell) for cell in row[1:]] for row in rows])
    except ValueError as error:
        raise InputError(f"{path}: {error}, expected TUM: t x y z qx qy qz qw") from None
    require_increasing(path, stamps)
    return Trajectory(values[:, :3], rotations.matrix_from_quaternion(values[:, 3:]), stamps)


def write_tum(path, trajectory):
    """Writes stamps with nine decimals, positions [m] and quaternions."""
    quaternions = rotations.quaternion_from_matrix(trajectory.rotations)
    with open(path, "w") as file:
        file.write("# t[s] x y z[m] qx qy qz qw\n")
        for stamp, position, quaternion in zip(trajectory.stamps_ns, trajectory.positions, quaternions):
            numbers = " ".join(f"{value:.9f}" for value in (*position, *quaternion))
            file.write(f"{stamp_text(stamp)} {numbers}\n")


def read_kitti(path, times=None):
    """Trajectory of a KITTI pose file (rows of [R t], row-major); `times` is a file of one stamp [s] a line."""
    rows = [line.split() for line in read_lines(path)]
    for number, row in enumerate(rows, start=1):
        require_count(f"{path}, pose {number}", len(row), 12, "columns", "KITTI: 3x4 matrix, row-major")
    try:
        poses = np.array([[float(cell) for cell in row] for row in rows]).reshape(-1, 3, 4)
    except ValueError as error:
        raise InputError(f"{path}: {error}, expected 12 numbers a line") from None
    orthonormal = rotations.matrix_from_quaternion(rotations.quaternion_from_matrix(poses[:, :, :3]))
    trajectory = Trajectory(poses[:, :, 3], orthonormal, y_down=True)
    if times is not None:
        lines = read_lines(times)
        require_count(times, len(lines), len(trajectory), "stamps", f"the number of poses in {path}")
        trajectory.stamps_ns = np.array([stamp_ns(line) for line in lines], dtype=np.int64)
        require_increasing(times, trajectory.stamps_ns)
    return trajectory


def find_topic(bag, path, name):
    """The topic of an open bag that is `name`, or the only one that ends in `/name` (any namespace)."""
    topics = sorted(bag.get_type_and_topic_info().topics)
    suffix = "/" + name.lstrip("/")
    matches = [topic for topic in topics if "/" + topic.lstrip("/") == suffix] \
        or [topic for topic in topics if topic.endswith(suffix)]
    if len(matches) != 1:
        raise InputError(f"{path}: found {len(matches)} topics {name}, expected one; topics: {', '.join(topics)}")
    return matches[0]


def has_topic(path, name):
    """Whether a bag has a topic `name`, in whatever namespace."""
    import rosbag
    with rosbag.Bag(str(require_file(path))) as bag:
        return any(("/" + topic.lstrip("/")).endswith("/" + name.lstrip("/"))
                   for topic in bag.get_type_and_topic_info().topics)


def read_bag_odometry(path, topic):
    """Trajectory with covariances of a nav_msgs/Odometry or geometry_msgs/PoseStamped topic; header stamps."""
    import rosbag  # only bags need ROS
    stamps, poses, covariances = [], [], []
    with rosbag.Bag(str(require_file(path))) as bag:
        for _, message, _ in bag.read_messages(topics=[find_topic(bag, path, topic)]):
            pose = message.pose.pose if hasattr(message.pose, "pose") else message.pose
            p, q = pose.position, pose.orientation
            stamps.append(message.header.stamp.to_nsec())
            poses.append([p.x, p.y, p.z, q.x, q.y, q.z, q.w])
            covariances.append(getattr(message.pose, "covariance", [0.0] * 36))
    stamps, order = np.unique(np.array(stamps, dtype=np.int64), return_index=True)
    poses = np.array(poses)[order]
    covariances = np.array(covariances).reshape(-1, 6, 6)[order]
    known = covariances if np.any(covariances) else None
    return Trajectory(poses[:, :3], rotations.matrix_from_quaternion(poses[:, 3:]), stamps, known)


@dataclasses.dataclass
class FrameRecord:
    """What an EgoMotion message says of a frame beside its pose."""

    previous_stamp_ns: int
    scale_state: str      # NOT_APPLICABLE | OBSERVABLE | WEAK | UNOBSERVABLE


def read_bag_frame_records(path, topic):
    """FrameRecord by stamp [ns] of the frames with a relative pose on a multicam_egomotion/EgoMotion topic."""
    import rosbag
    records = {}
    with rosbag.Bag(str(require_file(path))) as bag:
        for _, message, _ in bag.read_messages(topics=[find_topic(bag, path, topic)]):
            if message.has_relative_pose:
                states = {message.SCALE_NOT_APPLICABLE: "NOT_APPLICABLE", message.SCALE_OBSERVABLE: "OBSERVABLE",
                          message.SCALE_WEAK: "WEAK", message.SCALE_UNOBSERVABLE: "UNOBSERVABLE"}
                records[message.header.stamp.to_nsec()] = FrameRecord(message.previous_stamp.to_nsec(),
                                                                      states[message.scale_state])
    return records


def read_trajectory(path, topic, times=None):
    """Reads a bag (by suffix, `topic`), a TUM file (8 columns) or a KITTI file (12 columns)."""
    path = pathlib.Path(path)
    if path.suffix == ".bag":
        return read_bag_odometry(path, topic)
    lines = read_lines(path)
    if not lines:
        raise InputError(f"{path}: found no poses, expected TUM or KITTI lines")
    columns = len(lines[0].replace(",", " ").split())
    if columns == 8:
        return read_tum(path)
    if columns == 12:
        return read_kitti(path, times)
    raise InputError(f"{path}: found {columns} columns, expected 8 (TUM) or 12 (KITTI)")
