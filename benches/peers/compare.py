"""Times GetFEM, CalculiX and jointsweep on the same joints at the same measured error: results/peers.csv.

Whole processes, one thread each, in turns, so that noise of the machine meets all alike. A result that is not accepted
(see `State.judge`) has a status and no time. Started by benches/peers/run.
"""

import csv
import datetime
import json
import os
import platform
import re
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

from scene import HOLE_RADIUS, POISSONS_RATIO, THICKNESS, YOUNGS_MODULUS, Joint

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
JOINTSWEEP = ROOT / "target/release/jointsweep"
# Runs of each, unless they take longer than the seconds together.
RUNS, ENOUGH_SECONDS = 5, 40.0

TEN_STEPS = [0.02 * step for step in range(1, 11)]  # mm
STUDY = [5, 4, 3, 2, 1, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2, 0.1]  # mm, as in configs/liu2007.toml

# Converged forces, N, by outer ratio, clearance and indentation in mm: those of tests/engine/references.rs, to 1e-4.
KNOWN = {
    (3.0, 0.2, 0.02): 1418.31,
    (3.0, 0.2, 0.1): 11266.1,
    (3.0, 0.2, 0.2): 26919.8,
    (2.0, 0.2, 0.1): 13776.6,
    (10.0, 0.1, 0.1): 8212.4,
}
# All others are GetFEM's on a mesh that is finer everywhere, and meets those above.
REFERENCE_MESH = {"elements": 40, "growth": 1.2, "coarsest": 0.12}
# How the peers' meshes grow away from the contact; they are within 0.02 % of the references with many elements.
GRADING = {"growth": 1.4, "coarsest": 0.3}


class Workload(NamedTuple):
    name: str
    outer_ratio: float
    core_ratio: float
    clearances: list  # mm
    indentations: list  # mm

    def joints(self, clearances=None):
        steps = [step / HOLE_RADIUS for step in self.indentations]
        return [
            Joint(self.outer_ratio, self.core_ratio, clearance / HOLE_RADIUS, steps)
            for clearance in clearances or self.clearances
        ]


WORKLOADS = [
    Workload("point: half disc, ratio 3", 3.0, 0.0, [0.2], [0.1]),
    Workload("point: half disc, ratio 2", 2.0, 0.0, [0.2], [0.1]),
    Workload("point: cored disc, ratio 10", 10.0, 0.1, [0.1], [0.1]),
    Workload("curve: half disc, ratio 3", 3.0, 0.0, [0.2], TEN_STEPS),
    Workload("study: liu2007", 2.0, 0.0, STUDY, TEN_STEPS),
]

# Elements along the widest contact: the coarsest mesh from which on all finer ones tried have met the accuracy.
# For CalculiX also the contact's stiffness in Young's moduli per mm: the softest that does (its manual: 5 to 50).
MESHES = {
    ("GetFEM", "point", 0.01): (4, None),
    ("GetFEM", "point", 0.001): (7, None),
    ("GetFEM", "curve", 0.01): (5, None),
    ("GetFEM", "curve", 0.001): (20, None),
    ("GetFEM", "study", 0.01): (6, None),
    ("GetFEM", "study", 0.001): (23, None),
    ("CalculiX", "point", 0.01): (4, 5.0),
    ("CalculiX", "point", 0.001): (10, 20.0),
    ("CalculiX", "curve", 0.01): (6, 5.0),
    ("CalculiX", "curve", 0.001): (14, 20.0),
    ("CalculiX", "study", 0.01): (6, 5.0),
    ("CalculiX", "study", 0.001): (24, 50.0),
}
# Where the whole takes too long: these designs, and the time of the whole by their number.
EXTRAPOLATED = {("CalculiX", "study", 0.001): [5, 1, 0.5, 0.1]}

COLUMNS = (
    "program,version,workload,asked_error,mesh,unknowns,designs,designs_run,steps,runs,wall_median_s,wall_min_s,"
    "wall_max_s,work_median_s,processor_median_s,peak_memory_mb,measured_error,status"
).split(",")


class Process(NamedTuple):
    output: str
    wall: float
    processor: float
    peak_memory: float  # MB
    code: int


