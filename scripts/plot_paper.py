#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
"""Draws Figs. 3 to 7 of the paper from the CSV files of paper_experiments; writes report.md and claims.md beside them."""

import argparse
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from matplotlib.collections import LineCollection  # noqa: E402

import paper_claims  # noqa: E402
import paper_report  # noqa: E402
from paper_numbers import PAPER_NAMES  # noqa: E402
from paper_results import MOTIONS, SELECTIONS, NoiseFigure, read_rows, trajectory_errors  # noqa: E402

# Curves that should coincide are told apart by width: the wide one is drawn first.
STYLES = {"4pt-vertical": {"color": "#9ecae1", "linewidth": 5.0, "zorder": 1},
          "4pt-lee": {"color": "#08519c", "linewidth": 1.3, "zorder": 3},
          "4pt-liu": {"color": "#31a354", "linewidth": 1.6, "zorder": 2},
          "4pt-axis": {"color": "#fdae6b", "linewidth": 5.0, "zorder": 1},
          "4pt-sweeney": {"color": "#a63603", "linewidth": 1.3, "zorder": 3},
          "5pt-martyushev": {"color": "#756bb1", "linewidth": 1.6, "zorder": 2}}
DASHES = {"equivalent axis": (0, (4, 2))}
SELECTION_TITLES = {"nearest": "solution nearest the truth", "vote": "solution chosen by 20 further correspondences"}
METHOD_NAMES = dict(PAPER_NAMES, **{"ours": "ours, gravity given", "ours-no-prior": "ours, no prior"})


def _label(solver):
    return f"{solver} ({PAPER_NAMES[solver]})"


def draw_stability(directory):
    densities = {}
    for row in read_rows(directory / "fig3_stability.csv"):
        densities.setdefault((row["error"], row["solver"]), []).append((float(row["log10_rad"]), float(row["density"])))
    figure, panels = plt.subplots(1, 2, figsize=(11, 4.2), sharey=True)
    for axes, error in zip(panels, ("rotation", "translation")):
        for (kind, solver), points in densities.items():
            if kind == error:
                axes.plot(*zip(*points), label=_label(solver), **STYLES[solver])
        symbol = {"rotation": "R", "translation": "t"}[error]
        axes.set(title=error, xlabel=rf"$\log_{{10}}\,\varepsilon_\mathbf{{{symbol}}}$ [rad]", xlim=(-18, 1))
        axes.set_ylim(bottom=0.0)
        axes.grid(alpha=0.3)
    panels[0].set_ylabel("probability density")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="lower center", ncol=3, frameon=False)
    figure.suptitle("Fig. 3: numerical stability, no noise")
    figure.tight_layout(rect=(0, 0.12, 1, 1))
    return _save(figure, directory, "fig3_stability.png")


