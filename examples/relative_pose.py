#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
"""Relative pose of a stereo rig from pixels, outliers among them, and the vertical in both frames."""
import numpy as np
from multicam_egomotion_solvers import Camera, CameraRig, MotionPriors, VerticalPrior, estimate_from_pixels

R_body_cam = np.array([[0, 0, 1], [-1, 0, 0], [0, -1, 0]])  # the cameras look along body x
centers = np.array([[0, 0.5, 0], [0, -0.5, 0]])
poses = [np.block([[R_body_cam, c[:, None]], [np.zeros(3), 1]]) for c in centers]
rig = CameraRig([Camera(640, 480, fx=400, fy=400, cx=320, cy=240, T_body_cam=T) for T in poses])

rng = np.random.default_rng(1)
R = np.array([[np.cos(0.1), -np.sin(0.1), 0], [np.sin(0.1), np.cos(0.1), 0], [0, 0, 1]])  # body t1 -> body t2
t = np.array([-0.8, 0.3, 0.05])
points = rng.uniform([6, -3, -2], [16, 3, 2], (300, 3))  # in the body at t1
cameras1, cameras2 = np.arange(300) % 2, np.arange(300) // 2 % 2
optical1, optical2 = (points - centers[cameras1]) @ R_body_cam, (points @ R.T + t - centers[cameras2]) @ R_body_cam
pixels1, pixels2 = (400 * p[:, :2] / p[:, 2:] + [320, 240] + rng.normal(0, 0.3, (300, 2)) for p in (optical1, optical2))
pixels2[::3] = rng.uniform(0, 480, (100, 2))  # one in three is an outlier

up1, up2 = [0, 0, 1], R @ [0, 0, 1]
priors = MotionPriors(up1=up1, up2=up2, tilt_sigma=np.radians(0.5))
found = estimate_from_pixels("4pt-vertical", rig, cameras1, pixels1, cameras2, pixels2, VerticalPrior(up1, up2),
                             priors=priors)
print(found, "t =", found.t.round(3), "+-", np.sqrt(np.diag(found.covariance)[:3]).round(3))
assert found.success and np.allclose(found.R, R, atol=0.01) and np.allclose(found.t, t, atol=0.1)
