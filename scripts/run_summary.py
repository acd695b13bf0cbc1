# SPDX-FileCopyrightText: 2026 multicam_egomotion authors
# SPDX-License-Identifier: BSD-3-Clause
"""Many bags as one table: what egomotion_bag and evaluate.py reported of each, and which bags failed.

Of a bag NAME a directory may hold the report of egomotion_bag, that of evaluate.py (NAME.json, NAME.report.json,
NAME.evaluation.json: told apart by what is in them) and what egomotion_bag printed (NAME.log). A bag has failed that
has a log and no report, a report without a pose, or a file that is no JSON.
"""

import json
import statistics

from dataset_files import InputError, require_directory
from evaluation_text import MISSING, number, table

SUFFIXES = (".evaluation.json", ".report.json", ".json", ".log")


def summarize(directory):
    """{"bags": {name: {"run": ..., "evaluation": ...}}, "failed": {name: why}, "medians": {...}} of a directory."""
    bags, failed, logs, files = {}, {}, {}, 0
    for path in sorted(require_directory(directory).iterdir()):
        suffix = next((suffix for suffix in SUFFIXES if path.name.endswith(suffix)), None)
        if suffix is None or not path.is_file():
            continue
        name = path.name[:-len(suffix)]
        if suffix == ".log":
            logs[name] = path
            continue
        files += 1
        try:
            report = json.loads(path.read_text())
        except ValueError as error:
            failed[name] = f"{path.name} is no JSON: {error}"
            continue
        kind = _kind(report)
        if kind:
            bags.setdefault(name, {})[kind] = report
    for name, path in logs.items():
        if "run" not in bags.get(name, {}) and name not in failed:
            failed[name] = _last_line(path)
    for name, reports in bags.items():
        if reports.get("run", {}).get("poses") == 0:
            failed[name] = "no pose"
    if not bags and not failed:
        raise InputError(f"{directory}: found no report of egomotion_bag or evaluate.py among {files} .json files, "
                         "and no .log file")
    rows = [values(reports) for reports in bags.values()]
    medians = {key: statistics.median(row[key] for row in rows if key in row)
               for key in COLUMNS if any(key in row for row in rows)}
    return {"bags": bags, "failed": failed, "medians": medians}


def _kind(report):
    """Which tool a report is of; None: of neither."""
    if not isinstance(report, dict):
        return None
    if "ate" in report and "frame_to_frame" in report:
        return "evaluation"
    return "run" if "stages" in report and "faults" in report else None


def _last_line(path):
    lines = path.read_text(errors="replace").split("\n")
    return next((line.strip() for line in reversed(lines) if line.strip()), "no report, and nothing in its log")


# Columns of the table: title, digits.
COLUMNS = {
    "poses": ("poses", 0), "faults": ("faults", 0), "p99_ms": ("p99 [ms]", 1), "cpu_s": ("CPU [s]", 1),
    "memory_mb": ("[MB]", 0), "path_m": ("path [m]", 1), "ate_m": ("ATE [m]", 4), "ate_percent": ("ATE [%]", 3),
    "scale": ("Sim(3) scale", 4), "drift_percent": ("drift [%]", 3), "rotation_deg": ("eps_R [deg]", 4),
    "direction_deg": ("eps_t [deg]", 3),
}


def values(reports):
    """The numbers of one bag, by column; what is not known is left out."""
    found = {}

    def take(key, source, name):
        if name in source:
            found[key] = source[name]

    run, evaluation = reports.get("run", {}), reports.get("evaluation", {})
    if evaluation:
        ate, frames = evaluation["ate"], evaluation["frame_to_frame"]
        by_length = [segment for segment in evaluation.get("relative", []) if segment["over"].endswith(" m")]
        take("poses", evaluation, "poses")
        take("path_m", evaluation, "path_m")
        take("ate_m", ate.get("position_yaw", {}), "rmse_m")
        take("ate_percent", ate.get("position_yaw", {}), "percent_of_path")
        take("scale", ate.get("sim3", {}), "scale")
        take("drift_percent", by_length[-1] if by_length else {}, "drift_percent")
        take("rotation_deg", frames, "rotation_median_deg")
        take("direction_deg", frames, "direction_median_deg")
    if run:
        take("poses", run, "poses")
        found["faults"] = sum(run["faults"].values())
        take("p99_ms", run["stages"].get("frame", {}), "p99_ms")
        take("cpu_s", run, "cpu_s")
        take("memory_mb", run, "peak_memory_mb")
    return found


def summary_text(summary):
    """A line a bag, the medians, and the bags that failed."""
    rows = {name: values(reports) for name, reports in summary["bags"].items()}
    columns = [key for key in COLUMNS if key in summary["medians"]]
    overs = {name: _over(reports) for name, reports in summary["bags"].items()}
    with_over = "drift_percent" in columns
    header = ["name"] + [COLUMNS[key][0] for key in columns] + ["over"] * with_over

    def line(name, row, over):
        return [name] + [number(row, key, COLUMNS[key][1]) for key in columns] + [over] * with_over

    body = [line(name, row, overs[name]) for name, row in rows.items()]
    if len(rows) > 1:
        body.append(line("median", summary["medians"], MISSING))
    lines = table(header, body) if rows else []
    names = set(rows) | set(summary["failed"])
    lines.append(f"{len(names)} bags, {len(summary['failed'])} failed" + ":" * bool(summary["failed"]))
    lines += [f"  {name}: {why}" for name, why in sorted(summary["failed"].items())]
    return "\n".join(lines)


def _over(reports):
    lengths = [segment["over"] for segment in reports.get("evaluation", {}).get("relative", [])
               if segment["over"].endswith(" m")]
    return lengths[-1] if lengths else MISSING
