# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
"""Picture of an evaluation: trajectory from above and from the side, errors over the distance travelled."""

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

from trajectory_errors import rotation_angle  # noqa: E402

TRUTH = {"color": "black", "linewidth": 3.0, "label": "ground truth"}
ESTIMATE = {"color": "#d1495b", "linewidth": 1.4, "label": "estimate"}


def principal_horizontal(positions):
    """Horizontal unit vector along which the positions spread most, pointing from the first to the last one."""
    horizontal = positions[:, :2] - positions[:, :2].mean(axis=0)
    axis = np.linalg.svd(horizontal, full_matrices=False)[2][0]
    return axis if axis @ (positions[-1, :2] - positions[0, :2]) >= 0.0 else -axis


def plot(path, ground_truth, aligned, title):
    """Writes a PNG; `aligned` is the estimate after alignment, pose by pose with the ground truth, z up."""
    figure, ((top, side), (position, rotation)) = plt.subplots(2, 2, figsize=(12, 9))
    _plot_top_view(top, ground_truth, aligned)
    _plot_side_view(side, ground_truth, aligned)
    distance = ground_truth.path_lengths()
    differences = aligned.positions - ground_truth.positions
    position.plot(distance, np.linalg.norm(differences, axis=1), color=ESTIMATE["color"], label="position")
    position.plot(distance, np.abs(differences[:, 2]), color="#30638e", linewidth=1.0, label="vertical part")
    position.set(title="Position error", xlabel="distance travelled [m]", ylabel="error [m]")
    angles = np.degrees(rotation_angle(ground_truth.rotations, aligned.rotations))
    rotation.plot(distance, angles, color=ESTIMATE["color"])
    rotation.set(title="Rotation error", xlabel="distance travelled [m]", ylabel="error [deg]")
    for axes in (position, rotation):
        axes.set_ylim(bottom=0.0)
        axes.grid(alpha=0.3)
    position.legend()
    figure.suptitle(title)
    figure.tight_layout()
    figure.savefig(str(path), dpi=110)
    plt.close(figure)


def _plot_top_view(axes, ground_truth, aligned):
    for trajectory, style in ((ground_truth, TRUTH), (aligned, ESTIMATE)):
        axes.plot(trajectory.positions[:, 0], trajectory.positions[:, 1], **style)
    axes.plot(*ground_truth.positions[0, :2], "o", color="black", markersize=6, label="start")
    axes.set_aspect("equal", adjustable="datalim")
    axes.set(title="From above", xlabel="x [m]", ylabel="y [m]")
    axes.grid(alpha=0.3)
    axes.legend()


def _plot_side_view(axes, ground_truth, aligned):
    along = principal_horizontal(ground_truth.positions)
    for trajectory, style in ((ground_truth, TRUTH), (aligned, ESTIMATE)):
        axes.plot((trajectory.positions[:, :2] - ground_truth.positions[0, :2]) @ along,
                  trajectory.positions[:, 2], **style)
    axes.plot(0.0, ground_truth.positions[0, 2], "o", color="black", markersize=6)
    axes.set(title="From the side (axes scaled differently)",
             xlabel="along the main horizontal direction [m]", ylabel="z [m]")
    axes.grid(alpha=0.3)
