# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
"""Smoothing cubic B-splines through poses, and the IMU that a body on such a path would measure.

The spline minimizes  sum |s(t_i) - y_i|^2 dt + cutoff^-6 * integral |s'''|^2 dt,  which passes motion slower than
`cutoff` and removes faster noise like a low-pass of order 6 without delay. Position is C2. Rotation is the same
spline through the four quaternion components, normalized, hence C2 too, and any number of turns is allowed.
"""

import numpy as np

import rotations

GRAVITY = 9.81  # [m/s^2]

# Basis matrix of the uniform cubic B-spline: row k holds the coefficients of u^k, column j the j-th control point.
BASIS = np.array([[1.0, 4.0, 1.0, 0.0], [-3.0, 0.0, 3.0, 0.0], [3.0, -6.0, 3.0, 0.0], [-1.0, 3.0, -3.0, 1.0]]) / 6.0
BAND = 4  # non-zero diagonals of the normal equations, the main one and those above it


class SmoothingSpline:
    """Uniform cubic B-spline fitted to samples `values` (n, d) at increasing `times` (n,) [s], n >= 3."""

    def __init__(self, times, values, cutoff_hz):
        self.start = times[0]
        self.intervals = intervals = len(times) - 1
        self.step = (times[-1] - times[0]) / intervals
        first, weights = self._basis(np.asarray(times), derivative=0)
        difference = np.array([-1.0, 3.0, -3.0, 1.0])
        penalty = (2.0 * np.pi * cutoff_hz * self.step) ** -6
        upper = np.zeros((BAND, intervals + 3))  # upper[k, i] = normal_matrix[i, i + k]
        right = np.zeros((intervals + 3, values.shape[1]))
        for a in range(BAND):
            np.add.at(right, first + a, weights[:, a, None] * values)
            for b in range(a, BAND):
                np.add.at(upper[b - a], first + a, weights[:, a] * weights[:, b])
                upper[b - a, a:a + intervals] += penalty * difference[a] * difference[b]
        self.controls = solve_banded(upper, right)

    def __call__(self, times, derivative=0):
        """Values (m, d) of the spline or of its first or second derivative at `times` (m,) [s]."""
        first, weights = self._basis(np.asarray(times), derivative)
        return np.einsum("ij,ijd->id", weights, self.controls[first[:, None] + np.arange(BAND)])

    def _basis(self, times, derivative):
        """Index of the first control point and the four weights of each time."""
        position = (times - self.start) / self.step
        first = np.clip(np.floor(position).astype(int), 0, self.intervals - 1)
        u = position - first
        one, zero = np.ones_like(u), np.zeros_like(u)
        powers = ([one, u, u ** 2, u ** 3], [zero, one, 2 * u, 3 * u ** 2], [zero, zero, 2 * one, 6 * u])[derivative]
        return first, np.stack(powers, axis=1) @ BASIS / self.step ** derivative


def solve_banded(upper, right):
    """Solves A x = right for symmetric positive definite A given as upper[k, i] = A[i, i + k] (Cholesky)."""
    band, n = upper.shape
    factor = upper.copy()
    x = right.astype(float).copy()
    for i in range(n):
        factor[:, i] /= np.sqrt(factor[0, i])
        x[i] /= factor[0, i]
        for k in range(1, min(band, n - i)):
            factor[:band - k, i + k] -= factor[k, i] * factor[k:, i]
            x[i + k] -= factor[k, i] * x[i]
    for i in range(n - 1, -1, -1):
        for k in range(1, min(band, n - i)):
            x[i] -= factor[k, i] * x[i + k]
        x[i] /= factor[0, i]
    return x


class SmoothTrajectory:
    """Position and rotation splines through poses: times (n,) [s], positions (n, 3) [m], R_world_body (n, 3, 3)."""

    def __init__(self, times, positions, matrices, position_cutoff_hz, rotation_cutoff_hz):
        quaternions = rotations.same_sign(rotations.quaternion_from_matrix(matrices))
        self.position_spline = SmoothingSpline(times, np.asarray(positions), position_cutoff_hz)
        self.rotation_spline = SmoothingSpline(times, quaternions, rotation_cutoff_hz)

    def rotation(self, times):
        """R_world_body (m, 3, 3)."""
        return rotations.matrix_from_quaternion(self.rotation_spline(times))

    def angular_rate(self, times):
        """Angular rate in the body frame (m, 3) [rad/s]: the vector part of 2 q^-1 dq/dt."""
        q, dq = self.rotation_spline(times), self.rotation_spline(times, 1)
        squared_norm = np.sum(q * q, axis=1, keepdims=True)
        return 2.0 * rotations.multiply(rotations.conjugate(q), dq)[:, :3] / squared_norm

    def specific_force(self, times):
        """What an accelerometer at the body origin measures (m, 3) [m/s^2]; the world's z points up."""
        acceleration = self.position_spline(times, 2) + np.array([0.0, 0.0, GRAVITY])
        return np.einsum("iba,ib->ia", self.rotation(times), acceleration)
