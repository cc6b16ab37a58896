// Builds the gateway, the client that it stands on and the tests, and runs them against the real
// server.
//
// Usage: npm test [-- FILTER…]     a FILTER is a part of a test file's name
// ARAPD=PATH is the server, by default that of the daily build; without one nothing is tested, and
// the exit code is 77. ARAPCTL=PATH is the command line, by default beside it; tests that compare
// with it are skipped without.
// ARAP_WEB_ROUNDS=N: how often the server is killed, and how many inputs are made up (3).
import { spawnSync } from "node:child_process";
import { existsSync, readdirSync, rmSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(dirname(fileURLToPath(import.meta.url)));
const client = join(here, "../client");
const arapd = process.env.ARAPD ?? join(here, "../../build/dev/bin/arapd");
const arapctl = process.env.ARAPCTL ?? join(dirname(arapd), "arapctl");
function skip(why) {
  console.error(`SKIPPED: the tests of web/gateway did not run: ${why}`);
  process.exit(77);
}
if (!existsSync(arapd)) skip(`there is no server at ${arapd}; build it or set ARAPD`);
for (const folder of [here, client]) {
  if (!existsSync(join(folder, "node_modules/typescript")))
    skip("its packages are not installed; run script/setup --web");
}

function run(folder, ...words) {
  const { status } = spawnSync(process.execPath, words, {
    cwd: folder,
    stdio: "inherit",
    env: { ...process.env, ARAPD: arapd, ...(existsSync(arapctl) && { ARAPCTL: arapctl }) },
  });
  if (status !== 0) process.exit(status ?? 1);
}
const compiler = "node_modules/typescript/bin/tsc";
for (const folder of ["dist", "build"])
  rmSync(join(here, folder), { recursive: true, force: true });
run(client, "scripts/protos.mjs");
run(client, compiler, "-p", "tsconfig.json");
run(here, compiler, "-p", "tsconfig.json");
run(here, compiler, "-p", "test/tsconfig.json");
const folder = "build/gateway/test";
const wanted = process.argv.slice(2);
const tests = readdirSync(join(here, folder))
  .filter((name) => name.endsWith(".test.js"))
  .filter((name) => wanted.length === 0 || wanted.some((part) => name.includes(part)));
run(here, "--test", ...tests.map((name) => join(folder, name)));
