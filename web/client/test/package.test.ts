// The package as others get it: packed, installed in a folder of its own without network, and the
// README's example compiled and run there.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import {
  cpSync,
  existsSync,
  mkdirSync,
  mkdtempSync,
  readFileSync,
  rmSync,
  writeFileSync,
} from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { test } from "node:test";

import { serve } from "./support/server.js";

const here = process.cwd();
const root = join(here, "../..");

interface LockedPackage {
  version: string;
  dev?: boolean;
  dependencies?: Record<string, string>;
}
const readJson = (path: string): Record<string, unknown> =>
  JSON.parse(readFileSync(path, "utf8")) as never;

function npm(folder: string, ...words: string[]): string {
  const cache = join(root, ".cache/npm");
  const options = existsSync(cache) ? ["--cache", cache] : [];
  return execFileSync(
    "npm",
    [...words, "--offline", "--ignore-scripts", "--no-audit", "--no-fund", ...options],
    {
      cwd: folder,
      encoding: "utf8",
      stdio: ["ignore", "pipe", "pipe"],
    },
  );
}

// The packages that ours needs, as our own lock names them.
function needed(): Record<string, LockedPackage> {
  const { packages } = readJson(join(here, "package-lock.json")) as {
    packages: Record<string, LockedPackage>;
  };
  return Object.fromEntries(
    Object.entries(packages).filter(([path, { dev }]) => path !== "" && !dev),
  );
}

// Installs the archive with npm; where npm's cache has been emptied, its needs are copied.
function install(folder: string, archive: string): string {
  const own = readJson(join(here, "package.json"));
  const dependencies = { "@arapd/client": `file:${archive}` };
  writeFileSync(
    join(folder, "package.json"),
    JSON.stringify({ name: "newcomer", version: "1.0.0", type: "module", dependencies }),
  );
  const packages = {
    "": { name: "newcomer", version: "1.0.0", dependencies },
    "node_modules/@arapd/client": {
      version: own["version"],
      resolved: `file:${archive}`,
      dependencies: own["dependencies"],
    },
    ...needed(),
  };
  writeFileSync(
    join(folder, "package-lock.json"),
    JSON.stringify({
      name: "newcomer",
      version: "1.0.0",
      lockfileVersion: 3,
      requires: true,
      packages,
    }),
  );
  try {
    npm(folder, "ci");
    return "installed by npm";
  } catch (error) {
    const { stderr } = error as { stderr: string };
    if (!stderr.includes("ENOTCACHED")) throw new Error(`npm ci failed: ${stderr}`);
    rmSync(join(folder, "node_modules"), { recursive: true, force: true });
    const home = join(folder, "node_modules/@arapd/client");
    mkdirSync(home, { recursive: true });
    execFileSync("tar", ["-xzf", join(folder, archive), "-C", home, "--strip-components=1"]);
    for (const path of Object.keys(needed())) {
      mkdirSync(dirname(join(folder, path)), { recursive: true });
      cpSync(join(here, path), join(folder, path), { recursive: true });
    }
    return "unpacked, because npm's cache has been emptied";
  }
}

/** The TypeScript of the README. */
function example(): string {
  const blocks = [
    ...readFileSync(join(root, "README.md"), "utf8").matchAll(/^```ts\n([\s\S]*?)^```$/gm),
  ];
  assert.equal(blocks.length, 1, "the README has one example in TypeScript");
  return blocks[0]![1]!;
}

test(
  "the packed package is whole, and the README's example runs with it",
  { timeout: 300_000 },
  async (t) => {
    const folder = mkdtempSync(join(tmpdir(), "arapd-newcomer-"));
    try {
      const packed = JSON.parse(npm(here, "pack", "--json", "--pack-destination", folder)) as [
        { filename: string; files: { path: string }[] },
      ];
      const paths = packed[0].files.map((file) => file.path);
      assert.ok(
        paths.every((path) => /^(dist\/|package\.json$|README\.md$|LICENSE$)/.test(path)),
        paths.join(" "),
      );
      for (const path of [
        "LICENSE",
        "README.md",
        "dist/index.d.ts",
        "dist/proto/arap/v1/deformation_service.proto",
      ]) {
        assert.ok(paths.includes(path), path);
      }
      t.diagnostic(install(folder, packed[0].filename.replace(/^@arapd\//, "arapd-")));
      await serve(async (client, server) => {
        const { version } = readJson(join(here, "package.json"));
        assert.equal((await client.getServerInfo()).version, version);
        writeFileSync(
          join(folder, "example.ts"),
          example().replace("localhost:50051", server.address),
        );
        const compiler = join(here, "node_modules/typescript/bin/tsc");
        const how = [
          "--strict",
          "--target",
          "ES2022",
          "--module",
          "NodeNext",
          "--moduleResolution",
          "NodeNext",
        ];
        const types = ["--types", "node", "--typeRoots", join(here, "node_modules/@types")];
        execFileSync(process.execPath, [compiler, ...how, ...types, "example.ts"], {
          cwd: folder,
          stdio: "pipe",
          encoding: "utf8",
        });
        const said = execFileSync(process.execPath, ["example.js"], {
          cwd: folder,
          encoding: "utf8",
          timeout: 60_000,
        });
        assert.match(said, /Float32Array\(8\)/);
      });
    } catch (error) {
      const { stdout, stderr } = error as { stdout?: string; stderr?: string };
      if (stdout || stderr) throw new Error(`${String(error)}\n${stdout}\n${stderr}`);
      throw error;
    } finally {
      rmSync(folder, { recursive: true, force: true });
    }
  },
);