def run(command, given=""):
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    with tempfile.TemporaryFile("w+") as standard_input, tempfile.TemporaryFile("w+") as output:
        standard_input.write(given)
        standard_input.seek(0)
        start = time.perf_counter()
        process = subprocess.Popen(command, stdin=standard_input, stdout=output, stderr=output, env=environment, cwd=HERE)
        _, status, usage = os.wait4(process.pid, 0)
        wall = time.perf_counter() - start
        process.returncode = os.waitstatus_to_exitcode(status)
        output.seek(0)
        return Process(
            output.read(), wall, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024, process.returncode
        )


def run_peer(program, joints, mesh):
    job = {**mesh, "joints": [joint._asdict() for joint in joints]}
    process = run([sys.executable, f"{program.lower()}_joint.py"], json.dumps(job))
    lines = [line for line in process.output.splitlines() if line.startswith("{")]
    if process.code != 0 or not lines:
        return process, {"unknowns": "", "forces": [], "problems": [process.output[-200:]], "work_seconds": 0.0}
    return process, json.loads(lines[-1])


def run_jointsweep(workload, asked_error, folder):
    pin = f'"rigid-core"\ncore_radius_ratio = {workload.core_ratio}' if workload.core_ratio else '"rigid-midplane"'
    material = f'youngs_modulus = "{YOUNGS_MODULUS / 1e3} GPa"\npoissons_ratio = {POISSONS_RATIO}'
    config = folder / "config.toml"
    config.write_text(f"""\
[joint]
idealization = "plane-stress"
hole_radius = "{HOLE_RADIUS} mm"
radial_clearance = {[f"{clearance} mm" for clearance in workload.clearances]}
thickness = "{THICKNESS} mm"
[joint.pin]
model = {pin}
{material}
[joint.plate]
model = "annulus"
outer_radius_ratio = {workload.outer_ratio}
{material}
[load]
indentation = {[f"{indentation:.6g} mm" for indentation in workload.indentations]}
[solve]
accuracy = "{100 * asked_error:g} %"
""")
    out = folder / "out"
    process = run([JOINTSWEEP, "run", config, "--out", out, "--threads", "1", "--backend", "cpu", "--force", "--quiet"])
    if process.code != 0:
        return process, {"forces": [], "problems": [process.output[-200:]], "work_seconds": 0.0, "mesh": ""}
    with open(out / "table.csv") as file:
        rows = list(csv.DictReader(file))
    steps = len(workload.indentations)
    forces = [float(row["force_n"] or "nan") for row in rows]
    manifest = json.loads((out / "manifest.json").read_text())
    # Its own count: what wait4 tells is at least the size of this script.
    process = process._replace(peak_memory=manifest["peak_memory_bytes"] / 1e6)
    return process, {
        "forces": [forces[n : n + steps] for n in range(0, len(forces), steps)],
        "problems": [row["status"] for row in rows if row["status"] not in ("ok", "large displacement")],
        "work_seconds": manifest["wall_seconds"],
        "mesh": rows[0]["method"],
    }


class State:
    """One program on one workload at one accuracy."""

    def __init__(self, program, workload, asked_error, reference):
        self.program, self.workload, self.asked_error = program, workload, asked_error
        key = (program, workload.name.split(":")[0], asked_error)
        self.mesh = MESHES.get(key)
        self.clearances = EXTRAPOLATED.get(key, workload.clearances)
        self.reference = [reference[clearance] for clearance in self.clearances]
        self.processes, self.results, self.status, self.measured_error = [], [], "ok", ""

    def done(self):
        spent = sum(process.wall for process in self.processes)
        return self.status != "ok" or len(self.processes) == RUNS or spent > ENOUGH_SECONDS

    def run_once(self, folder):
        if self.mesh:
            elements, penalty = self.mesh
            mesh = {**GRADING, "elements": elements, "penalty": penalty}
            process, result = run_peer(self.program, self.workload.joints(self.clearances), mesh)
        else:
            process, result = run_jointsweep(self.workload, self.asked_error, folder)
        self.processes.append(process)
        self.results.append(result)
        self.judge(result)

    def judge(self, result):
        """Accepted: converged, no tension, in equilibrium (the peers' scripts look), and within the asked error."""
        if result["problems"]:
            self.status = "failed: " + "; ".join(sorted(set(result["problems"])))
            return
        errors = [
            abs(force / reference - 1)
            for forces, references in zip(result["forces"], self.reference, strict=True)
            for force, reference in zip(forces, references, strict=True)
        ]
        self.measured_error = max(errors)
        if not self.measured_error <= self.asked_error:
            self.status = "failed: not within the asked error"

    def row(self, versions):
        share = len(self.workload.clearances) / len(self.clearances)
        accepted = self.status == "ok"
        walls = [share * process.wall for process in self.processes]
        works = [share * result["work_seconds"] for result in self.results]
        processors = [share * process.processor for process in self.processes]

        def seconds(function, values):
            return f"{function(values):.4g}" if accepted else ""

        if self.mesh:
            elements, penalty = self.mesh
            mesh = f"{elements} along the contact" + (f", {penalty:g} E/mm" if penalty else "")
        else:
            mesh = self.results[0]["mesh"]
        extrapolated = accepted and share > 1
        return [
            self.program,
            versions[self.program],
            self.workload.name,
            self.asked_error,
            mesh,
            self.results[0].get("unknowns", ""),
            len(self.workload.clearances),
            len(self.clearances),
            len(self.workload.indentations),
            len(self.processes),
            seconds(statistics.median, walls),
            seconds(min, walls),
            seconds(max, walls),
            seconds(statistics.median, works),
            seconds(statistics.median, processors),
            f"{max(process.peak_memory for process in self.processes):.1f}",
            f"{self.measured_error:.2e}" if self.measured_error != "" else "",
            "ok: time of the designs run, extrapolated" if extrapolated else self.status,
        ]


