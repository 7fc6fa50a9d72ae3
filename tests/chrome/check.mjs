// Chrome's compiler reads the kernels: unlike naga it refuses a barrier that not all invocations may reach.
//
//     cargo run --release --example kernel_texts -- target/kernel_texts
//     npm install --prefix target/chrome webgpu@0.6.2
//     NODE_PATH=target/chrome/node_modules node tests/chrome/check.mjs target/kernel_texts
//
// The package is Dawn as a module for node; with its null backend it needs no device and no driver. WGSL as Chrome
// has it knows no f64, so the texts are those in f32.

import { readFileSync, readdirSync } from "node:fs";
import { createRequire } from "node:module";
import { pathToFileURL } from "node:url";
import path from "node:path";

const [folder] = process.argv.slice(2);
// NODE_PATH holds for `require` only, and the package is to be imported.
const entry = createRequire(import.meta.url).resolve("webgpu");
const { create, globals } = await import(pathToFileURL(entry));
Object.assign(globalThis, globals);

const gpu = create(["backend=null"]);
const adapter = await gpu.requestAdapter();
const { maxComputeWorkgroupStorageSize, maxComputeInvocationsPerWorkgroup } = adapter.limits;
const device = await adapter.requestDevice({
    requiredFeatures: ["subgroups"],
    requiredLimits: { maxComputeWorkgroupStorageSize, maxComputeInvocationsPerWorkgroup },
});

// What the compiler has to say against a text and its pipelines; nothing, if it is good.
async function problems(text) {
    // naga does not read this line, Chrome insists on it.
    const code = /subgroup/.test(text) ? `enable subgroups;\n${text}` : text;
    device.pushErrorScope("validation");
    const module = device.createShaderModule({ code });
    const { messages } = await module.getCompilationInfo();
    const entryPoints = [...code.matchAll(/^@compute[^\n]*\nfn (\w+)/gm)];
    for (const [, entryPoint] of entryPoints) {
        device.createComputePipeline({ layout: "auto", compute: { module, entryPoint } });
    }
    const error = await device.popErrorScope();
    const said = messages.map(({ type, lineNum, message }) => `${type} at line ${lineNum}: ${message}`);
    if (entryPoints.length === 0) {
        said.push("no entry point was found");
    }
    return error ? [...said, error.message] : said;
}

// Control: one invocation alone at a barrier.
const divergent = `
var<workgroup> shared_number: u32;
@compute @workgroup_size(64)
fn wrong(@builtin(local_invocation_index) invocation: u32) {
    if invocation == 0u {
        workgroupBarrier();
    }
    shared_number = invocation;
}`;
let failed = (await problems(divergent)).length === 0;
if (failed) {
    console.error("a barrier in divergent control flow was not found: this compiler checks nothing");
}
const names = readdirSync(folder).filter((name) => name.endsWith(".wgsl")).sort();
for (const name of names) {
    const found = await problems(readFileSync(path.join(folder, name), "utf8"));
    console.log(`${name}: ${found.length === 0 ? "good" : `\n${found.join("\n")}`}`);
    failed ||= found.length !== 0;
}
if (names.length === 0) {
    console.error(`no .wgsl in ${folder}`);
}
process.exit(failed || names.length === 0 ? 1 : 0);
