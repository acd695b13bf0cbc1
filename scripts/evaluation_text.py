# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
"""An evaluation as text."""

from trajectory_errors import ALIGNMENTS

MISSING = "-"


def table(header, rows):
    """Lines of a table: the first column to the left, the others to the right."""
    cells = [header] + [[str(cell) for cell in row] for row in rows]
    widths = [max(len(row[i]) for row in cells) for i in range(len(header))]
    return ["  ".join(cell.ljust(width) if i == 0 else cell.rjust(width)
                      for i, (cell, width) in enumerate(zip(row, widths))).rstrip() for row in cells]


def number(values, key, digits=3):
    """A value of a dictionary with fixed digits, or a dash where there is none."""
    return f"{values[key]:.{digits}f}" if key in values else MISSING


def report_text(report):
    """The report of evaluate() for people to read."""
    counts = f"{report['poses']} poses matched, {report['unmatched_poses']} without ground truth, " \
             f"path {report['path_m']:.3f} m"
    if "duration_s" in report:
        counts += f", {report['duration_s']:.2f} s"
    parts = [[counts], _absolute_lines(report["ate"]), _relative_lines(report["relative"]),
             _frame_lines(report["frame_to_frame"])]
    if "nees" in report:
        parts.append(_nees_lines(report["nees"]))
    if "scale_states" in report:
        parts.append(table(["scale state", "frames", "median error of |t| [%]"],
                           [[state, values["frames"], number(values, "median_error_percent", 2)]
                            for state, values in report["scale_states"].items()]))
    return "\n\n".join("\n".join(lines) for lines in parts)


def _absolute_lines(ate):
    header = ["ATE after alignment of", "RMSE [m]", "max [m]", "% of path", "scale"]
    rows = [[title, number(ate[kind], "rmse_m", 4), number(ate[kind], "max_m", 4),
             number(ate[kind], "percent_of_path"), number(ate[kind], "scale", 4)]
            for kind, title in [*ALIGNMENTS.items(), ("never_moving", "(never moving)")]]
    return table(header, rows)


def _relative_lines(segments):
    if not segments:
        return ["Relative errors: the path is too short for any segment"]
    header = ["relative error over", "segments", "median [m]", "RMSE [m]", "median [%]", "drift [%]",
              "median [deg]", "RMSE [deg]"]
    rows = [[s["over"], s["segments"], number(s, "translation_median_m", 4), number(s, "translation_rmse_m", 4),
             number(s, "translation_median_percent"), number(s, "drift_percent"),
             number(s, "rotation_median_deg"), number(s, "rotation_rmse_deg")] for s in segments]
    return table(header, rows)


def _frame_lines(frames):
    header = ["frame to frame, medians", "eps_R [deg]", "eps_t [deg]"]
    rows = [["estimate", number(frames, "rotation_median_deg", 4), number(frames, "direction_median_deg")],
            ["always straight ahead", MISSING, number(frames, "straight_ahead_median_deg")]]
    return table(header, rows) + [f"({frames['frames']} frames; eps_t without {frames['standing_frames']} "
                                  "in which the body moved less than 1 mm)"]


def _nees_lines(consistency):
    header = ["NEES (honest: 1 and 95 %)", "frames", "dof", "mean / dof", "inside 95 % bound"]
    rows, notes = [], []
    for name, groups in consistency.items():
        rows += [[f"{name} {part}", values["frames"], values["dof"], number(values, "mean_per_dof"),
                  number(values, "inside_95_percent", 1) + " %"]
                 for part, values in groups.items() if isinstance(values, dict)]
        if groups["skipped_frames"]:
            notes.append(f"({name}: {groups['skipped_frames']} frames without a positive definite covariance skipped)")
    return table(header, rows) + notes
