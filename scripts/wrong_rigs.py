#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
"""Judges the odometry with rig files that are wrong, as after a calibration.

Of each SCENARIO a recording is simulated, and the odometry runs on it with rig files whose errors have the standard
deviations that the files state themselves. With --bag instead: any recording, with one camera at a time turned in the
rig file about one of its axes.
"""

import argparse
import json
import os
import pathlib
import shutil
import sys
import tempfile

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))  # also when started through catkin's relay
from dataset_files import InputError, require_file  # noqa: E402
from odometry_runs import Run, find_tool, judge_all, run_tool  # noqa: E402
from rig_variants import read_rig, turns, write_turned, write_without_sigmas  # noqa: E402
from wrong_rig_tables import pooled_text, scenario_text, summarize, turned_text  # noqa: E402

SCENARIOS = ("handheld_stereo", "car_surround", "drone_fisheye", "straight_line")


def simulate(simulator, scenario, directory, arguments):
    """The path of the scenario's recording, simulated unless it is there."""
    recording = directory / "recording"
    if not recording.is_dir():
        unfinished = directory / "recording.unfinished"
        shutil.rmtree(unfinished, ignore_errors=True)
        unfinished.mkdir(parents=True)
        run_tool(simulator, scenario, unfinished / "exact.bag", *arguments)
        unfinished.rename(recording)
    return recording / "exact.bag"


def judge_scenario(options, scenario, runner, simulator):
    """Results of one scenario with its exact rig and with wrong ones."""
    arguments = ["--duration", options.duration] if options.duration else []
    directory = options.work / (f"{scenario}_{options.duration:g}s" if options.duration else scenario)
    bag = simulate(simulator, scenario, directory, arguments)
    rigs = {}
    for seed in range(options.rigs + 1):
        name = str(seed) if seed else "exact"
        rigs[name] = directory / f"{name}.rig.yaml"
        run_tool(simulator, scenario, rigs[name], "--calibration-seed", seed, "--calibration-error",
                 options.calibration_error if seed else 0, *arguments)
        if options.without_sigmas:
            write_without_sigmas(rigs[name], read_rig(rigs[name]))
    truth = bag.with_name("exact.groundtruth.tum")
    results = judge_all([Run(runner, bag, rig, str(directory / name), truth, options.config)
                         for name, rig in rigs.items()], options.jobs)
    runs = dict(zip(rigs, results))
    exact = runs.pop("exact")
    return {"exact": exact, "rigs": runs, "summary": summarize(runs.values())}


def judge_scenarios(options, runner):
    """Prints a table of each scenario and one of all; returns everything."""
    simulator = find_tool("egomotion_sim", options.simulator)
    scenarios = {}
    for name in options.scenarios or SCENARIOS:
        scenarios[name] = judge_scenario(options, name, runner, simulator)
        print(scenario_text(name, scenarios[name]) + "\n", flush=True)
    pooled = summarize(run for scenario in scenarios.values() for run in scenario["rigs"].values())
    print(pooled_text(scenarios, pooled))
    failed = pooled["failed"] + sum("error" in scenario["exact"] for scenario in scenarios.values())
    return {"scenarios": scenarios, "pooled": pooled, "failed": failed}


def judge_turned(options, runner):
    """Prints what turned cameras do to the odometry of a recording; returns everything."""
    rig = read_rig(options.rig)
    with tempfile.TemporaryDirectory() as directory:
        rigs = {"unturned": options.rig.resolve()}
        for name, camera, axis, degrees in turns(rig, options.turned):
            rigs[name] = pathlib.Path(directory) / f"{len(rigs)}.rig.yaml"
            write_turned(rigs[name], rig, camera, axis, degrees)
        results = judge_all([Run(runner, require_file(options.bag), path, f"{directory}/{index}", options.ground_truth,
                                 options.config, consistency=False) for index, path in enumerate(rigs.values())],
                            options.jobs)
    length = results[0].get("length_m", 0.0)
    for result in results:
        if length > 0.0 and "length_m" in result:
            result["length_ratio"] = result["length_m"] / length
    runs = dict(zip(rigs, results))
    print(turned_text(runs))
    return {"turned": runs, "failed": sum("error" in run for run in results)}


def numbers(text):
    """Positive numbers, separated by commas."""
    values = [float(word) for word in text.split(",")]
    if not all(value > 0.0 for value in values):
        raise ValueError(text)
    return values


def positive(text):
    """A whole number of at least 1."""
    if int(text) < 1:
        raise ValueError(text)
    return int(text)


def parse(arguments):
    """The parsed command line and the program's name."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenarios", metavar="SCENARIO", nargs="*", help=f"default: {' '.join(SCENARIOS)}")
    parser.add_argument("--work", metavar="DIR", type=pathlib.Path,
                        help="recordings, kept for the next time, rig files and what the odometry wrote")
    parser.add_argument("--rigs", metavar="N", type=positive, default=20, help="wrong rigs a scenario (default 20)")
    parser.add_argument("--calibration-error", metavar="SCALE", type=float, default=1.0,
                        help="factor of the sigmas in the rig file (default 1)")
    parser.add_argument("--duration", metavar="SECONDS", type=float, help="of each recording (default: its own)")
    parser.add_argument("--jobs", metavar="N", type=positive, default=1, help="runs at the same time (default 1)")
    parser.add_argument("--config", metavar="FILE", type=pathlib.Path, help="parameters, as for egomotion_bag")
    parser.add_argument("--runner", metavar="PATH", type=pathlib.Path, help="egomotion_bag, to compare another build")
    parser.add_argument("--simulator", metavar="PATH", type=pathlib.Path, help="egomotion_sim, likewise")
    parser.add_argument("--without-sigmas", action="store_true",
                        help="leave the sigmas out of the rig files, for a runner that does not know them")
    parser.add_argument("--bag", metavar="BAG", type=pathlib.Path, help="judge this recording with turned cameras")
    parser.add_argument("--rig", metavar="FILE", type=pathlib.Path, help="its rig file, in our own format")
    parser.add_argument("--ground-truth", metavar="TUM", type=pathlib.Path, help="its ground truth, where there is one")
    parser.add_argument("--turned", metavar="DEGREES", type=numbers, default=[0.1, 0.2, 0.5],
                        help="angles of the turns (default 0.1,0.2,0.5)")
    parser.add_argument("--json", metavar="FILE", type=pathlib.Path, help="write everything as JSON")
    options = parser.parse_args(arguments)
    if options.bag and (options.scenarios or not options.rig):
        parser.error("with --bag, give --rig and no scenario")
    if not options.bag and (not options.work or options.rig or options.ground_truth):
        parser.error("give --work for scenarios; --rig and --ground-truth belong to --bag")
    return options, parser.prog


def main(arguments=None):
    options, program = parse(arguments)
    try:
        runner = find_tool("egomotion_bag", options.runner)
        result = judge_turned(options, runner) if options.bag else judge_scenarios(options, runner)
        if options.json:
            options.json.write_text(json.dumps(result, indent=2) + "\n")
        return 1 if result["failed"] else 0
    except (InputError, OSError) as error:
        print(f"{program}: error: {error}", file=sys.stderr)
        return 1


if __name__ == "__main__":
    sys.exit(main())
