// Tokens for arapd, as `arapctl token add` makes them.
import { createHash, randomBytes } from "node:crypto";
import { writeFileSync } from "node:fs";
import { join } from "node:path";

/** A token of the role gateway, and the file that says so. */
export function tokenFile(folder: string, more: object = {}): { file: string; token: string } {
  const [id, salt, secret] = [16, 16, 32].map((bytes) => randomBytes(bytes).toString("hex"));
  const sha256 = createHash("sha256").update(`${salt}${secret}`).digest("hex");
  const file = join(folder, "tokens.json");
  writeFileSync(
    file,
    JSON.stringify([{ id, owner: "shop", role: "gateway", salt, sha256, ...more }]),
    { mode: 0o600 },
  );
  return { file, token: `arapd_${id}_${secret}` };
}
