# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
"""Errors of an estimated trajectory against ground truth. Worlds have z up; both trajectories are of the same body."""

import numpy as np

import rotations
from dataset_files import InputError
from trajectory_io import NS, Trajectory

PERCENT_OF_PATH_ABOVE_M = 20.0     # shorter paths make any ATE look good in percent
SEGMENT_LENGTHS_M = (1.0, 5.0, 10.0, 50.0, 100.0)
SEGMENT_DURATION_S = 0.5
STANDING_BELOW_M = 1e-3            # a direction of translation means nothing below this

# Alignments of the estimate to ground truth, with their names in reports.
ALIGNMENTS = {"position_yaw": "position + yaw", "se3": "SE(3)", "sim3": "Sim(3)"}


def associate(ground_truth, estimate, max_gap_s=0.5):
    """Ground truth at the poses of the estimate: (ground truth, estimate, number of unmatched estimate poses).

    With stamps, ground truth is interpolated; without, line i belongs to line i and the counts must agree.
    """
    if (ground_truth.stamps_ns is None) != (estimate.stamps_ns is None):
        raise InputError("found stamps in only one of the two trajectories, expected both or none (--times)")
    if estimate.stamps_ns is None:
        if len(ground_truth) != len(estimate):
            raise InputError(f"found {len(estimate)} poses in the estimate, expected {len(ground_truth)} "
                             "as in the ground truth (trajectories without stamps are matched line by line)")
        return ground_truth, estimate, 0
    if len(ground_truth) < 2:
        raise InputError(f"found {len(ground_truth)} ground truth poses, expected at least 2")
    matched, inside = ground_truth.interpolate(estimate.stamps_ns, max_gap_s)
    if np.count_nonzero(inside) < 2:
        raise InputError(f"found {np.count_nonzero(inside)} estimate stamps within the ground truth's, "
                         "expected at least 2")
    return matched.select(inside), estimate.select(inside), int(np.count_nonzero(~inside))


def align(ground_truth, estimate, kind):
    """(aligned estimate, scale): least squares over positions, of a kind in ALIGNMENTS."""
    mean_gt, mean_est = ground_truth.positions.mean(axis=0), estimate.positions.mean(axis=0)
    gt, est = ground_truth.positions - mean_gt, estimate.positions - mean_est
    covariance = gt.T @ est
    scale = 1.0
    if kind == "position_yaw":
        R = rotations.exp([0.0, 0.0, np.arctan2(covariance[1, 0] - covariance[0, 1],
                                                covariance[0, 0] + covariance[1, 1])])
    else:  # Umeyama 1991
        U, singular, Vt = np.linalg.svd(covariance)
        sign = np.array([1.0, 1.0, np.sign(np.linalg.det(U @ Vt))])
        R = U @ np.diag(sign) @ Vt
        if kind == "sim3" and np.any(est):
            scale = float(singular @ sign / np.sum(est ** 2))
    positions = scale * est @ R.T + mean_gt
    return Trajectory(positions, R @ estimate.rotations, estimate.stamps_ns), scale


def absolute_errors(ground_truth, estimate):
    """ATE of each alignment, and that of an estimate that never moves, for comparison."""
    path = ground_truth.path_lengths()[-1]
    report = {}
    for kind in ALIGNMENTS:
        aligned, scale = align(ground_truth, estimate, kind)
        report[kind] = _absolute_error(aligned.positions - ground_truth.positions, path)
        if kind == "sim3":
            report[kind]["scale"] = scale
    report["never_moving"] = _absolute_error(ground_truth.positions - ground_truth.positions.mean(axis=0), path)
    return report


def _absolute_error(differences, path):
    distances = np.linalg.norm(differences, axis=1)
    error = {"rmse_m": rms(distances), "max_m": float(distances.max())}
    if path > PERCENT_OF_PATH_ABOVE_M:
        error["percent_of_path"] = 100.0 * error["rmse_m"] / path
    return error