def draw_noise(directory, stem, level_column, title, level_label, selection):
    results = NoiseFigure(directory / f"{stem}.csv", level_column)
    figure, panels = plt.subplots(3, 2, figsize=(10, 11.5), sharex=True)
    for line, motion in zip(panels, MOTIONS):
        for axes, error in zip(line, ("rotation", "translation")):
            highest = []
            for solver, prior_noise in results.curves():
                label = _label(solver) + (f", {prior_noise}" if prior_noise.endswith("axis") else "")
                values = results.median(motion, selection, prior_noise, solver, error)
                axes.plot(results.levels(), values, label=label, linestyle=DASHES.get(prior_noise, "-"),
                          **STYLES[solver])
                highest.append(max(values))
            # An inferior solver may not squeeze the others.
            axes.set_ylim(0.0, 1.05 * min(max(highest), 3.0 * np.median(highest)))
            symbol = {"rotation": "R", "translation": "t"}[error]
            axes.set(title=f"{motion} motion", ylabel=rf"median $\varepsilon_\mathbf{{{symbol}}}$ [deg]")
            axes.grid(alpha=0.3)
    for axes in panels[-1]:
        axes.set_xlabel(level_label)
    handles, labels = panels[0][0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", ncol=2, frameon=False)
    figure.suptitle(f"{title}\n{SELECTION_TITLES[selection]}")
    figure.tight_layout(rect=(0, 0.02 + 0.02 * ((len(labels) + 1) // 2), 1, 1))
    return _save(figure, directory, f"{stem}_{selection}.png")


def draw_trajectories(directory):
    """Of sequence 00, else of the longest of the eleven, else of the longest; None where there is none."""
    runs = {}
    for row in read_rows(directory / "fig7_trajectory.csv"):
        runs.setdefault((row["sequence"], row["source"]), {}).setdefault(row["method"], []).append(
            [float(row[key]) for key in ("x_true_m", "y_true_m", "x_m", "y_m", "error_m")])
    if not runs:
        return None
    place = max(runs, key=lambda one: (one[0] == "00", len(one[0]) == 2, len(next(iter(runs[one].values())))))
    methods = {method: np.array(rows) for method, rows in runs[place].items()}
    highest = np.median([rows[:, 4].max() for rows in methods.values()])
    points = np.concatenate([rows[:, :4].reshape(-1, 2) for rows in methods.values()])
    low, high = points.min(axis=0), points.max(axis=0)
    half = 0.55 * np.maximum(high - low, 0.5 * np.max(high - low))  # a straight road is no line on paper
    errors = trajectory_errors(directory)
    figure, panels = plt.subplots(2, (len(methods) + 1) // 2, figsize=(15, 7), sharex=True, sharey=True,
                                  constrained_layout=True)
    for axes in panels.flat[len(methods):]:
        axes.set_visible(False)
    for axes, (method, rows) in zip(panels.flat, methods.items()):
        axes.plot(rows[:, 0], rows[:, 1], color="black", linewidth=1.2)
        segments = np.stack([rows[:-1, 2:4], rows[1:, 2:4]], axis=1)
        lines = LineCollection(segments, cmap="turbo", norm=plt.Normalize(0.0, highest), linewidth=2.2)
        lines.set_array(rows[1:, 4])
        axes.add_collection(lines)
        axes.set(aspect="equal", xlim=(low + high)[0] / 2 + half[0] * np.array([-1, 1]),
                 ylim=(low + high)[1] / 2 + half[1] * np.array([-1, 1]))
        axes.set_title(f"{METHOD_NAMES[method]}\nATE {errors[place][method]:.2f} m RMS", fontsize=10)
        axes.grid(alpha=0.3)
    for axes in panels[:, 0]:
        axes.set_ylabel("y [m]")
    for axes in panels[-1]:
        axes.set_xlabel("x [m]")
    figure.colorbar(lines, ax=panels, label="absolute trajectory error [m]", shrink=0.8, extend="max")
    figure.suptitle(f"Fig. 7: sequence {place[0]} ({place[1]}), ground truth in black")
    return _save(figure, directory, "fig7_trajectory.png")


def _save(figure, directory, name):
    figure.savefig(str(directory / name), dpi=110)
    plt.close(figure)
    return name


def draw(directory):
    """Writes all figures; their names by figure number."""
    figures = {3: [draw_stability(directory)]}
    for number, stem, column, title, label in (
            (4, "fig4_image_noise", "noise_px", "Fig. 4: image noise", "image noise [px]"),
            (5, "fig5_pitch_noise", "noise_deg", "Fig. 5: pitch noise, image noise 0.5 px", "pitch noise [deg]"),
            (6, "fig6_roll_noise", "noise_deg", "Fig. 6: roll noise, image noise 0.5 px", "roll noise [deg]")):
        figures[number] = [draw_noise(directory, stem, column, title, label, one) for one in SELECTIONS]
    trajectories = draw_trajectories(directory)
    figures[7] = [trajectories] if trajectories else []
    return figures


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("directory", type=pathlib.Path, help="CSV files of paper_experiments; figures are put there")
    directory = parser.parse_args(arguments).directory
    if not (directory / "table1_runtime.csv").is_file():
        print(f"plot_paper.py: {directory}: found no table1_runtime.csv, expected what paper_experiments writes",
              file=sys.stderr)
        return 1
    figures = draw(directory)
    claims = paper_claims.judge(directory)
    (directory / "claims.md").write_text(paper_claims.markdown(claims))
    (directory / "report.md").write_text(paper_report.markdown(directory, figures, claims))
    return 0


if __name__ == "__main__":
    sys.exit(main())
