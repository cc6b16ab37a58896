// What a request is called in the logs of the gateway and of arapd.
import { randomBytes } from "node:crypto";

/** That of its header x-request-id where it is a name, else a new one. */
export function requestIdOf(header: string | string[] | undefined): string {
  if (typeof header === "string" && /^[A-Za-z0-9._-]{1,64}$/.test(header)) return header;
  return randomBytes(8).toString("hex");
}
