// The library in WebAssembly gives the forces that the program gives: node tests/wasm/check.mjs WASM PROGRAM

import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { fileURLToPath } from "node:url";

const [wasm, program] = process.argv.slice(2);
const { instance } = await WebAssembly.instantiate(readFileSync(wasm), {});

const indentations = [0.001, 0.01, 0.1];
const outerRadii = [15, 30, 200];
// The joint of examples/wasm_joint.rs.
const config = fileURLToPath(new URL("../../configs/quickstart.toml", import.meta.url));
const joint = (outerRadius, method) =>
  [
    "joint.hole_radius=10 mm",
    "joint.radial_clearance=0.05 mm",
    "joint.thickness=8 mm",
    "joint.pin.core_radius_ratio=0.2",
    `joint.plate.outer_radius_ratio=${outerRadius / 10}`,
    `load.indentation=[${indentations.map((value) => `"${value} mm"`)}]`,
    `solve.method=${method}`,
    "solve.accuracy=0.1 %",
  ].flatMap((setting) => ["--set", setting]);

let compared = 0;
const dir = mkdtempSync(join(tmpdir(), "jointsweep-"));
try {
  for (const method of ["fe", "series"]) {
    for (const outerRadius of outerRadii) {
      const out = join(dir, `${method}-${outerRadius}`);
      execFileSync(program, ["run", config, ...joint(outerRadius, method), "--out", out, "--quiet"]);
      const [header, ...rows] = readFileSync(join(out, "table.csv"), "utf8").trim().split("\n").map((row) => row.split(","));
      const column = header.indexOf("force_n");
      indentations.forEach((indentation, step) => {
        const told = Number(rows[step][column]);
        const found = instance.exports.force(outerRadius, indentation, method === "series");
        // The table has so many digits; processors fuse multiply and add, WebAssembly does not.
        if (!(Math.abs(found / told - 1) < 1e-7)) {
          throw new Error(`${method}, outer radius ${outerRadius} mm, ${indentation} mm: ${found} N instead of ${told} N`);
        }
        compared += 1;
      });
    }
  }
} finally {
  rmSync(dir, { recursive: true });
}
if (!Number.isNaN(instance.exports.force(9, 0.01, false))) {
  throw new Error("a ring that is smaller than its hole has a force");
}
console.log(`WebAssembly: ${compared} forces are those of the program`);
if (compared !== 2 * indentations.length * outerRadii.length) {
  throw new Error("some were not compared");
}
