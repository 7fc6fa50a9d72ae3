"""Kills jointsweep at its first, second, ... call of each system call that changes files. Usage: kill_everywhere.py PROGRAM CONFIG"""

import shutil
import subprocess
import sys
from pathlib import Path

PROGRAM, CONFIG = sys.argv[1:]
CALLS = "openat rename renameat unlink unlinkat write pwrite64 ftruncate fsync fdatasync mkdir rmdir flock".split()
# No command makes so many calls of one kind.
MOST = 1000

# Some plates are too thin for a mesh: their rows fail. The few designs have laws, too.
SWEEP = ['solve.method="fe"', "joint.plate.outer_radius_ratio=[1.00001, 1.2, 3.0]"]
ANSWERS = [
    'select.keep="peak_pressure < 500 MPa"',
    'reduce.statistics=["force", "energy"]',
    "reduce.quantiles=[0.1, 0.5]",
    'reduce.pareto={ largest = "force", smallest = "peak_pressure" }',
]
OUTPUTS = {
    "csv": [],
    "parquet": ['output.format="parquet"', 'output.inputs="varying"'],
    "answers": ANSWERS,
    "both": [*ANSWERS, "output.table=true", 'output.columns=["design", "force_n", "status"]'],
}
FOLDER = Path("result")


def run(*arguments):
    return subprocess.run([PROGRAM, *arguments], capture_output=True, text=True)


def finish(*arguments):
    """A command that nobody kills: it ends well, says nothing of damage and needs no permission."""
    ended = run(*arguments)
    # Rows that fail are rows.
    if ended.returncode not in (0, 2):
        return f"{' '.join(arguments)}: {ended.returncode}, {ended.stderr.strip()}"
    if "warning" in ended.stderr:
        return f"{' '.join(arguments)}: {ended.stderr.strip()}"
    return None


def content(folder):
    """All that is in the folder, but shards, the times in a manifest, and a lock that nobody holds."""
    files = (path for path in sorted(folder.rglob("*")) if path.suffix != ".shard" and path.name != ".jointsweep.lock")
    return {path.relative_to(folder): b"" if path.suffix == ".json" or path.is_dir() else path.read_bytes() for path in files}


def clear():
    shutil.rmtree(FOLDER, ignore_errors=True)


def from_copy(copy):
    def prepare():
        clear()
        shutil.copytree(copy, FOLDER)

    return prepare


def kills(prepare, command, again, expected):
    """Kills the command at each call in turn; the commands of `again` must make the folder what is expected."""
    count, problems = 0, []
    for call in CALLS:
        for number in range(1, MOST):
            prepare()
            inject = f"inject={call}:signal=SIGKILL:when={number}"
            ended = subprocess.run(
                ["strace", "-f", "-qq", "-o", "/dev/null", "-e", f"trace={call}", "-e", inject, PROGRAM, *command],
                capture_output=True,
            )
            if ended.returncode in (0, 2):
                break
            count += 1
            problem = next(filter(None, (finish(*arguments) for arguments in again)), None)
            found = content(FOLDER)
            if problem is None and found != expected:
                names = [str(name) for name in {**found, **expected} if found.get(name) != expected.get(name)]
                problem = f"not what a run in one piece leaves: {', '.join(names)}"
            if problem is not None:
                problems.append(f"{' '.join(command)}, killed at its {call} number {number}: {problem}")
        else:
            problems.append(f"{' '.join(command)}: more than {MOST} of {call}")
    return count, problems


def main():
    count, problems = 0, []
    for name, output in OUTPUTS.items():
        whole, shards = Path(f"whole-{name}"), Path(f"shards-{name}")
        settings = [argument for setting in SWEEP + output for argument in ("--set", setting)]
        command = ["run", CONFIG, "--out", str(FOLDER), "--threads", "1", *settings]
        clear()
        assert finish(*command) is None
        expected = content(FOLDER)
        assert len(expected) >= 3 and sum(map(len, expected.values())) > 1000, expected.keys()
        shutil.copytree(FOLDER, whole)
        parts = [[*command, "--shard", part] for part in ("1/2", "2/2")]
        merge = ["merge", str(FOLDER)]
        clear()
        assert all(finish(*part) is None for part in parts)
        shutil.copytree(FOLDER, shards)
        again = [*command, "--again"]
        retry = [*command, "--retry-failed"]
        cases = [
            (clear, command, [command]),
            (from_copy(whole), again, [again]),
            (clear, parts[0], [*parts, merge]),
            (from_copy(shards), merge, [*parts, merge]),
        ]
        if name == "csv":
            cases.append((from_copy(whole), retry, [retry]))
        for case in cases:
            killed, found = kills(*case, expected)
            assert killed > 20, f"{case[1]}: {killed} kills"
            count += killed
            problems += found
    print(f"{count} kills, {len(problems)} with another end than a run in one piece")
    for problem in problems:
        print(f"FAILED: {problem}")
    sys.exit(bool(problems))


main()
