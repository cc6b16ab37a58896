// Who is asking: tokens, users of gateways, TLS on both sides.
import assert from "node:assert/strict";
import { execFileSync, spawnSync } from "node:child_process";
import { createHash, randomBytes } from "node:crypto";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";

import { Client } from "@arapd/client";

import { failure } from "./support/events.js";
import { Server } from "./support/server.js";

const timeout = 120_000;
const folder = mkdtempSync(join(tmpdir(), "arapd-identity-"));
process.on("exit", () => rmSync(folder, { recursive: true, force: true }));
const path = (name: string): string => join(folder, name);

/** A token of the file tokens.json. */
function addToken(entries: object[], owner: string, role: string): string {
  const [id, salt, secret] = [16, 16, 32].map((bytes) => randomBytes(bytes).toString("hex"));
  const sha256 = createHash("sha256").update(`${salt}${secret}`).digest("hex");
  entries.push({ id, owner, role, salt, sha256 });
  return `arapd_${id}_${secret}`;
}
const entries: object[] = [];
const alice = addToken(entries, "alice", "user");
const gateway = addToken(entries, "shop", "gateway");
writeFileSync(path("tokens.json"), JSON.stringify(entries), { mode: 0o600 });

async function withServer(flags: string[], use: (address: string) => Promise<void>): Promise<void> {
  const server = new Server(["--store", "memory", ...flags], "127.0.0.1:0");
  try {
    await server.start();
    await use(server.address);
  } finally {
    await server.stop();
  }
}

test("a token says whose sessions there are, and a gateway for whom it asks", { timeout }, () =>
  withServer(["--token-file", path("tokens.json")], async (address) => {
    const stranger = Client.connect(address);
    assert.ok((await stranger.getServerInfo()).version);
    const refused = await failure(stranger.createSession(), "UNAUTHENTICATED");
    assert.equal(refused.code, "UNAUTHENTICATED");
    const wrong = Client.connect(address, {
      token: `${alice.slice(0, -1)}${alice.endsWith("0") ? "1" : "0"}`,
    });
    await failure(wrong.createSession(), "UNAUTHENTICATED");

    const clients = [
      Client.connect(address, { token: alice }),
      Client.connect(address, { token: gateway, user: "ann" }),
      Client.connect(address, { token: gateway, user: "bob" }),
    ];
    for (const client of clients) await client.createSession({ id: "same" });
    for (const client of clients) assert.equal((await client.listSessions()).sessions.length, 1);
    for (const client of [stranger, wrong, ...clients]) client.close();
  }),
);

test("what does not go together is said when connecting", async () => {
  const bad = async (connect: () => unknown, field: string): Promise<void> => {
    assert.equal((await failure(connect, "INVALID_OPTION")).field, field);
  };
  await bad(() => Client.connect("example.org:50051", { token: alice }), "token");
  await bad(() => Client.connect("10.0.0.1:50051", { token: alice }), "token");
  await bad(() => Client.connect("localhost:1", { token: "two words" }), "token");
  await bad(() => Client.connect("localhost:1", { user: "no name" }), "user");
  await bad(() => Client.connect("localhost:1", { certificate: "x.pem" }), "key");
  await bad(() => Client.connect("localhost:1", { key: "x.pem" }), "certificate");
  await bad(
    () => Client.connect("localhost:1", { rootCertificates: path("none.pem") }),
    "rootCertificates",
  );
  for (const local of ["localhost:1", "127.1.2.3:1", "[::1]:1", "unix:/x", "dns:///localhost:1"]) {
    Client.connect(local, { token: alice }).close();
  }
  Client.connect("example.org:1", { token: alice, tls: true }).close();
  Client.connect("example.org:1", { token: alice, tokenInPlaintext: true }).close();
});

const hasOpenssl = spawnSync("openssl", ["version"]).status === 0;

/** A certificate for `name`, signed by the authority of this test. */
function certify(name: string, extension: string): void {
  const openssl = (...words: string[]): void =>
    void execFileSync("openssl", words, { cwd: folder, stdio: "pipe" });
  const key = ["-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes"];
  if (name === "ca") {
    openssl(
      "req",
      "-x509",
      ...key,
      "-keyout",
      "ca.key",
      "-out",
      "ca.crt",
      "-subj",
      "/CN=test authority",
      "-days",
      "2",
    );
    return;
  }
  openssl("req", ...key, "-keyout", `${name}.key`, "-out", `${name}.csr`, "-subj", `/CN=${name}`);
  writeFileSync(path(`${name}.ext`), extension);
  openssl(
    "x509",
    "-req",
    "-in",
    `${name}.csr`,
    "-CA",
    "ca.crt",
    "-CAkey",
    "ca.key",
    "-CAcreateserial",
    "-days",
    "2",
    "-extfile",
    `${name}.ext`,
    "-out",
    `${name}.crt`,
  );
}

test(
  "TLS, with certificates on both sides",
  { timeout, skip: hasOpenssl ? false : "there is no openssl" },
  async () => {
    certify("ca", "");
    certify("arapd.test", "subjectAltName=DNS:arapd.test");
    certify("carol", "subjectAltName=DNS:carol\nextendedKeyUsage=clientAuth");
    const flags = [
      "--tls-cert",
      path("arapd.test.crt"),
      "--tls-key",
      path("arapd.test.key"),
      "--tls-client-ca",
      path("ca.crt"),
      "--token-file",
      path("tokens.json"),
    ];
    await withServer(flags, async (address) => {
      const known = { rootCertificates: path("ca.crt"), serverName: "arapd.test" };
      const byToken = Client.connect(address, { ...known, token: alice });
      await byToken.createSession({ id: "mine" });
      const text = readFileSync(path("ca.crt"), "utf8");
      const byCertificate = Client.connect(address, {
        ...known,
        rootCertificates: text,
        certificate: path("carol.crt"),
        key: path("carol.key"),
      });
      await byCertificate.createSession({ id: "mine" });
      assert.equal((await byCertificate.listSessions()).sessions.length, 1);
      const strangers = [
        Client.connect(address), // in plaintext
        Client.connect(address, { tls: true, serverName: "arapd.test" }), // with the authorities of the system
        Client.connect(address, { rootCertificates: path("ca.crt"), serverName: "other.test" }),
      ];
      for (const stranger of strangers)
        await failure(stranger.getServerInfo({ retryWithin: 0 }), "DRAINING");
      for (const client of [byToken, byCertificate, ...strangers]) client.close();
    });
  },
);
