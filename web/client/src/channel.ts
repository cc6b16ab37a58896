// How to connect and who to be; the gRPC channel that all calls of a Client share.
import { readFileSync } from "node:fs";

import { Client as GrpcClient, Metadata, credentials } from "@grpc/grpc-js";
import type { ChannelCredentials, ChannelOptions } from "@grpc/grpc-js";

import { badOption, cancelled } from "./errors.js";

/**
 * How a client connects and who it says it is. Files are in PEM and read once. Nothing of this is
 * ever logged.
 */
export interface ConnectOptions {
  /** Bearer token, sent with every call; `arapctl token add` makes them. */
  token?: string;
  /**
   * Without TLS a token is sent to this machine only, unless this lets everybody on the way read
   * it.
   */
  tokenInPlaintext?: boolean;
  /** The user for whom all calls are made, where the token has the role gateway. */
  user?: string;
  /** Implied by each of the files. */
  tls?: boolean;
  /**
   * Who vouches for the server; default: the system's authorities. A path, or the text of the file.
   */
  rootCertificates?: string | Buffer;
  /** The client's own certificate, with its key, for servers that want one. */
  certificate?: string | Buffer;
  key?: string | Buffer;
  /** What the server's certificate says, unless that is in the address. */
  serverName?: string;
}

/** Room for the largest meshes and shapes that a server may be told to allow. */
export const maxMessageBytes = 256 * 1024 * 1024;

/** Whether a text can be an id or a user: 1 to 128 characters of A-Z a-z 0-9 . _ -. */
export const isName = (text: string): boolean => /^[A-Za-z0-9._-]{1,128}$/.test(text);

// Whatever gRPC connects to without leaving this machine.
function isLocal(address: string): boolean {
  if (/^unix(-abstract)?:/.test(address)) return true;
  const host = address.replace(/^(dns:\/\/\/|dns:|ipv4:|ipv6:)/, "").replace(/:[^:]*$/, "");
  return host === "localhost" || host === "[::1]" || /^127\.[0-9.]+$/.test(host);
}

const usesTls = (options: ConnectOptions): boolean =>
  options.tls === true ||
  [options.rootCertificates, options.certificate, options.key].some((file) => file);

function slurp(file: string | Buffer | undefined, field: string): Buffer | null {
  if (file === undefined || file.length === 0) return null;
  if (typeof file !== "string") return file;
  if (file.startsWith("-----BEGIN")) return Buffer.from(file);
  try {
    const text = readFileSync(file);
    if (text.length > 0) return text;
  } catch (error) {
    throw badOption(field, `${file} cannot be read: ${(error as Error).message}.`);
  }
  throw badOption(field, `${file} cannot be read: it is empty.`);
}

function check(address: string, options: ConnectOptions): void {
  if (!options.certificate !== !options.key) {
    throw badOption(
      options.key ? "certificate" : "key",
      "A client certificate and its key have to be given together.",
    );
  }
  const token = options.token ?? "";
  if (!/^[!-~]*$/.test(token))
    throw badOption("token", "The token has characters that no token has.");
  if (options.user && !isName(options.user)) {
    throw badOption("user", "A user is 1 to 128 characters of A-Z a-z 0-9 . _ -.");
  }
  if (token && !usesTls(options) && !options.tokenInPlaintext && !isLocal(address)) {
    throw badOption(
      "token",
      `The token would go to ${address} in plaintext, for everyone on the way to read: use TLS.`,
    );
  }
}

function credentialsOf(options: ConnectOptions): ChannelCredentials {
  if (!usesTls(options)) return credentials.createInsecure();
  const roots = slurp(options.rootCertificates, "rootCertificates");
  const key = slurp(options.key, "key");
  const certificate = slurp(options.certificate, "certificate");
  return credentials.createSsl(roots, key, certificate);
}

function argumentsFor(address: string, options: ConnectOptions): ChannelOptions {
  return {
    // What http_proxy names cannot reach this machine; it is asked for other machines alone.
    ...(isLocal(address) && { "grpc.enable_http_proxy": 0 }),
    ...(options.serverName && {
      "grpc.ssl_target_name_override": options.serverName,
      "grpc.default_authority": options.serverName,
    }),
    "grpc.max_receive_message_length": maxMessageBytes,
    "grpc.max_send_message_length": maxMessageBytes,
    // A server that is back is found soon.
    "grpc.initial_reconnect_backoff_ms": 100,
    "grpc.max_reconnect_backoff_ms": 2000,
    // Channels to one address share a connection unless each has its own pool.
    "grpc.use_local_subchannel_pool": 1,
    // We make calls again ourselves. Without room to keep what was written a write is done when the
    // connection has taken it, which is what tells a stream to wait.
    "grpc.enable_retries": 0,
    "grpc.per_rpc_retry_buffer_size": 0,
  };
}

// What channels of one client have in common.
interface Family {
  connect: () => GrpcClient;
  identity: readonly (readonly [string, string])[];
  channels: Set<Channel>;
  onClose: Set<() => void>;
  closed: boolean;
}

/** The connection, shared by everything that a Client hands out. */
export class Channel {
  readonly grpc: GrpcClient;
  readonly #family: Family;

  /**
   * INVALID_OPTION with the field: options that do not go together, or a file that cannot be read.
   */
  static open(address: string, options: ConnectOptions): Channel {
    check(address, options);
    const identity: [string, string][] = [];
    if (options.token) identity.push(["authorization", `Bearer ${options.token}`]);
    if (options.user) identity.push(["x-arapd-owner", options.user]);
    const how = credentialsOf(options);
    const channelOptions = argumentsFor(address, options);
    const connect = (): GrpcClient => new GrpcClient(address, how, channelOptions);
    return new Channel({
      connect,
      identity,
      channels: new Set(),
      onClose: new Set(),
      closed: false,
    });
  }

  private constructor(family: Family) {
    this.#family = family;
    this.grpc = family.connect();
    family.channels.add(this);
  }

  /** The same over a connection of its own: for when this one may be dead without saying so. */
  another(): Channel {
    return new Channel(this.#family);
  }

  /** What every call says of who is calling. CANCELLED after the client was closed. */
  metadata(): Metadata {
    if (this.#family.closed) throw cancelled("The client was closed.");
    const metadata = new Metadata();
    for (const [name, value] of this.#family.identity) metadata.set(name, value);
    return metadata;
  }

  /** Calls `stop` when the signal is aborted or the client closed, until the answer is called. */
  onStop(signal: AbortSignal | undefined, stop: () => void): () => void {
    signal?.addEventListener("abort", stop);
    this.#family.onClose.add(stop);
    return () => {
      signal?.removeEventListener("abort", stop);
      this.#family.onClose.delete(stop);
    };
  }

  /** Closes this connection alone. */
  close(): void {
    this.#family.channels.delete(this);
    this.grpc.close();
  }
  /** Stops every call, and closes all connections. */
  closeAll(): void {
    this.#family.closed = true;
    for (const stop of [...this.#family.onClose]) stop();
    for (const channel of this.#family.channels) channel.close();
  }
}
