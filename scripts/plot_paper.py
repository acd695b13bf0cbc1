#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
"""Draws the figures of paper_experiments and writes report.md and claims.md beside them."""

import argparse
import pathlib
import sys

import paper_claims
import paper_figures
import paper_report


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("directory", type=pathlib.Path, help="CSV files of paper_experiments; figures are put there")
    directory = parser.parse_args(arguments).directory
    if not (directory / "table1_runtime.csv").is_file():
        print(f"plot_paper.py: {directory}: found no table1_runtime.csv, expected what paper_experiments writes",
              file=sys.stderr)
        return 1
    figures = paper_figures.draw(directory)
    claims = paper_claims.judge(directory)
    (directory / "claims.md").write_text(paper_claims.markdown(claims))
    (directory / "report.md").write_text(paper_report.markdown(directory, figures, claims))
    return 0


if __name__ == "__main__":
    sys.exit(main())
