# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
"""What wrong rig files do to the odometry, as numbers and tables.

A calibration error is the same in all frames of a run, so that its frames are one sample, not many. The NEES of a run
is the mean over its frames per degree of freedom. A rig is inside when that is below the 95 % bound of one sample:
with honest covariances 95 % of the rigs are, and the mean over the rigs is at most 1.
"""

import statistics

from consistency import CHI_SQUARE_95
from evaluation_text import MISSING, number, table
from odometry_runs import PARTS

DOF = {"scale": 1, "direction": 2, "rotation": 3}
BOUND_PER_DOF = {part: CHI_SQUARE_95[dof] / dof for part, dof in DOF.items()}
HEADER = ["ATE [mm]", "scale", *(f"NEES {part}" for part in PARTS)]


def summarize(runs):
    """Summary of the runs with wrong rigs; a run that failed is outside of every bound."""
    runs = list(runs)
    good = [run for run in runs if "error" not in run]
    summary = {"rigs": len(runs), "failed": len(runs) - len(good), "nees": {}}
    for part in PARTS:
        values = [run["nees"][part] for run in good]
        summary["nees"][part] = {"inside": sum(value < BOUND_PER_DOF[part] for value in values)}
        if good:
            summary["nees"][part]["mean_per_dof"] = statistics.mean(values)
    if good:
        errors, scales = [run["ate_mm"] for run in good], [run["scale"] for run in good]
        summary.update(ate_median_mm=statistics.median(errors), ate_worst_mm=max(errors), scale_least=min(scales),
                       scale_most=max(scales))
    return summary


def _run_row(name, run):
    nees = run.get("nees", {})
    return [name, number(run, "ate_mm", 1), number(run, "scale", 4), *(number(nees, part, 2) for part in PARTS)]


def _scales(summary):
    if "scale_least" not in summary:
        return MISSING
    return f"{summary['scale_least']:.4f} to {summary['scale_most']:.4f}"


def scenario_text(name, scenario):
    """The table of one scenario: its exact rig, its wrong rigs and their summary."""
    summary, rigs = scenario["summary"], scenario["rigs"]
    nees = summary["nees"]
    rows = [_run_row("exact", scenario["exact"]), *(_run_row(rig, run) for rig, run in rigs.items()),
            ["median ATE, range of scale", number(summary, "ate_median_mm", 1), _scales(summary), *[""] * len(PARTS)],
            ["worst ATE, mean NEES", number(summary, "ate_worst_mm", 1), "",
             *(number(nees[part], "mean_per_dof", 2) for part in PARTS)],
            ["inside the 95 % bound", "", "", *(f"{nees[part]['inside']}/{summary['rigs']}" for part in PARTS)]]
    failed = [f"({rig}: {run['error']})" for rig, run in {"exact": scenario["exact"], **rigs}.items() if "error" in run]
    return "\n".join([f"{name}: {summary['rigs']} wrong rigs, scale of ground truth / estimate",
                      *table(["rig", *HEADER], rows), *failed])


def pooled_text(scenarios, pooled):
    """One line a scenario, and all of them together; exact rigs beside."""
    header = ["scenario", "rigs", "ATE median [mm]", "worst", "exact", "scale", "exact"]
    for part in PARTS:
        header += [f"NEES {part}", "inside", "exact"]
    rows = [_pooled_row(name, scenario["summary"], scenario["exact"]) for name, scenario in scenarios.items()]
    return "\n".join(table(header, rows + [_pooled_row("all", pooled, {})]))


def _pooled_row(name, summary, exact):
    row = [name, summary["rigs"], number(summary, "ate_median_mm", 1), number(summary, "ate_worst_mm", 1),
           number(exact, "ate_mm", 1), _scales(summary), number(exact, "scale", 4)]
    for part in PARTS:
        nees = summary["nees"][part]
        row += [number(nees, "mean_per_dof", 2), f"{nees['inside']}/{summary['rigs']}",
                number(exact.get("nees", {}), part, 2)]
    return row


def turned_text(turns):
    """The table of a recording whose cameras were turned in the rig file."""
    def line(name, run):
        faults = {fault: count for fault, count in run.get("report", {}).get("faults", {}).items() if count}
        told = ", ".join(f"{fault} {count}" for fault, count in faults.items())
        return [name, number(run, "ate_mm", 1), number(run, "scale", 4), number(run, "length_ratio", 4),
                run.get("error", told or MISSING)]

    return "\n".join(table(["turned", "ATE [mm]", "scale", "length / unturned", "faults"],
                           [line(name, run) for name, run in turns.items()]))
