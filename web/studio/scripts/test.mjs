// Builds the page, the gateway that serves it and the tests, and runs them in Debian's chromium against
// the real server.
//
// Usage: npm test [-- FILTER…]     a FILTER is a part of a test file's name
// ARAPD=PATH is the server, by default that of the daily build; ARAPCTL=PATH the command line, by default
// beside it; CHROMIUM=PATH the browser. Without the server, the browser or the packages nothing is tested,
// and the exit code is 77.
// ARAP_STUDIO_SHOTS=DIR: screenshots of every view, light and dark, at three sizes.
import { spawnSync } from "node:child_process";
import { existsSync, readFileSync, readdirSync, rmSync } from "node:fs";
import { basename, dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { gzipSync } from "node:zlib";

const here = dirname(dirname(fileURLToPath(import.meta.url)));
const client = join(here, "../client");
const gateway = join(here, "../gateway");
const arapd = process.env.ARAPD ?? join(here, "../../build/dev/bin/arapd");
const arapctl = process.env.ARAPCTL ?? join(dirname(arapd), "arapctl");
const chromium = process.env.CHROMIUM ?? "/usr/bin/chromium";
function skip(why) {
  console.error(`SKIPPED: the tests of web/studio did not run: ${why}`);
  process.exit(77);
}
if (!existsSync(arapd)) skip(`there is no server at ${arapd}; build it or set ARAPD`);
if (!existsSync(chromium)) skip(`there is no browser at ${chromium}; run script/setup --web`);
for (const folder of [here, client, gateway]) {
  if (!existsSync(join(folder, "node_modules/typescript")))
    skip("its packages are not installed; run script/setup --web");
}

function run(folder, ...words) {
  const { status } = spawnSync(process.execPath, words, {
    cwd: folder,
    stdio: "inherit",
    env: {
      ...process.env,
      ARAPD: arapd,
      CHROMIUM: chromium,
      ...(existsSync(arapctl) && { ARAPCTL: arapctl }),
    },
  });
  if (status !== 0) process.exit(status ?? 1);
}
const compiler = "node_modules/typescript/bin/tsc";
run(client, "scripts/protos.mjs");
run(client, compiler, "-p", "tsconfig.json");
run(gateway, compiler, "-p", "tsconfig.json");
for (const folder of ["dist", "build"])
  rmSync(join(here, folder), { recursive: true, force: true });
run(here, compiler, "-p", "tsconfig.json");
run(here, "node_modules/vite/bin/vite.js", "build", "--logLevel", "warn");
run(here, compiler, "-p", "test/tsconfig.json");

// What a page loads in the end, by the names that its files have of others.
const most = 400_000;
const files = readdirSync(join(here, "dist"), { recursive: true }).map(String);
for (const page of files.filter((name) => name.endsWith(".html"))) {
  const loaded = new Set([page]);
  for (const name of loaded) {
    const text = readFileSync(join(here, "dist", name), "latin1");
    for (const other of files)
      if (!other.endsWith(".html") && text.includes(basename(other)) && /\.\w+$/.test(other))
        loaded.add(other);
  }
  let bytes = 0;
  for (const name of loaded) bytes += gzipSync(readFileSync(join(here, "dist", name))).length;
  console.log(`${page} has ${Math.round(bytes / 1000)} kB, gzipped`);
  if (bytes > most) {
    console.error(`a page may have ${most / 1000} kB at most`);
    process.exit(1);
  }
}
const folder = "build/test";
const wanted = process.argv.slice(2);
const tests = readdirSync(join(here, folder))
  .filter((name) => name.endsWith(".test.js"))
  .filter((name) => wanted.length === 0 || wanted.some((part) => name.includes(part)));
// One after the other: each starts a server and a browser of its own.
for (const name of tests) run(here, "--test", join(folder, name));
