# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
"""Rig files made of others: one camera turned about one of its own axes, or without the sigmas."""

import numpy as np
import yaml

import rotations
from dataset_files import InputError, require_file

AXES = "xyz"


def read_rig(path):
    """The content of a rig file of our own format."""
    try:
        rig = yaml.safe_load(require_file(path).read_text())
    except yaml.YAMLError as error:
        raise InputError(f"{path}: is not YAML: {error}") from None
    if not isinstance(rig, dict) or not isinstance(rig.get("cameras"), list):
        raise InputError(f"{path}: found no list of cameras, expected a rig file of multicam_egomotion")
    return rig


def camera_names(rig):
    """The names of all cameras."""
    return [camera["name"] for camera in rig["cameras"]]


def write_turned(path, rig, camera, axis, degrees):
    """Writes the rig with T_body_cam = T_body_cam * Exp(angle * axis) of a camera; `axis` is x, y or z."""
    cameras = [dict(one) for one in rig["cameras"]]
    transform = np.array(cameras[camera]["T_body_cam"], dtype=float).reshape(4, 4)
    transform[:3, :3] = transform[:3, :3] @ rotations.exp(np.radians(degrees) * np.eye(3)[AXES.index(axis)])
    cameras[camera]["T_body_cam"] = transform.tolist()
    path.write_text(yaml.safe_dump({**rig, "cameras": cameras}, sort_keys=False))


def write_without_sigmas(path, rig):
    """Writes the rig without what it says of its own errors, for a program that does not know these keys."""
    rig = {**rig, "cameras": [{key: value for key, value in camera.items() if key != "sigmas"}
                              for camera in rig["cameras"]]}
    rig["imu"] = {key: value for key, value in rig["imu"].items() if key != "mounting_sigma_deg"}
    path.write_text(yaml.safe_dump(rig, sort_keys=False))


def turns(rig, degrees):
    """(name, camera, axis, degrees) of each further camera, each of its axes and each angle."""
    return [(f"{name} {axis} {angle:g} deg", camera, axis, angle)
            for camera, name in list(enumerate(camera_names(rig)))[1:] for axis in AXES for angle in degrees]
