"""Forces of lined joints and press fits by jointsweep, GetFEM and CalculiX: results/lined-peers.csv.

Each load is solved from rest on two meshes, the finer of which counts. From rest, because CalculiX pairs the outlines anew at the
start of each step, where the pin has come to, and the others where they first touch. CalculiX's contact is elastic: its force is
linear in the inverse of the contact's stiffness, so two stiffnesses give that of a rigid contact. Started by benches/peers/run.
"""

import csv
import datetime
import json
import platform
import sys
import tempfile
from math import degrees
from pathlib import Path

from compare import JOINTSWEEP, ROOT, host, peers_versions, run, run_peer, text_of
from scene import HOLE_RADIUS, THICKNESS, Joint

STEEL, ALUMINIUM, BRONZE = (210e3, 0.3), (70e3, 0.33), (110e3, 0.34)
POLYMER, FILLED, HARD_PLASTIC, RUBBER = (3e3, 0.4), (8e3, 0.38), (5e3, 0.35), (50.0, 0.45)


def part(core, *layers):
    """Materials from the contact inwards: layers (thickness in hole radii, material), then what is left."""
    return [(thickness, *material) for thickness, material in layers] + [(None, *core)]


# Indentations in hole radii with clearance, offsets from the concentric position in press fits.
JOINTS = {
    "polymer bush in a steel plate": Joint(
        3.0, 0.1, 0.003, [0.0005, 0.003], part(STEEL), part(STEEL, (0.1, POLYMER)), "stress"
    ),
    "thin steel sleeve on a plastic plate": Joint(
        4.0, 0.1, 0.001, [0.0005, 0.002], part(STEEL), part(HARD_PLASTIC, (0.04, STEEL)), "strain"
    ),
    "coating on a half disc, aluminium plate": Joint(
        2.5, 0.0, 0.005, [0.0005, 0.003], part(STEEL, (0.03, FILLED)), part(ALUMINIUM), "stress"
    ),
    "rubber sleeve in an aluminium plate": Joint(
        2.0, 0.3, 0.02, [0.001, 0.005], part(STEEL), part(ALUMINIUM, (0.2, RUBBER)), "strain"
    ),
    "liner on a bronze bush in a steel plate": Joint(
        3.0, 0.2, 0.0005, [0.0001, 0.0004], part(STEEL), part(STEEL, (0.03, FILLED), (0.1, BRONZE)), "strain"
    ),
    "polymer bush in an aluminium block": Joint(
        0.0, 0.1, 0.002, [0.0003, 0.0008], part(STEEL), part(ALUMINIUM, (0.15, POLYMER)), "stress", [3.0, 1.6, 2.0]
    ),
    "press fit, steel pin in aluminium": Joint(
        2.0, 0.1, -0.0005, [0.0004, 0.001, 0.002], part(STEEL), part(ALUMINIUM), "stress"
    ),
    "press fit, aluminium pin in steel": Joint(
        3.0, 0.3, -0.0005, [0.0004, 0.0009, 0.0015], part(ALUMINIUM), part(STEEL), "strain"
    ),
    "press fit, steel pin in a polymer bush in aluminium": Joint(
        2.5, 0.1, -0.0003, [0.0002, 0.0006, 0.0011], part(STEEL), part(ALUMINIUM, (0.1, POLYMER)), "stress"
    ),
}

ACCURACY = 1e-4  # asked of jointsweep
GRADING = {"growth": 1.3, "coarsest": 0.2}
# Elements along the contact: of the coarser mesh and of the finer one.
MESHES = {"GetFEM": (30, 60), "CalculiX": (20, 40)}
# Of CalculiX's contact, in Young's moduli per mm: the stiffer one for both meshes, the softer one for the finer.
STIFFER, SOFTER = 400.0, 100.0
# A row is accepted up to this difference of the forces, and this change from mesh to mesh.
LARGEST_DIFFERENCE, LARGEST_CHANGE = 1e-3, 3e-4

COLUMNS = (
    "joint,idealization,pin,plate,clearance_ratio,load,load_mm,program,version,mesh,unknowns,force_n,mesh_change,"
    "stiffness_correction,jointsweep_force_n,jointsweep_method,jointsweep_force_error,contact_half_angle_deg,difference,status"
).split(",")


