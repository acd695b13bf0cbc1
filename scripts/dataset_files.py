# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
"""Checked reading of recorded data sets: every complaint names the file, what was found and what was expected."""

import pathlib

import numpy as np
from PIL import Image


class InputError(Exception):
    """The input cannot be used; the text says which file and why."""


def require_file(path):
    """The path, which must be an existing file."""
    path = pathlib.Path(path)
    if not path.is_file():
        raise InputError(f"{path}: no such file")
    return path


def require_directory(path):
    """The path, which must be an existing directory."""
    path = pathlib.Path(path)
    if not path.is_dir():
        raise InputError(f"{path}: no such directory")
    return path


def require_count(path, found, expected, what, reason):
    """Complains when `found` differs from `expected`; `reason` says where the expectation comes from."""
    if found != expected:
        raise InputError(f"{path}: found {found} {what}, expected {expected} ({reason})")


def require_increasing(path, stamps_ns):
    """Stamps [ns] must increase strictly."""
    bad = np.flatnonzero(np.diff(np.asarray(stamps_ns, dtype=np.int64)) <= 0)
    if bad.size:
        raise InputError(f"{path}: stamp {bad[0] + 2} of {len(stamps_ns)} is not later than the one before it")


def read_lines(path):
    """Lines that are neither empty nor a # comment, stripped."""
    lines = (line.strip() for line in require_file(path).read_text().splitlines())
    return [line for line in lines if line and not line.startswith("#")]


def read_numbers(path, columns, delimiter=None):
    """Table (n, columns) of floats; every line must have at least `columns` numbers, further ones are ignored."""
    rows = []
    for number, line in enumerate(read_lines(path), start=1):
        cells = line.split(delimiter)
        require_count(f"{path}, data line {number}", min(len(cells), columns), columns, "columns", "the file format")
        try:
            rows.append([float(cell) for cell in cells[:columns]])
        except ValueError as error:
            raise InputError(f"{path}, data line {number}: {error}, expected {columns} numbers") from None
    if not rows:
        raise InputError(f"{path}: found no data lines, expected at least one")
    return np.array(rows)


def read_image(path, resolution=None):
    """Image as (array, ROS encoding): mono8, mono16 or rgb8; `resolution` (width, height) [px] is checked."""
    try:
        with Image.open(require_file(path)) as image:
            if image.mode.startswith("I"):
                pixels, encoding = np.asarray(image).astype("<u2"), "mono16"
            elif image.mode == "L":
                pixels, encoding = np.asarray(image), "mono8"
            else:
                pixels, encoding = np.asarray(image.convert("RGB")), "rgb8"
    except OSError as error:
        raise InputError(f"{path}: not a readable image ({error})") from None
    found = (pixels.shape[1], pixels.shape[0])
    if resolution is not None and found != tuple(resolution):
        raise InputError(f"{path}: found an image of {found[0]}x{found[1]} px, "
                         f"expected {resolution[0]}x{resolution[1]}")
    return pixels, encoding
