# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
"""Consistency of reported covariances: normalized estimation error squared (NEES) against ground truth.

An honest covariance has a mean NEES of 1 per degree of freedom, and 95 % of the values inside the chi-square bound.
Errors follow the messages: position additive in the axes of the header frame, rotation R_true = Exp(d) R.
"""

import numpy as np

import rotations
from trajectory_errors import STANDING_BELOW_M, relative_motion
from trajectory_io import Trajectory

CHI_SQUARE_95 = {1: 3.841, 2: 5.991, 3: 7.815, 6: 12.592}
POSITION, ROTATION = slice(0, 3), slice(3, 6)


def nees(errors, covariances):
    """e^T C^-1 e of errors (n, d) and covariances (n, d, d)."""
    return np.einsum("ni,ni->n", errors, np.linalg.solve(covariances, errors[..., None])[..., 0])


def summarize(values, dof):
    """Mean per degree of freedom and percentage inside the 95 % bound."""
    return {"frames": len(values), "dof": dof, "mean_per_dof": float(np.mean(values)) / dof,
            "inside_95_percent": 100.0 * float(np.mean(values <= CHI_SQUARE_95[dof]))}


def usable(covariances):
    """Mask of the covariances that are finite and positive definite."""
    finite = np.isfinite(covariances).all(axis=(1, 2))
    mask = finite.copy()
    mask[finite] = np.linalg.eigvalsh(covariances[finite])[:, 0] > 0.0
    return mask


def direction_basis(vectors):
    """Orthonormal bases (n, 3, 3) whose last column is the direction of each vector; zero vectors count as x."""
    norms = np.linalg.norm(vectors, axis=1, keepdims=True)
    along = np.where(norms > 0.0, vectors / np.where(norms > 0.0, norms, 1.0), [1.0, 0.0, 0.0])
    smallest = np.eye(3)[np.argmin(np.abs(along), axis=1)]
    across = np.cross(along, smallest)
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    return np.stack([across, np.cross(along, across), along], axis=2)


def true_motion(ground_truth, previous_stamps_ns, stamps_ns):
    """True body at `stamps_ns` in the body at `previous_stamps_ns`: (positions, rotations, mask of known ones)."""
    before, known_before = ground_truth.interpolate(previous_stamps_ns)
    now, known_now = ground_truth.interpolate(stamps_ns)
    count = len(stamps_ns)
    both = Trajectory(np.concatenate([before.positions, now.positions]),
                      np.concatenate([before.rotations, now.rotations]))
    positions, matrices = relative_motion(both, np.arange(count), np.arange(count, 2 * count))
    return positions, matrices, known_before & known_now & (previous_stamps_ns < stamps_ns)


def relative_consistency(ground_truth, relative, previous_stamps_ns, scale_states=None):
    """NEES of frame-to-frame poses: body at the pose's stamp in the body at `previous_stamps_ns` (n,).

    `relative` is a Trajectory whose poses are those relative poses. Rotation (3 dof), direction of translation
    (2 dof, across the estimated translation) and scale (1 dof, along it) are separate; with `scale_states` (n,),
    scale is also given for the frames that call it OBSERVABLE.
    """
    p_gt, R_gt, mask = true_motion(ground_truth, previous_stamps_ns, relative.stamps_ns)
    known = np.count_nonzero(mask)
    mask &= usable(relative.covariances)
    report = {"skipped_frames": int(known - np.count_nonzero(mask))}
    if not mask.any():
        return report
    p_gt, R_gt, estimate = p_gt[mask], R_gt[mask], relative.select(mask)
    rotation_error = rotations.log(R_gt @ np.swapaxes(estimate.rotations, 1, 2))
    basis = direction_basis(estimate.positions)
    error = np.einsum("nji,nj->ni", basis, p_gt - estimate.positions)
    covariance = np.swapaxes(basis, 1, 2) @ estimate.covariances[:, POSITION, POSITION] @ basis
    scale_nees = nees(error[:, 2:], covariance[:, 2:, 2:])
    report["rotation"] = summarize(nees(rotation_error, estimate.covariances[:, ROTATION, ROTATION]), 3)
    report["direction"] = summarize(nees(error[:, :2], covariance[:, :2, :2]), 2)
    report["scale"] = summarize(scale_nees, 1)
    if scale_states is not None and np.any(scale_states[mask] == "OBSERVABLE"):
        report["scale where observable"] = summarize(scale_nees[scale_states[mask] == "OBSERVABLE"], 1)
    return report


def scale_errors_by_state(ground_truth, relative, previous_stamps_ns, scale_states):
    """For each scale state: its frames and the median error of the translation's length against the true one."""
    p_gt, _, mask = true_motion(ground_truth, previous_stamps_ns, relative.stamps_ns)
    lengths = np.linalg.norm(p_gt, axis=1)
    mask &= lengths >= STANDING_BELOW_M
    errors = 100.0 * np.abs(np.linalg.norm(relative.positions[mask], axis=1) / lengths[mask] - 1.0)
    states = scale_states[mask]
    return {str(state): {"frames": int(np.count_nonzero(states == state)),
                         "median_error_percent": float(np.median(errors[states == state]))}
            for state in np.unique(states)}


def accumulated_consistency(ground_truth, estimate):
    """NEES of accumulated poses (associated): odom starts at the first pose, with its heading; z is up in both."""
    turn = estimate.rotations[0] @ ground_truth.rotations[0].T
    R = rotations.exp([0.0, 0.0, np.arctan2(turn[1, 0] - turn[0, 1], turn[0, 0] + turn[1, 1])])
    expected = (ground_truth.positions - ground_truth.positions[0]) @ R.T + estimate.positions[0]
    rotation_error = rotations.log(R @ ground_truth.rotations @ np.swapaxes(estimate.rotations, 1, 2))
    errors = np.concatenate([expected - estimate.positions, rotation_error], axis=1)[1:]
    mask = usable(estimate.covariances[1:])
    if not mask.any():
        return {"skipped_frames": len(mask)}
    errors, covariances = errors[mask], estimate.covariances[1:][mask]
    return {
        "skipped_frames": int(np.count_nonzero(~mask)),
        "position": summarize(nees(errors[:, POSITION], covariances[:, POSITION, POSITION]), 3),
        "rotation": summarize(nees(errors[:, ROTATION], covariances[:, ROTATION, ROTATION]), 3),
        "pose": summarize(nees(errors, covariances), 6),
    }