def words(materials, shape):
    layers = [f"{thickness:g} of {modulus / 1e3:g} GPa {ratio:g}" for thickness, modulus, ratio in materials[:-1]]
    _, modulus, ratio = materials[-1]
    return ", ".join([*layers, f"{modulus / 1e3:g} GPa {ratio:g}", shape])


def pin_shape(joint):
    return f"core {joint.core_ratio:g}" if joint.core_ratio else "half disc"


def plate_shape(joint):
    return f"block {'/'.join(f'{size:g}' for size in joint.block)}" if joint.block else f"ratio {joint.outer_ratio:g}"


def mm(ratio):
    return f"{HOLE_RADIUS * ratio:.12g} mm"


def config_of(joint):
    def constants(modulus, ratio):
        return f'youngs_modulus = "{modulus:.12g} MPa"\npoissons_ratio = {ratio:.12g}\n'

    def part_of(name, shape, materials):
        layers = "".join(
            f'[[joint.{name}.layers]]\nthickness = "{mm(thickness)}"\n' + constants(modulus, ratio)
            for thickness, modulus, ratio in materials[:-1]
        )
        return f"[joint.{name}]\n{shape}\n{constants(*materials[-1][1:])}{layers}"

    pin = f'model = "rigid-core"\ncore_radius_ratio = {joint.core_ratio}' if joint.core_ratio else 'model = "rigid-midplane"'
    plate = f'model = "annulus"\nouter_radius_ratio = {joint.outer_ratio}'
    if joint.block:
        names = ("half_width_ratio", "depth_ratio", "height_ratio")
        ratios = [f"{name} = {size}" for name, size in zip(names, joint.block, strict=True)]
        plate = "\n".join(['model = "block"', 'support = "base"', *ratios])
    return f"""\
[joint]
idealization = "plane-{joint.plane}"
hole_radius = "{HOLE_RADIUS} mm"
radial_clearance = "{mm(joint.clearance)}"
thickness = "{THICKNESS} mm"
{part_of("pin", pin, joint.pin)}{part_of("plate", plate, joint.plate)}[load]
{"offset" if joint.is_press_fit() else "indentation"} = {json.dumps([mm(descent) for descent in joint.descents])}
[solve]
accuracy = {ACCURACY}
"""


def solve_by_jointsweep(joint, folder):
    """A row of its table for each load."""
    config, out = folder / "config.toml", folder / "out"
    config.write_text(config_of(joint))
    process = run([JOINTSWEEP, "run", config, "--out", out, "--threads", "1", "--backend", "cpu", "--force", "--quiet"])
    if process.code != 0:
        sys.exit(f"jointsweep: {process.output}\n{config.read_text()}")
    with open(out / "table.csv") as file:
        rows = list(csv.DictReader(file))
    failed = [row["status"] for row in rows if row["status"] not in ("ok", "large displacement")]
    if failed or len(rows) != len(joint.descents):
        sys.exit(f"jointsweep: {len(rows)} rows, {failed}\n{config.read_text()}")
    return rows


def solve_by_peer(program, joint, elements, stiffness=None):
    """Its force for one load, the unknowns and the problems."""
    mesh = {**GRADING, "elements": elements, "penalty": stiffness, "settled": True}
    _, result = run_peer(program, [joint], mesh)
    forces = [force for of_joint in result["forces"] for force in of_joint]
    if len(forces) != 1 and not result["problems"]:
        sys.exit(f"{program}: {len(forces)} forces for one load")
    return forces[0] if forces else float("nan"), result["unknowns"], result["problems"]


