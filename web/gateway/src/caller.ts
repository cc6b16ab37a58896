// Callers: who is asking, from where, and whether the page that asks may.
import { createHash } from "node:crypto";
import type { IncomingMessage } from "node:http";
import { isIP } from "node:net";
import type { TLSSocket } from "node:tls";

import proxyAddress from "@fastify/proxy-addr";

import { Problem } from "./problems.js";
import type { Settings } from "./options.js";

export interface Caller {
  /** Whose sessions they are, as arapd names the user; empty where users are not told apart. */
  owner: string;
  /** What requests, sockets and jobs are counted by: the user, else the address. */
  key: string;
}

/** The name that arapd knows a user by: its own, or one made of it where that is no name. */
export function ownerOf(user: string): string {
  if (/^[A-Za-z0-9._-]{1,128}$/.test(user) && !/^u\.[0-9a-f]{32}$/.test(user)) return user;
  return `u.${createHash("sha256").update(user).digest("hex").slice(0, 32)}`;
}

// A list may have come through several proxies: the last entry is that of the one that we believe.
const last = (header: string | string[] | undefined): string | undefined =>
  (Array.isArray(header) ? header.join() : header)?.split(",").at(-1)?.trim();

export class Callers {
  readonly #settings: Settings;
  readonly #trust: (address: string, hop: number) => boolean;

  /** RangeError for addresses of proxies that are none. */
  constructor(settings: Settings) {
    this.#settings = settings;
    try {
      this.#trust = proxyAddress.compile([...settings.trustProxy]);
    } catch (error) {
      throw new RangeError(`trustProxy: ${(error as Error).message}.`);
    }
  }

  /** The address that asks, as far as proxies are believed. */
  addressOf(request: IncomingMessage): string {
    try {
      return proxyAddress(request, this.#trust);
    } catch {
      return request.socket.remoteAddress ?? "";
    }
  }

  /** UNKNOWN_USER where users are told apart and nobody says who it is. */
  async of(request: IncomingMessage): Promise<Caller> {
    const { user } = this.#settings;
    if (!user) return this.nobody(request);
    const name = await user(request);
    if (name === undefined || name === "") {
      throw new Problem("UNKNOWN_USER", "Nobody says who is asking.");
    }
    const owner = ownerOf(name);
    return { owner, key: owner };
  }

  /** Counted by the address. */
  nobody(request: IncomingMessage): Caller {
    return { owner: "", key: this.addressOf(request) };
  }

  /** FORBIDDEN_ORIGIN for a page of another site. What is no page says no origin. */
  checkOrigin(request: IncomingMessage): void {
    const { origin } = request.headers;
    if (origin === undefined || this.#settings.origins.includes(origin)) return;
    if (origin === this.#ownOrigin(request) && !this.#isRebound(request)) return;
    throw new Problem("FORBIDDEN_ORIGIN", "The page that asks is of another site.");
  }

  // Whether a browser of this machine asks under a name that is not this machine's: whoever owns the
  // name may have pointed it here, and then his pages and ours have one origin.
  #isRebound(request: IncomingMessage): boolean {
    const name = (request.headers.host ?? "").replace(/:\d*$/, "").toLowerCase();
    const own = name === "localhost" || name.endsWith(".localhost") || isIP(name) !== 0;
    return this.isLocal(request) && !own && !/^\[.*\]$/.test(name);
  }

  #ownOrigin(request: IncomingMessage): string {
    const { headers, socket } = request;
    const believed = this.#trust(socket.remoteAddress ?? "", 0);
    const host = (believed && last(headers["x-forwarded-host"])) || headers.host || "";
    const scheme = (socket as TLSSocket).encrypted ? "https" : "http";
    const proto = (believed && last(headers["x-forwarded-proto"])) || scheme;
    return `${proto}://${host.toLowerCase()}`;
  }

  /**
   * Whether it comes from this machine, through no proxy, and under a name of this machine: what only
   * its operators may read.
   */
  isOwn(request: IncomingMessage): boolean {
    const asked = this.#ownOrigin(request);
    return (
      this.isLocal(request) && (this.#settings.origins.includes(asked) || !this.#isRebound(request))
    );
  }

  /** Whether it comes from this machine, and through no proxy. */
  isLocal(request: IncomingMessage): boolean {
    const { headers, socket } = request;
    const address = (socket.remoteAddress ?? "").replace(/^::ffff:/, "");
    const passedOn = headers["x-forwarded-for"] ?? headers["forwarded"] ?? headers["via"];
    return passedOn === undefined && (address === "::1" || /^127\./.test(address));
  }
}
