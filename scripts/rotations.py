# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
"""Rotations with numpy: quaternions are (x, y, z, w), arrays may carry leading dimensions, angles are radians."""

import numpy as np


def skew(v):
    """Matrices with skew(v) @ u == v x u, shape (..., 3, 3)."""
    v = np.asarray(v, dtype=float)
    zero = np.zeros(v.shape[:-1])
    x, y, z = v[..., 0], v[..., 1], v[..., 2]
    return np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=-1).reshape(v.shape[:-1] + (3, 3))


def exp(rotation_vector):
    """Rotation matrices of rotation vectors [rad]."""
    return matrix_from_quaternion(quaternion_from_vector(rotation_vector))


def log(matrix):
    """Rotation vectors [rad] of rotation matrices, norm in [0, pi]."""
    q = quaternion_from_matrix(matrix)
    q = q * np.where(q[..., 3:] < 0.0, -1.0, 1.0)
    sine = np.linalg.norm(q[..., :3], axis=-1, keepdims=True)
    angle = 2.0 * np.arctan2(sine, q[..., 3:])
    scale = np.where(sine > 1e-9, angle / np.maximum(sine, 1e-9), 2.0)
    return q[..., :3] * scale


def quaternion_from_vector(rotation_vector):
    """Unit quaternions of rotation vectors [rad]."""
    v = np.asarray(rotation_vector, dtype=float)
    angle = np.linalg.norm(v, axis=-1, keepdims=True)
    return np.concatenate([v * 0.5 * np.sinc(angle / (2.0 * np.pi)), np.cos(0.5 * angle)], axis=-1)


def multiply(a, b):
    """Hamilton product of quaternions."""
    a, b = np.asarray(a, dtype=float), np.asarray(b, dtype=float)
    vector = a[..., 3:] * b[..., :3] + b[..., 3:] * a[..., :3] + np.cross(a[..., :3], b[..., :3])
    scalar = a[..., 3:] * b[..., 3:] - np.sum(a[..., :3] * b[..., :3], axis=-1, keepdims=True)
    return np.concatenate([vector, scalar], axis=-1)


def conjugate(q):
    """Inverse of unit quaternions."""
    return np.asarray(q, dtype=float) * np.array([-1.0, -1.0, -1.0, 1.0])


def matrix_from_quaternion(q):
    """Rotation matrices of quaternions, which are normalized first."""
    q = np.asarray(q, dtype=float)
    q = q / np.linalg.norm(q, axis=-1, keepdims=True)
    cross = skew(q[..., :3])
    return np.eye(3) + 2.0 * q[..., 3, None, None] * cross + 2.0 * cross @ cross


def quaternion_from_matrix(matrix):
    """Unit quaternions of rotation matrices, computed from the largest of the four components (Shepperd)."""
    m = np.asarray(matrix, dtype=float)
    d = np.diagonal(m, axis1=-2, axis2=-1)
    trace = d.sum(axis=-1)
    four_squares = np.stack([1.0 - trace + 2.0 * d[..., 0], 1.0 - trace + 2.0 * d[..., 1],
                             1.0 - trace + 2.0 * d[..., 2], 1.0 + trace], axis=-1)
    wx, wy, wz = m[..., 2, 1] - m[..., 1, 2], m[..., 0, 2] - m[..., 2, 0], m[..., 1, 0] - m[..., 0, 1]
    xy, xz, yz = m[..., 0, 1] + m[..., 1, 0], m[..., 0, 2] + m[..., 2, 0], m[..., 1, 2] + m[..., 2, 1]
    sx, sy, sz, sw = (four_squares[..., i] for i in range(4))
    candidates = np.stack([np.stack(row, axis=-1) for row in
                           ((sx, xy, xz, wx), (xy, sy, yz, wy), (xz, yz, sz, wz), (wx, wy, wz, sw))], axis=-2)
    largest = np.argmax(four_squares, axis=-1)[..., None, None]
    q = np.take_along_axis(candidates, largest, axis=-2)[..., 0, :]
    return q / np.linalg.norm(q, axis=-1, keepdims=True)


def same_sign(q):
    """A sequence of quaternions with signs flipped so that neighbours are on the same half sphere."""
    q = np.array(q, dtype=float)
    flips = np.where(np.sum(q[1:] * q[:-1], axis=-1) < 0.0, -1.0, 1.0)
    q[1:] *= np.cumprod(flips)[:, None]
    return q


def slerp(a, b, fraction):
    """Rotation matrices on the shortest arc from a (fraction 0) to b (fraction 1)."""
    return a @ exp(log(np.swapaxes(a, -1, -2) @ b) * np.asarray(fraction, dtype=float)[..., None])