def rms(values):
    """Root mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def relative_motion(trajectory, first, second):
    """Body at the indices `second` in the body at `first`: (positions (n, 3), rotations (n, 3, 3))."""
    R_first = np.swapaxes(trajectory.rotations[first], -1, -2)
    moved = trajectory.positions[second] - trajectory.positions[first]
    return np.einsum("nij,nj->ni", R_first, moved), R_first @ trajectory.rotations[second]


def motion_errors(ground_truth, estimate, first, second):
    """(translation error [m], rotation error [rad]) of the motions from `first` to `second`."""
    p_gt, R_gt = relative_motion(ground_truth, first, second)
    p_est, R_est = relative_motion(estimate, first, second)
    return np.linalg.norm(p_est - p_gt, axis=1), rotation_angle(R_gt, R_est)


def rotation_angle(a, b):
    """Angles between rotations [rad], exact for small ones: 2 asin(|a - b|_F / (2 sqrt 2))."""
    chord = np.linalg.norm(a - b, axis=(-2, -1)) / (2.0 * np.sqrt(2.0))
    return 2.0 * np.arcsin(np.clip(chord, 0.0, 1.0))


def segments_by_length(path_lengths, length):
    """Index pairs (first, second): second is the first pose at least `length` [m] further along the path."""
    second = np.searchsorted(path_lengths, path_lengths + length, side="left")
    first = np.flatnonzero(second < len(path_lengths))
    return first, second[first]


def segments_by_duration(stamps_ns, duration_s):
    """Index pairs (first, second): second is the pose nearest to `duration_s` later, within a tenth of it."""
    target = stamps_ns + int(duration_s * NS)
    after = np.clip(np.searchsorted(stamps_ns, target), 1, len(stamps_ns) - 1)
    second = np.where(target - stamps_ns[after - 1] < stamps_ns[after] - target, after - 1, after)
    first = np.flatnonzero(np.abs(stamps_ns[second] - target) <= 0.1 * duration_s * NS)
    return first, second[first]


def relative_errors(ground_truth, estimate):
    """Errors over 0.5 s (with stamps) and over each segment length that the path is long enough for."""
    path = ground_truth.path_lengths()
    kinds = [(f"{length:g} m", length, segments_by_length(path, length)) for length in SEGMENT_LENGTHS_M]
    if ground_truth.stamps_ns is not None:
        kinds.insert(0, (f"{SEGMENT_DURATION_S:g} s", None,
                         segments_by_duration(ground_truth.stamps_ns, SEGMENT_DURATION_S)))
    report = []
    for name, length, (first, second) in kinds:
        if first.size == 0:
            continue
        translation, rotation = motion_errors(ground_truth, estimate, first, second)
        rotation = np.degrees(rotation)
        travelled = np.maximum(path[second] - path[first], STANDING_BELOW_M) if length is None else length
        report.append({"over": name, "segments": int(first.size),
                       "translation_median_m": float(np.median(translation)), "translation_rmse_m": rms(translation),
                       "translation_median_percent": float(np.median(100.0 * translation / travelled)),
                       "drift_percent": float(np.mean(100.0 * translation / travelled)),
                       "rotation_median_deg": float(np.median(rotation)), "rotation_rmse_deg": rms(rotation)})
    return report


def direction_angles(a, b):
    """Angles between vectors [rad], atan2(|a x b|, a.b); a zero vector has no direction and counts as 90 deg."""
    angles = np.arctan2(np.linalg.norm(np.cross(a, b), axis=-1), np.sum(a * b, axis=-1))
    return np.where(np.linalg.norm(a, axis=-1) * np.linalg.norm(b, axis=-1) > 0.0, angles, np.pi / 2.0)


def frame_to_frame_errors(ground_truth, estimate):
    """The paper's errors between consecutive poses (body at t2 in the body at t1), and of always moving straight ahead.

    Straight ahead is the body axis (x, y or z, either sign) nearest to the mean direction of the true motion.
    """
    second = np.arange(1, len(ground_truth))
    p_gt, R_gt = relative_motion(ground_truth, second - 1, second)
    p_est, R_est = relative_motion(estimate, second - 1, second)
    moving = np.linalg.norm(p_gt, axis=1) >= STANDING_BELOW_M
    report = {"frames": int(second.size), "standing_frames": int(np.count_nonzero(~moving)),
              "rotation_median_deg": float(np.degrees(np.median(rotation_angle(R_gt, R_est))))}
    if moving.any():
        p_gt, p_est = p_gt[moving], p_est[moving]
        mean = np.mean(p_gt / np.linalg.norm(p_gt, axis=1, keepdims=True), axis=0)
        axis = np.argmax(np.abs(mean))
        ahead = np.broadcast_to(np.sign(mean[axis]) * np.eye(3)[axis], p_gt.shape)
        report["direction_median_deg"] = float(np.degrees(np.median(direction_angles(p_est, p_gt))))
        report["straight_ahead_median_deg"] = float(np.degrees(np.median(direction_angles(ahead, p_gt))))
    return report
