# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
"""Each verbal claim of the paper's section V against our numbers; those about noise are in a module of their own."""

import collections

import paper_claims_noise
from paper_numbers import SOLVERS
from paper_results import KittiTable, read_rows, trajectory_errors

FIVE, *FOUR_POINTS = SOLVERS

Claim = collections.namedtuple("Claim", "section text verdict numbers")


def _verdict(holds):
    return {True: "holds", False: "does not hold", None: "no data"}[holds]


def _runtime_claims(directory):
    median = {row["solver"]: float(row["median_us"]) for row in read_rows(directory / "table1_runtime.csv")}
    by_time = sorted(FOUR_POINTS, key=median.get)
    ratio = median[FIVE] / median[by_time[-1]]

    def claim(text, holds, *solvers):
        times = ", ".join(f"{solver} {median[solver]:.2f} us" for solver in solvers)
        return Claim("Table I", text, _verdict(holds), times)

    yield claim("All 4-point solvers are substantially more efficient than 5pt-Martyushev (here: 10 times)", ratio > 10.0,
                FIVE, by_time[-1])
    yield claim("4pt-Liu is the fastest", by_time[0] == "4pt-liu", *by_time)
    ours, others = ("4pt-vertical", "4pt-axis"), ("4pt-lee", "4pt-sweeney")
    yield claim("4pt-Our and 4pt-Our-Axis are faster than 4pt-Lee and 4pt-Sweeney",
                max(median[one] for one in ours) < min(median[one] for one in others), *ours, *others)


def _stability_claims(directory):
    medians = {(row["solver"], row["error"]): float(row["log10_median"])
               for row in read_rows(directory / "fig3_quantiles.csv")}

    def worst(solver):
        return max(medians[solver, error] for error in ("rotation", "translation"))

    def claim(text, holds, *solvers):
        powers = "; ".join(f"{solver}: median rotation error 10^{medians[solver, 'rotation']:.1f}, "
                           f"direction 10^{medians[solver, 'translation']:.1f} rad" for solver in solvers)
        return Claim("Fig. 3", text, _verdict(holds), powers)

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


def _claim_by_sequence(section, text, places, line, outcomes):
    """Holds where every outcome is True; undecided where none is False (None: within the spread of the seeds)."""
    if not outcomes:
        verdict = "no data"
    elif None in outcomes and False not in outcomes:
        verdict = "undecided: within the spread of the seeds"
    else:
        verdict = _verdict(all(outcomes))
    return Claim(section, text, verdict, "<br>".join(f"{name} ({source}): {line((name, source))}"
                                                     for name, source in places))


def _against_five_points(section, text, table, excepted=()):
    """All 4-point solvers are better; in the sequences that the paper excepts they are not."""
    places = table.measured_sequences()

    def worst(place):
        return max(table.value(place, solver) for solver in FOUR_POINTS)

    return _claim_by_sequence(
        section, text, places,
        lambda place: f"worst 4-point {worst(place):.3f}, 5-point {table.value(place, FIVE):.3f} deg",
        [(worst(place) < table.value(place, FIVE)) != (place[0] in excepted) for place in places])


def _best(section, text, table, wanted, excepted):
    """One of `wanted` is the best 4-point solver, but for the sequences that the paper excepts."""
    def order(place):
        return sorted(FOUR_POINTS, key=lambda solver: table.value(place, solver))

    def line(place):
        return ", ".join(f"{solver} {table.value(place, solver):.3f} ±{table.value(place, solver, 'spread_deg') / 2:.3f}"
                         for solver in order(place)) + " deg"

    def outcome(place):
        ours = next(solver for solver in order(place) if solver in wanted)
        other = next(solver for solver in order(place) if solver not in wanted)
        ahead = table.value(place, other) - table.value(place, ours)
        spread = max(table.value(place, solver, "spread_deg") for solver in (ours, other)) / 2
        return None if abs(ahead) <= spread else ahead > 0.0

    places = table.measured_sequences()
    return _claim_by_sequence(section, text, places, line,
                              [outcome(place) for place in places if place[0] not in excepted])


def _kitti_claims(directory):
    rotation = KittiTable(directory / "table2_rotation.csv")
    translation = KittiTable(directory / "table3_translation.csv")
    yield _against_five_points("Table II", "4-point solvers have a better rotation than 5pt-Martyushev in all sequences",
                               rotation)
    yield _against_five_points(
        "Table III", "4-point solvers have a better translation than 5pt-Martyushev, but not in 01, 04 and 06",
        translation, ("01", "04", "06"))
    yield _best("Table II", "4pt-Our or 4pt-Our-Axis is the best 4-point solver in rotation", rotation,
                ("4pt-vertical", "4pt-axis"), ("04",))
    yield _best("Table III", "4pt-Our-Axis has the best translation, but in 04 and 07", translation, ("4pt-axis",),
                ("04", "07"))

    errors = trajectory_errors(directory)
    places = [place for place in errors if len(place[0]) == 2]
    vertical, axis = ("4pt-lee", "4pt-liu", "4pt-vertical"), ("4pt-sweeney", "4pt-axis")
    for text, better, worse in (
            ("4pt-Our-Axis and 4pt-Sweeney have the smallest trajectory errors (paper: sequence 00)", axis, vertical),
            ("4pt-Our has a smaller trajectory error than 4pt-Lee and 4pt-Liu (paper: sequence 00)", vertical[2:],
             vertical[:2])):
        yield _claim_by_sequence(
            "Fig. 7", text, places,
            lambda place, methods=(*better, *worse): ", ".join(f"{one} {errors[place][one]:.2f}" for one in methods)
            + " m RMS, one seed",
            [max(errors[place][one] for one in better) < min(errors[place][one] for one in worse) for place in places])


def judge(directory):
    """All claims, in the order of the paper."""
    return [*_runtime_claims(directory), *_stability_claims(directory),
            *(Claim(*one) for one in paper_claims_noise.judge(directory)), *_kitti_claims(directory)]


def markdown(claims):
    lines = ["# The paper's claims", "",
             "Each verbal claim of section V. \"Comparable\" and \"similar\": median errors within 5 % of each other. "
             "Where a claim can be read in several ways, it holds if it does in all; the others are named.", "",
             "| | claim | verdict | our numbers |", "|---|---|---|---|"]
    lines += [f"| {claim.section} | {claim.text} | {claim.verdict} | {claim.numbers} |" for claim in claims]
    return "\n".join(lines) + "\n"
