# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
"""The CSV files of paper_experiments."""

import csv
import math

MOTIONS = ("forward", "random", "sideways")
SELECTIONS = ("nearest", "vote")
AXIS_NOISES = ("equivalent axis", "turned axis")
VERTICAL_SOLVERS = ("4pt-lee", "4pt-liu", "4pt-vertical")
OURS = ("ours", "ours-no-prior")


def read_rows(path):
    """The rows of a file as dictionaries."""
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def number(text):
    """NaN for "no data"."""
    return math.nan if text == "no data" else float(text)


class NoiseFigure:
    """Medians of Figs. 4 to 6."""

    def __init__(self, path, level_column):
        self._curves = {}
        for row in read_rows(path):
            key = row["motion"], row["selection"], row["prior_noise"], row["solver"]
            self._curves.setdefault(key, []).append(
                (float(row[level_column]), float(row["median_rotation_deg"]), float(row["median_translation_deg"]),
                 int(row["without_solution"])))
        for points in self._curves.values():
            points.sort()

    def curves(self):
        """(solver, prior noise) of all curves, in the order of the file."""
        found = []
        for _, _, prior_noise, solver in self._curves:
            if (solver, prior_noise) not in found:
                found.append((solver, prior_noise))
        return found

    def levels(self):
        return [point[0] for point in next(iter(self._curves.values()))]

    def median(self, motion, selection, prior_noise, solver, error):
        """Median errors [deg] by level; `error`: rotation or translation."""
        column = {"rotation": 1, "translation": 2}[error]
        return [point[column] for point in self._curves[motion, selection, prior_noise, solver]]


class KittiTable:
    """Medians of Table II or III."""

    def __init__(self, path):
        self._rows = {}
        self.places = []  # (sequence, source), those with data first
        for row in read_rows(path):
            place = row["sequence"], row["source"]
            if place not in self.places:
                self.places.append(place)
            self._rows[place + (row["method"],)] = row
        self.places.sort()

    def value(self, place, method, column="median_deg"):
        """NaN where there is no data."""
        row = self._rows.get(place + (method,))
        return math.nan if row is None else number(row[column])

    def measured_sequences(self):
        """Places of the eleven sequences that have data."""
        return [place for place in self.places if len(place[0]) == 2 and place[1] != "no data"]


def trajectory_errors(directory):
    """RMS of the absolute trajectory error [m] by place and method."""
    squares = {}
    for row in read_rows(directory / "fig7_trajectory.csv"):
        methods = squares.setdefault((row["sequence"], row["source"]), {})
        methods.setdefault(row["method"], []).append(float(row["error_m"]) ** 2)
    return {place: {method: math.sqrt(sum(values) / len(values)) for method, values in methods.items()}
            for place, methods in squares.items()}