def references():
    """By workload and clearance, the forces of all steps; and how far the fine meshes are from what is known."""
    found, deviations = {}, []
    for workload in WORKLOADS:
        _, result = run_peer("GetFEM", workload.joints(), REFERENCE_MESH)
        if result["problems"]:
            sys.exit(f"no reference for {workload.name}: {result['problems']}")
        found[workload.name] = dict(zip(workload.clearances, result["forces"]))
        for clearance, forces in found[workload.name].items():
            for step, indentation in enumerate(workload.indentations):
                known = KNOWN.get((workload.outer_ratio, clearance, round(indentation, 6)))
                if known and workload.core_ratio == (0.1 if workload.outer_ratio == 10.0 else 0.0):
                    deviations.append(abs(forces[step] / known - 1))
                    forces[step] = known
    if max(deviations) > 2e-4:
        sys.exit(f"the fine meshes are {max(deviations):.1e} from the known forces")
    return found, max(deviations)


def text_of(*command):
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout.strip()


def peers_versions():
    return {
        "GetFEM": text_of("dpkg-query", "-W", "-f", "${Version}", "python3-getfem"),
        "CalculiX": text_of("dpkg-query", "-W", "-f", "${Version}", "calculix-ccx"),
    }


def host():
    return {
        "os": platform.system().lower(),
        "arch": platform.machine(),
        "cpu": re.search("model name\\s*: (.*)", Path("/proc/cpuinfo").read_text())[1],
        "processors": os.cpu_count(),
    }


def main():
    started = datetime.datetime.now(datetime.timezone.utc)
    versions = {
        **peers_versions(),
        "jointsweep": text_of(JOINTSWEEP, "--version").split()[1],
    }
    forces, deviation = references()
    states = [
        State(program, workload, asked_error, forces[workload.name])
        for workload in WORKLOADS
        for asked_error in (0.01, 0.001)
        for program in versions
    ]
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(RUNS):
            for state in states:
                if not state.done():
                    state.run_once(Path(folder))
    rows = [state.row(versions) for state in states]
    with open(ROOT / "results/peers.csv", "w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([COLUMNS, *rows])
    manifest = {
        "command": "benches/peers/run",
        "commit": text_of("git", "rev-parse", "--short", "HEAD"),
        "started_utc": started.strftime("%Y-%m-%dT%H:%M:%SZ"),
        "wall_seconds": round((datetime.datetime.now(datetime.timezone.utc) - started).total_seconds(), 1),
        "versions": {**versions, "python": platform.python_version()},
        "threads": 1,
        "runs": f"{RUNS} each, fewer where they take more than {ENOUGH_SECONDS:g} s together",
        "references": {
            "source": "tests/engine/references.rs; else GetFEM on a finer mesh",
            "finer_mesh": REFERENCE_MESH,
            "worst_deviation_of_the_second_from_the_first": float(f"{deviation:.2e}"),
        },
        "host": host(),
    }
    (ROOT / "results/peers.manifest.json").write_text(json.dumps(manifest, indent=2) + "\n")
    print((ROOT / "results/peers.csv").read_text())


if __name__ == "__main__":
    main()