def converge(program, joint):
    """The cells of a row from `mesh` to `stiffness_correction`, by column, and what is wrong with them."""
    coarser, finer = MESHES[program]
    if program == "GetFEM":
        runs = [solve_by_peer(program, joint, elements) for elements in (coarser, finer)]
        correction, mesh = "", f"{coarser} and {finer} along the contact"
    else:
        meshes = [(coarser, STIFFER), (finer, STIFFER), (finer, SOFTER)]
        runs = [solve_by_peer(program, joint, elements, stiffness) for elements, stiffness in meshes]
        correction = (runs[1][0] / runs[2][0] - 1) / (STIFFER / SOFTER - 1)
        mesh = f"{coarser} and {finer} along the contact, {SOFTER:g} and {STIFFER:g} E/mm"
    (coarse, *_), (fine, unknowns, _) = runs[:2]
    return {
        "mesh": mesh,
        "unknowns": unknowns,
        "force_n": fine * (1 + (correction or 0.0)),
        "mesh_change": fine / coarse - 1,
        "stiffness_correction": correction,
    }, sorted({problem for *_, problems in runs for problem in problems})


def rows_of(name, joint, versions, found):
    for descent, own in zip(joint.descents, found, strict=True):
        alone = joint._replace(descents=[descent])
        if not joint.is_press_fit() and float(own["contact_half_angle_deg"]) > degrees(alone.widest_angle()):
            sys.exit(f"{name}: contact is wider than the meshes are fine")
        for program, version in versions.items():
            cells, problems = converge(program, alone)
            force = float(own["force_n"])
            difference = cells["force_n"] / force - 1
            if not abs(difference) <= LARGEST_DIFFERENCE:
                problems.append("forces differ")
            if not abs(cells["mesh_change"]) <= LARGEST_CHANGE:
                problems.append("the mesh changes the force")
            row = {
                "joint": name,
                "idealization": f"plane-{joint.plane}",
                "pin": words(joint.pin, pin_shape(joint)),
                "plate": words(joint.plate, plate_shape(joint)),
                "clearance_ratio": joint.clearance,
                "load": "offset" if joint.is_press_fit() else "indentation",
                "load_mm": f"{HOLE_RADIUS * descent:.6g}",
                "program": program,
                "version": version,
                "mesh": cells["mesh"],
                "unknowns": cells["unknowns"],
                "force_n": f"{cells['force_n']:.8g}",
                "mesh_change": f"{cells['mesh_change']:.2e}",
                "stiffness_correction": f"{cells['stiffness_correction']:.2e}" if cells["stiffness_correction"] else "",
                "jointsweep_force_n": f"{force:.8g}",
                "jointsweep_method": own["method"],
                "jointsweep_force_error": f"{float(own['force_error']):.2e}",
                "contact_half_angle_deg": f"{float(own['contact_half_angle_deg']):.4g}",
                "difference": f"{difference:.2e}",
                "status": "failed: " + "; ".join(problems) if problems else "ok",
            }
            print(f"{name}, {row['load_mm']} mm, {program}: {row['difference']}, {row['status']}", flush=True)
            yield row


def main():
    started = datetime.datetime.now(datetime.timezone.utc)
    versions = peers_versions()
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for name, joint in JOINTS.items():
            rows.extend(rows_of(name, joint, versions, solve_by_jointsweep(joint, Path(folder))))
    with open(ROOT / "results/lined-peers.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    manifest = {
        "command": "benches/peers/run lined",
        # Of the program: the last that changed what it is built of.
        "commit": text_of("git", "log", "-1", "--format=%h", "--", "src", "shaders", "build.rs", "Cargo.toml", "Cargo.lock"),
        "started_utc": started.strftime("%Y-%m-%dT%H:%M:%SZ"),
        "wall_seconds": round((datetime.datetime.now(datetime.timezone.utc) - started).total_seconds(), 1),
        "versions": {
            **versions,
            "jointsweep": text_of(JOINTSWEEP, "--version").split()[1],
            "python": platform.python_version(),
        },
        "accuracy_asked": ACCURACY,
        "hole_radius_mm": HOLE_RADIUS,
        "grading": GRADING,
        "rows": len(rows),
        "worst_difference": max(abs(float(row["difference"])) for row in rows),
        "host": host(),
    }
    (ROOT / "results/lined-peers.manifest.json").write_text(json.dumps(manifest, indent=2) + "\n")
    failed = [row for row in rows if row["status"] != "ok"]
    if failed:
        sys.exit(f"{len(failed)} of {len(rows)} rows are not accepted")


if __name__ == "__main__":
    main()
