# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the paper prints: Table I [us], Tables II and III [deg], by the names that its solvers have here."""

SOLVERS = ("5pt-martyushev", "4pt-lee", "4pt-liu", "4pt-sweeney", "4pt-vertical", "4pt-axis")
PAPER_NAMES = {"5pt-martyushev": "5pt-Martyushev", "4pt-lee": "4pt-Lee", "4pt-liu": "4pt-Liu",
               "4pt-sweeney": "4pt-Sweeney", "4pt-vertical": "4pt-Our", "4pt-axis": "4pt-Our-Axis"}
SEQUENCES = tuple(f"{number:02d}" for number in range(11))


def _table(text):
    rows = [[float(word) for word in line.split()] for line in text.strip().splitlines()]
    return {(sequence, solver): value for sequence, row in zip(SEQUENCES, rows) for solver, value in zip(SOLVERS, row)}


RUNTIME_US = dict(zip(SOLVERS, (591.356, 28.024, 8.268, 22.186, 21.343, 14.334)))

ROTATION_DEG = _table("""
0.059 0.031 0.032 0.033 0.031 0.032
0.047 0.044 0.043 0.028 0.045 0.027
0.056 0.028 0.028 0.030 0.027 0.029
0.058 0.037 0.038 0.037 0.037 0.036
0.036 0.019 0.022 0.021 0.020 0.022
0.046 0.022 0.022 0.023 0.022 0.021
0.038 0.024 0.023 0.022 0.023 0.021
0.047 0.022 0.022 0.022 0.021 0.022
0.048 0.023 0.022 0.024 0.021 0.024
0.054 0.025 0.025 0.027 0.024 0.026
0.057 0.024 0.024 0.026 0.023 0.025
""")

TRANSLATION_DEG = _table("""
1.409 1.317 1.310 1.116 1.288 1.113
1.991 2.228 2.066 1.263 2.174 1.218
1.112 1.062 1.068 0.977 1.069 0.975
1.601 1.436 1.484 1.210 1.389 1.175
0.723 0.676 0.759 0.605 0.756 0.612
1.113 0.928 0.925 0.776 0.923 0.750
0.722 0.710 0.728 0.571 0.720 0.566
1.463 1.066 1.064 0.918 1.039 0.950
1.477 1.412 1.371 1.248 1.372 1.222
0.995 0.922 0.894 0.873 0.933 0.824
1.101 1.050 1.059 0.920 1.065 0.883
""")
