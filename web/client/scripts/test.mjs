// Builds the package and its tests and runs them against the real server.
//
// Usage: npm test [-- FILTER…]     a FILTER is a part of a test file's name
// ARAPD=PATH is the server, by default that of the daily build; without one nothing is tested, and
// the exit code is 77.
// ARAP_WEB_ROUNDS=N: how often the server is killed, drained and frozen (3).
import { spawnSync } from "node:child_process";
import { existsSync, readdirSync, rmSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(dirname(fileURLToPath(import.meta.url)));
const arapd = process.env.ARAPD ?? join(here, "../../build/dev/bin/arapd");
function skip(why) {
  console.error(`SKIPPED: the tests of web/client did not run: ${why}`);
  process.exit(77);
}
if (!existsSync(arapd)) skip(`there is no server at ${arapd}; build it or set ARAPD`);
if (!existsSync(join(here, "node_modules/typescript")))
  skip("its packages are not installed; run script/setup --web");

function run(...words) {
  const { status } = spawnSync(process.execPath, words, {
    cwd: here,
    stdio: "inherit",
    env: { ...process.env, ARAPD: arapd },
  });
  if (status !== 0) process.exit(status ?? 1);
}
rmSync(join(here, "dist"), { recursive: true, force: true });
rmSync(join(here, "build"), { recursive: true, force: true });
run("scripts/protos.mjs");
run("node_modules/typescript/bin/tsc", "-p", "tsconfig.json");
run("node_modules/typescript/bin/tsc", "-p", "test/tsconfig.json");
const wanted = process.argv.slice(2);
const tests = readdirSync(join(here, "build"))
  .filter((name) => name.endsWith(".test.js"))
  .filter((name) => wanted.length === 0 || wanted.some((part) => name.includes(part)));
run("--test", ...tests.map((name) => join("build", name)));
