#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
"""Writes a KITTI recording as a bag, with its rig (OUT.rig.yaml) and ground truth (OUT.groundtruth.tum) beside it.

KITTI odometry: kitti_to_bag.py SEQUENCE_DIR OUT.bag [--poses FILE]
  base_link is the left grey camera with x forward, y left, z up. Stamps are times.txt + 1000000000 s. With --poses,
  a 100 Hz IMU derived from the poses (smoothing spline, seeded noise and bias) is added on /imu_derived.
KITTI raw:      kitti_to_bag.py --raw DRIVE_DIR OUT.bag [--cameras 0,1,2,3]
  DRIVE_DIR ends in _sync (rectified) or _extract (distorted); base_link is the OXTS, its IMU is on /imu.
"""

import argparse
import os
import pathlib
import sys

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))  # also when started through catkin's relay
from dataset_files import InputError  # noqa: E402
from kitti_odometry import read_sequence  # noqa: E402
from kitti_raw import read_drive  # noqa: E402
from rig_bag import write_recording  # noqa: E402


def camera_numbers(text):
    """KITTI camera numbers of a text such as 0,1,2,3."""
    numbers = [int(part) for part in text.split(",") if part.strip() in ("0", "1", "2", "3")]
    if not numbers or len(numbers) != len(text.split(",")) or len(set(numbers)) != len(numbers):
        raise argparse.ArgumentTypeError(f"found {text!r}, expected different numbers out of 0,1,2,3")
    return numbers


def parse(arguments):
    """The parsed command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("recording", metavar="SEQUENCE_DIR|DRIVE_DIR", type=pathlib.Path,
                        help="odometry sequence (calib.txt, times.txt, image_0, ...) or, with --raw, a raw drive")
    parser.add_argument("bag", metavar="OUT.bag", type=pathlib.Path, help="bag to write")
    parser.add_argument("--raw", action="store_true", help="the recording is a KITTI raw drive")
    parser.add_argument("--poses", metavar="FILE", type=pathlib.Path,
                        help="odometry: ground truth poses, which also give the derived IMU")
    parser.add_argument("--cameras", metavar="LIST", type=camera_numbers, default=[0, 1],
                        help="KITTI cameras that become cam0, cam1, ... (0, 1 grey; 2, 3 colour; default 0,1)")
    parser.add_argument("--seed", type=int, default=1, help="seed of the derived IMU's noise and bias (default 1)")
    options = parser.parse_args(arguments)
    if options.raw and options.poses:
        parser.error("--poses is for odometry sequences; a raw drive has its OXTS")
    return parser.prog, options


def main(arguments=None):
    program, options = parse(arguments)
    try:
        if options.raw:
            recording = read_drive(options.recording, options.cameras)
        else:
            recording = read_sequence(options.recording, options.cameras, options.poses, options.seed)
        write_recording(options.bag, *recording)
    except (InputError, OSError) as error:
        print(f"{program}: error: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
