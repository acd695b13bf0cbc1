# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
"""report.md: our tables beside the paper's, and the figures."""

import math

import paper_numbers
from paper_numbers import PAPER_NAMES, SOLVERS
from paper_results import OURS, KittiTable, number, read_rows

CAPTIONS = {
    3: "No noise; of all solutions the one nearest the truth. 4pt-Lee solves the equations of 4pt-Our, 4pt-Sweeney "
       "those of 4pt-Our-Axis.",
    4: "Exact priors. Trials without a solution count as 180 degrees. The curves of 4pt-Lee and 4pt-Our must coincide, "
       "those of 4pt-Sweeney and 4pt-Our-Axis as well: up to the factor 1 + s^2 they are the same polynomials.",
    5: "The pitch of both alignments is noisy. For the solvers with an axis prior two ways: the axis of the rotation "
       "that the noisy alignments give with the true yaw (equivalent axis), and the axis turned by the error of the "
       "first alignment (turned axis).",
    6: "The roll of both alignments is noisy, else as Fig. 5.",
    7: "First RANSAC seed. Aligned with the ground truth by a rigid motion.",
}


def _cell(value, spread=math.nan, digits=3):
    if math.isnan(value):
        return "no data"
    return f"{value:.{digits}f}" + (f" ±{spread / 2:.{digits}f}" if spread > 0.0 else "")


def _table(header, rows):
    return ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)] + [
        "| " + " | ".join(row) + " |" for row in rows]


def _runtimes(directory):
    rows = {row["solver"]: row for row in read_rows(directory / "table1_runtime.csv")}

    def line(title, values):
        return [title] + [_cell(values.get(solver, math.nan)) for solver in SOLVERS]

    runs = next(iter(rows.values()))["runs"]
    return ["## Table I: time of a solver [us]", ""] + _table(
        ["", *(f"{solver}<br>({PAPER_NAMES[solver]})" for solver in SOLVERS)],
        [line("ours, mean", {solver: number(row["mean_us"]) for solver, row in rows.items()}),
         line("ours, median", {solver: number(row["median_us"]) for solver, row in rows.items()}),
         line("paper, mean (Ryzen 9 7945HX)", paper_numbers.RUNTIME_US)]) + [
        "", f"{runs} runs on this machine, one thread, all real solutions with R and t. The paper's is another machine."]


def _kitti(directory, file, title, paper):
    table = KittiTable(directory / file)
    rows = []
    for place in table.places:
        sequence, source = place
        rows.append([sequence, source] + [_cell(table.value(place, method), table.value(place, method, "spread_deg"))
                                          for method in SOLVERS + OURS])
        if (sequence, SOLVERS[0]) in paper and place == [one for one in table.places if one[0] == sequence][-1]:
            rows.append([sequence, "*paper*"] + [f"*{paper[sequence, solver]:.3f}*" for solver in SOLVERS] + ["", ""])
    return [f"## {title}", ""] + _table(["sequence", "", *SOLVERS, *OURS], rows)


def _pair_counts(directory):
    """What the medians are of."""
    table = KittiTable(directory / "table3_translation.csv")
    rows = []
    for place in table.places:
        if place[1] == "no data":
            continue
        counts = [int(table.value(place, method, key)) for method, key in (
            ("4pt-axis", "pairs"), ("4pt-axis", "failed"), ("ours", "failed"), ("4pt-axis", "undefined_prior"))]
        moving = [_cell(table.value(place, method, "median_moving_deg")) for method in ("4pt-axis",) + OURS]
        rows.append([place[0], place[1], *map(str, counts), *moving])
    if not rows:
        return []
    return ["", "Pairs of frames; those that 4pt-axis did not solve (they count as 180 degrees); those that ours did not "
            "(its prediction counts); those without a rotation axis (they do not count). Then the median direction error "
            "of the pairs with more than 0.1 m between them: the direction of a standing car is noise.", ""] + _table(
        ["sequence", "", "pairs", "4pt-axis failed", "ours failed", "axis undefined", "4pt-axis", *OURS], rows)


def markdown(directory, figures, claims):
    held = sum(claim.verdict == "holds" for claim in claims)
    judged = sum(claim.verdict != "no data" for claim in claims)
    lines = ["# The paper's experiments, repeated", "",
             "T. Li, Z. Yu, B. Guan, J. Han, W. Lv: Efficient Minimal Solvers for Visual-Inertial Relative Pose "
             "Estimation in Multi-Camera Systems, section V.", "",
             f"Of its verbal claims that could be judged, {held} of {judged} hold: [claims.md](claims.md).", ""]
    lines += _runtimes(directory)
    for key in (3, 4, 5, 6):
        lines += ["", f"## Fig. {key}", "", CAPTIONS[key], ""] + [f"![Fig. {key}]({name})" for name in figures[key]]
    lines += [""] + _kitti(directory, "table2_rotation.csv", "Table II: median rotation error on KITTI [deg]",
                           paper_numbers.ROTATION_DEG)
    lines += ["", "Solvers in plain RANSAC without refinement, with priors from the ground truth; median of five seeds "
              "and half the spread of their medians. `ours`: consensus, refinement and window, with the vertical from "
              "the ground truth; `ours-no-prior`: with nothing from there. Features: by our tracker (images) or as "
              "given (tracks); the paper's are others.", ""]
    lines += _kitti(directory, "table3_translation.csv", "Table III: median error of the translation's direction [deg]",
                    paper_numbers.TRANSLATION_DEG) + _pair_counts(directory)
    lines += ["", "## Fig. 7", ""]
    lines += [CAPTIONS[7], "", f"![Fig. 7]({figures[7][0]})"] if figures[7] else ["no data"]
    return "\n".join(lines) + "\n"
