# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
"""Runs of egomotion_bag on one recording with different rig files, judged against ground truth."""

import concurrent.futures
import dataclasses
import json
import os
import pathlib
import subprocess
import sys
from typing import Optional

from consistency import accumulated_consistency
from dataset_files import InputError
from evaluate import evaluate, evaluate_relative_poses
from trajectory_errors import associate
from trajectory_io import read_bag_odometry, read_tum

PARTS = ("scale", "direction", "rotation")    # of a frame-to-frame pose, with a NEES each
PACKAGE = pathlib.Path(__file__).resolve().parent.parent


def find_tool(name, given=None):
    """The path of an executable of this package: as given, beside this script, or in the package's build."""
    candidates = [pathlib.Path(given)] if given else [
        pathlib.Path(sys.argv[0]).resolve().parent / name, pathlib.Path(__file__).resolve().parent / name,
        PACKAGE / "build/devel/lib/multicam_egomotion" / name]
    for candidate in candidates:
        if candidate.is_file() and os.access(candidate, os.X_OK):
            return candidate.resolve()
    raise InputError(f"{name}: found no executable among {', '.join(map(str, candidates))}")


def run_tool(*command):
    """Runs a command; its last line of complaint is the error."""
    done = subprocess.run(list(map(str, command)), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                          errors="replace")
    if done.returncode != 0:
        lines = [line.strip() for line in done.stderr.splitlines() if line.strip()]
        raise InputError(lines[-1] if lines else f"{command[0]}: exit code {done.returncode}")


@dataclasses.dataclass
class Run:
    """One run of egomotion_bag; outputs are named `stem` with .tum, .out.bag and .report.json behind."""

    runner: pathlib.Path
    bag: pathlib.Path
    rig: pathlib.Path
    stem: str
    ground_truth: Optional[pathlib.Path] = None    # TUM, z up
    config: Optional[pathlib.Path] = None
    consistency: bool = True                       # also judge the covariances, which takes a bag


def judge(run):
    """Runs and judges: a dictionary for JSON, with `error` alone where the odometry failed."""
    trajectory, bag, report = (pathlib.Path(run.stem + suffix) for suffix in (".tum", ".out.bag", ".report.json"))
    for path in (trajectory, bag, report):
        path.unlink(missing_ok=True)    # an older one is not a result of this run
    command = [run.runner, "--bag", run.bag, "--rig", run.rig, "--trajectory", trajectory, "--report", report]
    command += ["--output-bag", bag] if run.consistency else []
    command += ["--config", run.config] if run.config else []
    try:
        run_tool(*command)
        estimate = read_tum(trajectory)
        result = {"length_m": float(estimate.path_lengths()[-1]), "poses": len(estimate),
                  "report": json.loads(report.read_text())}
        if run.ground_truth:
            truth = read_tum(run.ground_truth)
            evaluation = evaluate(truth, estimate)
            result.update(evaluation=evaluation, ate_mm=1e3 * evaluation["ate"]["position_yaw"]["rmse_m"],
                          scale=evaluation["ate"]["sim3"]["scale"])
            if run.consistency:
                result.update(_consistency(truth, bag))
        return result
    except (InputError, OSError, ValueError) as error:
        return {"error": str(error)}


def _consistency(truth, bag):
    """NEES of frame-to-frame poses, one number a part for the whole run, and the details behind them."""
    matched, estimate, _ = associate(truth, read_bag_odometry(bag, "odometry"))
    details = evaluate_relative_poses(truth, estimate, bag, "relative_pose", "ego_motion")
    missing = [part for part in PARTS if part not in details.get("nees", {})]
    if missing:
        raise InputError(f"{bag}: found no relative poses with covariances within the ground truth")
    return {"nees": {part: details["nees"][part]["mean_per_dof"] for part in PARTS},
            "accumulated": accumulated_consistency(matched, estimate), "frame_to_frame": details}


def judge_all(runs, jobs):
    """The results of judge(), in the order of the runs; `jobs` at a time."""
    with concurrent.futures.ProcessPoolExecutor(max_workers=jobs) as pool:
        results = []
        for result in pool.map(judge, runs):
            results.append(result)
            if sys.stderr.isatty():
                print(f"\r{runs[0].bag.name}: {len(results)} of {len(runs)} runs", end="", file=sys.stderr)
    if sys.stderr.isatty():
        print(file=sys.stderr)
    return results
