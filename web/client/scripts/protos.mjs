// Makes the package's own view of the wire from the interface in proto/: dist/proto, which is
// packed, and the types of its messages in src/gen, which are compiled. The licence is copied too.
//
// In that view every run of numbers (`repeated float`, `double` or `uint32`) is one field of
// `bytes`. That is the same wire: proto3 packs such runs, and a packed run and a field of bytes are
// both a length and that many bytes. A frame is so decoded without touching its numbers
// (src/runs.ts).
import { execFileSync } from "node:child_process";
import {
  copyFileSync,
  mkdirSync,
  readdirSync,
  readFileSync,
  rmSync,
  statSync,
  writeFileSync,
} from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(dirname(fileURLToPath(import.meta.url)));
const interfaces = join(here, "../../proto");
const view = join(here, "dist/proto");
const types = join(here, "src/gen");

const files = [
  "arap/v1/geometry.proto",
  "arap/v1/errors.proto",
  "arap/v1/deformation_service.proto",
  "arap/v1/flattening_service.proto",
  "arap/v1/server_service.proto",
  "google/rpc/status.proto",
  "google/rpc/error_details.proto",
];

rmSync(view, { recursive: true, force: true });
rmSync(types, { recursive: true, force: true });
for (const file of files) {
  const text = readFileSync(join(interfaces, file), "utf8");
  const numbers = /^(\s*)repeated (?:float|double|uint32) (\w+ = \d+)/gm;
  const ours = file.startsWith("arap/") ? text.replace(numbers, "$1bytes $2") : text;
  mkdirSync(dirname(join(view, file)), { recursive: true });
  writeFileSync(join(view, file), ours);
}

copyFileSync(join(here, "../../LICENSE"), join(here, "LICENSE"));
execFileSync(
  process.execPath,
  [
    join(here, "node_modules/@grpc/proto-loader/build/bin/proto-loader-gen-types.js"),
    "--longs=Number",
    "--enums=String",
    "--defaults",
    "--oneofs",
    "--grpcLib=@grpc/grpc-js",
    "--inputTemplate=%s",
    "--outputTemplate=%sAnswer",
    "--importFileExtension=.js",
    `--includeDirs=${view}`,
    `--outDir=${types}`,
    ...files,
  ],
  { stdio: ["ignore", "ignore", "inherit"] },
);

// The generator names the files that it read by their place on this machine, and writes a list that
// nobody needs for each.
for (const file of readdirSync(types, { recursive: true }).map((name) => join(types, name))) {
  if (!statSync(file).isFile()) continue;
  if (dirname(file) === types) rmSync(file);
  else writeFileSync(file, readFileSync(file, "utf8").replace(/^\/\/ Original file: .*\n/m, ""));
}
