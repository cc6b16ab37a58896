#!/usr/bin/env node
// arapd-gateway: the gateway by itself. docs/web.md lists its flags.
import { readFileSync, statSync } from "node:fs";
import { createServer } from "node:http";
import type { AddressInfo } from "node:net";
import { parseArgs } from "node:util";

import { ArapError } from "@arapd/client";
import { pino } from "pino";

import { createGateway } from "./gateway.js";
import { numberRules } from "./options.js";
import type { GatewayOptions } from "./options.js";

const kebab = (name: string): string =>
  name.replace(/[A-Z]/g, (letter) => `-${letter.toLowerCase()}`);
const camel = (name: string): string =>
  name.replace(/-([a-z])/g, (_, letter: string) => letter.toUpperCase());

const texts: Readonly<Record<string, string>> = {
  arapd: "the server, host:port or unix:PATH (localhost:50051)",
  "arapd-admin": "its admin page, http://HOST:PORT, for /v1/load and /metrics/arapd",
  listen: "HOST:PORT, port 0: any free one (127.0.0.1:8080)",
  "token-file": "file with the gateway's bearer token",
  "tls-ca": "who vouches for the server, in PEM",
  "tls-cert": "the gateway's own certificate",
  "tls-key": "its key",
  "user-header": "header in which a proxy says who is asking",
  origins: "other origins whose pages may ask, separated by commas",
  "trust-proxy": "addresses of proxies that are believed, separated by commas",
  static: "folder with pages to serve",
  metrics: "who may read /metrics and /v1/load: local, all or none (local)",
  "log-level": "silent, error, warn, info or debug (info)",
};

class Usage extends Error {}

function help(): string {
  const line = (flag: string, about: string): string => `  --${flag.padEnd(26)} ${about}`;
  const numbers = Object.entries(numberRules).map(([name, rule]) =>
    line(kebab(name), `${rule.about} (${rule.default})`),
  );
  return [
    "Usage: arapd-gateway [FLAGS]",
    ...Object.entries(texts).map(([flag, about]) => line(flag, about)),
    ...numbers,
  ].join("\n");
}

// What a flag says, else the environment.
function valuesOf(): Record<string, string> {
  const known = [...Object.keys(texts), ...Object.keys(numberRules).map(kebab)];
  let flags: Record<string, unknown>;
  try {
    const options = Object.fromEntries(known.map((name) => [name, { type: "string" as const }]));
    flags = parseArgs({
      options: { ...options, help: { type: "boolean" } },
      allowPositionals: false,
    }).values;
  } catch (error) {
    throw new Usage((error as Error).message);
  }
  if (flags["help"] === true) {
    console.log(help());
    process.exit(0);
  }
  const values: Record<string, string> = {};
  for (const name of known) {
    const value =
      flags[name] ?? process.env[`ARAPD_GATEWAY_${name.toUpperCase().replaceAll("-", "_")}`];
    if (typeof value === "string" && value !== "") values[name] = value;
  }
  return values;
}

function tokenOf(file: string): string {
  let token: string;
  try {
    token = readFileSync(file, "utf8").trim();
  } catch (error) {
    throw new Usage(`--token-file: ${(error as Error).message}`);
  }
  if (token === "") throw new Usage(`--token-file: ${file} is empty`);
  return token;
}

const listed = (text: string): string[] =>
  text
    .split(",")
    .map((one) => one.trim())
    .filter((one) => one !== "");

function optionsOf(values: Record<string, string>): GatewayOptions {
  const options: Record<string, unknown> = {};
  for (const [name, value] of Object.entries(values)) {
    if (camel(name) in numberRules) {
      if (!/^\d+$/.test(value))
        throw new Usage(`--${name}: ${JSON.stringify(value)} is no whole number`);
      options[camel(name)] = Number(value);
    } else if (name === "origins" || name === "trust-proxy") {
      options[camel(name)] = listed(value);
    } else if (name === "token-file") {
      options["token"] = tokenOf(value);
    } else if (name === "user-header") {
      const header = value.toLowerCase();
      options["user"] = ({
        headers,
      }: {
        headers: Record<string, string | string[] | undefined>;
      }) => {
        const given = headers[header];
        return typeof given === "string" ? given : undefined;
      };
    } else if (name === "static") {
      if (!statSync(value, { throwIfNoEntry: false })?.isDirectory())
        throw new Usage(`--static: ${value} is no folder`);
      options[name] = value;
    } else if (name !== "listen" && name !== "log-level") {
      options[camel(name)] = value;
    }
  }
  return options;
}

function listenOf(text: string): { host: string; port: number } {
  const match = /^(\[[0-9a-fA-F:.]+\]|[^:]*):(\d{1,5})$/.exec(text);
  const port = Number(match?.[2]);
  if (!match || port > 65535) throw new Usage(`--listen: ${JSON.stringify(text)} is no HOST:PORT`);
  return { host: match[1]!.replace(/^\[|\]$/g, "") || "0.0.0.0", port };
}

async function run(): Promise<void> {
  const values = valuesOf();
  const level = values["log-level"] ?? "info";
  if (!["silent", "error", "warn", "info", "debug"].includes(level))
    throw new Usage(`--log-level: ${level} is none`);
  const address = listenOf(values["listen"] ?? "127.0.0.1:8080");
  const log = pino({ level });
  const gateway = await createGateway({ ...optionsOf(values), logger: log });
  const server = createServer((request, response) => gateway.handle(request, response));
  server.on("upgrade", (request, socket, head) => gateway.upgrade(request, socket, head));
  server.on("error", (error) => {
    console.error(`arapd-gateway: ${error.message}`);
    process.exit(1);
  });
  server.listen(address, () => {
    const { address: host, family, port } = server.address() as AddressInfo;
    console.log(`gateway listening on http://${family === "IPv6" ? `[${host}]` : host}:${port}`);
  });
  const end = (signal: NodeJS.Signals): void => {
    log.info({ signal }, "draining");
    server.close();
    void gateway.drain().then(() => {
      server.closeAllConnections();
      process.exit(0);
    });
  };
  process.once("SIGTERM", end);
  process.once("SIGINT", end);
}

run().catch((error: unknown) => {
  const isOption =
    error instanceof Usage || error instanceof RangeError || error instanceof ArapError;
  console.error(`arapd-gateway: ${isOption ? error.message : (error as Error).stack}`);
  process.exit(isOption ? 2 : 1);
});
