// Connections: clients of arapd, each for one user and at most so many calls and streams at once.
import { Client } from "@arapd/client";
import type { ConnectOptions } from "@arapd/client";

import { Problem } from "./problems.js";
import type { Settings } from "./options.js";

// arapd carries 320 calls on a connection at a time.
const mostUses = 100;
const idleMs = 30_000;

interface Connection {
  client: Client;
  owner: string;
  uses: number;
  timer: NodeJS.Timeout | undefined;
}

/** A client for as long as one call or stream lasts. */
export interface Lease {
  client: Client;
  /** Once. */
  release(): void;
}

/** Connections are made when they are needed and closed when they have not been for 30 s. */
export class Connections {
  readonly #settings: Settings;
  readonly #options: ConnectOptions;
  readonly #byOwner = new Map<string, Connection[]>();
  #count = 0;
  #closed = false;

  /** ArapError for options that do not go together, and files that cannot be read. */
  constructor(settings: Settings) {
    this.#settings = settings;
    this.#options = {
      ...(settings.token !== undefined && { token: settings.token }),
      ...(settings.tlsCa !== undefined && { rootCertificates: settings.tlsCa }),
      ...(settings.tlsCert !== undefined && { certificate: settings.tlsCert }),
      ...(settings.tlsKey !== undefined && { key: settings.tlsKey }),
    };
    Client.connect(settings.arapd, this.#options).close();
  }

  get count(): number {
    return this.#count;
  }

  /** `owner` is empty where users are not told apart. GATEWAY_BUSY: there are too many. */
  lease(owner: string): Lease {
    if (this.#closed)
      throw new Problem("GATEWAY_BUSY", "The gateway is going away.", { retryAfterMs: 1000 });
    const connection = this.#free(owner);
    connection.uses++;
    clearTimeout(connection.timer);
    let released = false;
    return {
      client: connection.client,
      release: () => {
        if (released) return;
        released = true;
        if (--connection.uses === 0) {
          connection.timer = setTimeout(() => this.#close(connection), idleMs).unref();
        }
      },
    };
  }

  #free(owner: string): Connection {
    const own = this.#byOwner.get(owner) ?? [];
    const found = own.find((connection) => connection.uses < mostUses);
    if (found) return found;
    if (this.#count >= this.#settings.maxConnections && !this.#closeAnIdleOne()) {
      throw new Problem(
        "GATEWAY_BUSY",
        `The gateway has ${this.#count} connections, as many as it may.`,
        {
          retryAfterMs: 1000,
        },
      );
    }
    const client = Client.connect(this.#settings.arapd, {
      ...this.#options,
      ...(owner !== "" && { user: owner }),
    });
    const made: Connection = { client, owner, uses: 0, timer: undefined };
    this.#byOwner.set(owner, [...own, made]);
    this.#count++;
    return made;
  }

  #closeAnIdleOne(): boolean {
    for (const connections of this.#byOwner.values()) {
      const idle = connections.find(({ uses }) => uses === 0);
      if (!idle) continue;
      this.#close(idle);
      return true;
    }
    return false;
  }

  #close(connection: Connection): void {
    clearTimeout(connection.timer);
    connection.client.close();
    const rest = (this.#byOwner.get(connection.owner) ?? []).filter(
      (other) => other !== connection,
    );
    if (rest.length > 0) this.#byOwner.set(connection.owner, rest);
    else this.#byOwner.delete(connection.owner);
    this.#count--;
  }

  /** Ends every call and stream. */
  close(): void {
    this.#closed = true;
    for (const connections of [...this.#byOwner.values()])
      connections.forEach((one) => this.#close(one));
  }
}
