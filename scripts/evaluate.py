#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
"""Compares an estimated trajectory with ground truth: absolute and relative errors, consistency, a picture.

GT and EST are TUM files (t x y z qx qy qz qw), KITTI pose files (12 numbers a line) or bags with odometry; the
format is seen from the content. With stamps, ground truth is interpolated at the estimate's stamps; KITTI files
without --times are matched line by line. Both must be of the same body. A bag as EST also gives the consistency
(NEES) of the reported covariances. KITTI files have y down, all others z up (see --up).
"""

import argparse
import json
import os
import pathlib
import sys

import numpy as np

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))  # also when started through catkin's relay
from consistency import accumulated_consistency, relative_consistency, scale_errors_by_state  # noqa: E402
from dataset_files import InputError  # noqa: E402
from evaluation_text import report_text  # noqa: E402
from run_summary import summarize, summary_text  # noqa: E402
from trajectory_errors import (absolute_errors, align, associate, frame_to_frame_errors,  # noqa: E402
                               relative_errors)
from trajectory_io import (NS, Trajectory, has_topic, read_bag_frame_records, read_bag_odometry,  # noqa: E402
                           read_trajectory)
from trajectory_plot import plot  # noqa: E402

# Axes (right, down, forward) of a KITTI world to (forward, left, up).
R_Z_UP_KITTI = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])


def with_z_up(trajectory, up):
    """The trajectory in a world whose z points up; `up` is z (nothing to do) or -y."""
    if up == "z":
        return trajectory
    return Trajectory(trajectory.positions @ R_Z_UP_KITTI.T, R_Z_UP_KITTI @ trajectory.rotations,
                      trajectory.stamps_ns, trajectory.covariances)


def evaluate(ground_truth, estimate, max_gap_s=0.5):
    """Report (a dictionary for JSON) of two trajectories in worlds with z up."""
    matched, estimate, unmatched = associate(ground_truth, estimate, max_gap_s)
    report = {"poses": len(matched), "unmatched_poses": unmatched, "path_m": float(matched.path_lengths()[-1])}
    if matched.stamps_ns is not None:
        report["duration_s"] = float(matched.stamps_ns[-1] - matched.stamps_ns[0]) / NS
    report["ate"] = absolute_errors(matched, estimate)
    report["relative"] = relative_errors(matched, estimate)
    report["frame_to_frame"] = frame_to_frame_errors(matched, estimate)
    if estimate.covariances is not None:
        report["nees"] = {"accumulated": accumulated_consistency(matched, estimate)}
    return report


def evaluate_relative_poses(ground_truth, estimate, bag_path, relative_topic, ego_motion_topic):
    """Entries for the report from a bag's relative poses.

    The frame before each pose and its scale state are in the EgoMotion messages; in a bag without them, the frame
    before is the newest stamp of the estimate or of a relative pose, and scale states are unknown.
    """
    relative = read_bag_odometry(bag_path, relative_topic)
    if relative.covariances is None or ground_truth.stamps_ns is None:
        return {}
    if not has_topic(bag_path, ego_motion_topic):
        known = np.union1d(relative.stamps_ns, estimate.stamps_ns)
        previous = known[np.maximum(np.searchsorted(known, relative.stamps_ns) - 1, 0)]
        return {"nees": relative_consistency(ground_truth, relative, previous)}
    records = read_bag_frame_records(bag_path, ego_motion_topic)
    relative = relative.select(np.array([stamp in records for stamp in relative.stamps_ns.tolist()], dtype=bool))
    frames = [records[stamp] for stamp in relative.stamps_ns.tolist()]
    previous = np.array([frame.previous_stamp_ns for frame in frames], dtype=np.int64)
    states = np.array([frame.scale_state for frame in frames])
    return {"nees": relative_consistency(ground_truth, relative, previous, states),
            "scale_states": scale_errors_by_state(ground_truth, relative, previous, states)}


def run(options):
    """Reads, evaluates, prints and writes what the command line asks for."""
    ground_truth = read_trajectory(options.ground_truth, options.gt_topic, options.times)
    estimate = read_trajectory(options.estimate, options.topic, options.times)
    up = options.up or ("-y" if ground_truth.y_down and estimate.y_down else "z")
    ground_truth, estimate = with_z_up(ground_truth, up), with_z_up(estimate, up)
    report = evaluate(ground_truth, estimate, options.max_gap)
    if options.estimate.suffix == ".bag" and has_topic(options.estimate, options.relative_topic):
        extra = evaluate_relative_poses(ground_truth, estimate, options.estimate,
                                        options.relative_topic, options.ego_motion_topic)
        if "nees" in extra:
            report.setdefault("nees", {})["frame to frame"] = extra.pop("nees")
        report.update(extra)
    print(report_text(report))
    if options.json:
        options.json.write_text(json.dumps(report, indent=2) + "\n")
    if options.plot:
        matched, estimate, _ = associate(ground_truth, estimate, options.max_gap)
        aligned, _ = align(matched, estimate, "position_yaw")
        error = report["ate"]["position_yaw"]["rmse_m"]
        plot(options.plot, matched, aligned, f"{options.estimate.name}: ATE {error:.3f} m over "
             f"{report['path_m']:.1f} m (position + yaw aligned)")


def parse(arguments):
    """The parsed command line and the program's name."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("ground_truth", metavar="GT", type=pathlib.Path, nargs="?", help="ground truth trajectory")
    parser.add_argument("estimate", metavar="EST", type=pathlib.Path, nargs="?", help="estimated trajectory")
    parser.add_argument("--json", metavar="FILE", type=pathlib.Path, help="write the report as JSON")
    parser.add_argument("--plot", metavar="FILE.png", type=pathlib.Path, help="write a picture")
    parser.add_argument("--summary", metavar="DIR", type=pathlib.Path,
                        help="instead: one line a bag from the JSON reports of egomotion_bag and evaluate.py in a "
                             "directory, and the bags that failed (exit code 1); also as --json FILE")
    parser.add_argument("--times", metavar="FILE", type=pathlib.Path,
                        help="stamps [s] of KITTI pose files, one a line")
    parser.add_argument("--up", choices=("z", "-y"),
                        help="vertical axis of both worlds (default: -y when both are KITTI files, else z)")
    parser.add_argument("--max-gap", metavar="SECONDS", type=float, default=0.5,
                        help="longest gap of ground truth to interpolate over (default 0.5)")
    parser.add_argument("--topic", default="odometry", help="nav_msgs/Odometry of a bag as EST (default odometry)")
    parser.add_argument("--gt-topic", default="/ground_truth",
                        help="Odometry or PoseStamped of a bag as GT (default /ground_truth)")
    parser.add_argument("--relative-topic", default="relative_pose",
                        help="frame-to-frame Odometry of a bag as EST, for its NEES (default relative_pose)")
    parser.add_argument("--ego-motion-topic", default="ego_motion",
                        help="EgoMotion of a bag as EST, for scale states (default ego_motion)")
    options = parser.parse_args(arguments)
    if (options.summary is None) == (options.estimate is None):
        parser.error("give GT and EST, or --summary DIR")
    return options, parser.prog


def main(arguments=None):
    options, program = parse(arguments)
    try:
        if options.summary:
            summary = summarize(options.summary)
            print(summary_text(summary))
            if options.json:
                options.json.write_text(json.dumps(summary, indent=2) + "\n")
            return 1 if summary["failed"] else 0
        run(options)
    except (InputError, OSError) as error:
        print(f"{program}: error: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
