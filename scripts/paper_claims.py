# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
"""Each verbal claim of the paper's section V against our numbers: efficiency and stability; the others by module."""

import collections

import paper_claims_kitti
import paper_claims_noise
from paper_results import read_rows

HOLDS, FAILS, NO_DATA = "holds", "does not hold", "no data"

Claim = collections.namedtuple("Claim", "section text verdict numbers")


def _runtime_claims(directory):
    median = {row["solver"]: float(row["median_us"]) for row in read_rows(directory / "table1_runtime.csv")}
    section = "Table I"

    def times(*solvers):
        return ", ".join(f"{solver} {median[solver]:.2f} us" for solver in solvers)

    four_points = sorted((solver for solver in median if solver.startswith("4pt")), key=median.get)
    five_points = [solver for solver in median if solver.startswith("5pt")]
    text = "All 4-point solvers are substantially more efficient than 5pt-Martyushev (here: 10 times)"
    if five_points:
        ratio = median[five_points[0]] / median[four_points[-1]]
        yield Claim(section, text, HOLDS if ratio > 10.0 else FAILS,
                    f"{times(*five_points)}, slowest 4-point {times(four_points[-1])}: {ratio:.0f} times")
    else:
        yield Claim(section, text, NO_DATA, "")
    yield Claim(section, "4pt-Liu is the fastest", HOLDS if min(median, key=median.get) == "4pt-liu" else FAILS,
                times(*four_points))
    ours, others = ("4pt-vertical", "4pt-axis"), ("4pt-lee", "4pt-sweeney")
    slowest, fastest = max(ours, key=median.get), min(others, key=median.get)
    yield Claim(section, "4pt-Our and 4pt-Our-Axis are faster than 4pt-Lee and 4pt-Sweeney",
                HOLDS if median[slowest] < median[fastest] else FAILS, times(*ours, *others))


def _stability_claims(directory):
    section = "Fig. 3"
    medians = {(row["solver"], row["error"]): float(row["log10_median"])
               for row in read_rows(directory / "fig3_quantiles.csv")}

    def worst(solver):
        return max(medians[solver, error] for error in ("rotation", "translation"))

    def powers(*solvers):
        return "; ".join(f"{solver}: median rotation error 10^{medians[solver, 'rotation']:.1f}, "
                         f"direction 10^{medians[solver, 'translation']:.1f} rad" for solver in solvers)

    def claim(text, holds, *solvers):
        return Claim(section, text, HOLDS if holds else FAILS, powers(*solvers))

    yield claim("The errors of 4pt-Our are around 10^-15 (here: both medians below 10^-14.5)",
                worst("4pt-vertical") < -14.5, "4pt-vertical")
    yield claim("4pt-Lee is nearly comparable to 4pt-Our (here: within a power of ten)",
                abs(worst("4pt-lee") - worst("4pt-vertical")) < 1.0, "4pt-lee", "4pt-vertical")
    yield claim("4pt-Liu is worse, as it approximates the rotation", worst("4pt-liu") > worst("4pt-vertical") + 1.0,
                "4pt-liu")
    yield claim("The errors of 4pt-Our-Axis are around 10^-14 (here: both medians below 10^-13.5)",
                worst("4pt-axis") < -13.5, "4pt-axis")
    yield claim("4pt-Our-Axis is better than 4pt-Sweeney", worst("4pt-axis") < worst("4pt-sweeney"), "4pt-axis",
                "4pt-sweeney")


def judge(directory):
    """All claims, in the order of the paper."""
    claims = list(_runtime_claims(directory)) + list(_stability_claims(directory))
    for part in (paper_claims_noise, paper_claims_kitti):
        claims += [Claim(*one) for one in part.judge(directory)]
    return claims


def markdown(claims):
    lines = ["# The paper's claims", "",
             "Each verbal claim of section V. \"Comparable\" and \"similar\": median errors within 5 % of each other. "
             "Where a claim can be read in several ways, it holds if it does in all; the others are named.", "",
             "| | claim | verdict | our numbers |", "|---|---|---|---|"]
    lines += [f"| {claim.section} | {claim.text} | {claim.verdict} | {claim.numbers} |" for claim in claims]
    return "\n".join(lines) + "\n"
