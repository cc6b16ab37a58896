"""How a client connects and who it says it is."""

from __future__ import annotations

import dataclasses
import re
from typing import Any

import grpc

from . import _checks
from .faults import invalid_option

# Room for the largest meshes and shapes that a server may be told to allow.
MAX_MESSAGE_BYTES = 256 << 20
_LOOPBACK = re.compile(r"localhost|\[::1\]|127\.[0-9.]*")


@dataclasses.dataclass(frozen=True, slots=True)
class ConnectOptions:
    """What connect() takes beside the address. Files are in PEM and read once."""

    token: str = dataclasses.field(default="", repr=False)  # `arapctl token add` makes them
    # Without TLS a token is sent to this machine only, unless this allows everybody on the way to read
    # it.
    token_in_plaintext: bool = False
    user: str = ""  # for whom the calls are made, where the token has the role gateway
    tls: bool = False  # implied by each of the files
    root_certificates: str = ""  # who vouches for the server; "": the system's authorities
    certificate: str = ""  # the client's own, with its key
    key: str = ""
    server_name: str = ""  # what the server's certificate says, unless that is in the address

    @property
    def wants_tls(self) -> bool:
        return self.tls or bool(self.root_certificates or self.certificate or self.key)


def is_local(address: str) -> bool:
    """Whatever grpc connects to without leaving this machine."""
    if address.startswith(("unix:", "unix-abstract:")):
        return True
    for scheme in ("dns:///", "dns:", "ipv4:", "ipv6:"):
        if address.startswith(scheme):
            address = address.removeprefix(scheme)
            break
    return _LOOPBACK.fullmatch(address.rpartition(":")[0] or address) is not None


def _read(path: str, field: str) -> bytes | None:
    if not path:
        return None
    try:
        with open(path, "rb") as file:
            data = file.read()
    except OSError as error:
        raise invalid_option(f"{path} cannot be read: {error.strerror}.", field) from None
    if not data:
        raise invalid_option(f"{path} cannot be read: it is empty.", field)
    return data


def _check(address: str, options: ConnectOptions) -> None:
    if bool(options.certificate) != bool(options.key):
        raise invalid_option("A client certificate and its key have to be given together.",
                             "certificate" if options.key else "key")
    if not all(" " < c <= "~" for c in options.token):
        raise invalid_option("The token has characters that no token has.", "token")
    if options.user and not _checks.is_name(options.user):
        raise invalid_option(f"user is {_checks.quote(options.user)}, which is no name.", "user")
    if (options.token and not options.wants_tls and not options.token_in_plaintext
            and not is_local(address)):
        raise invalid_option(f"The token would go to {address} in plaintext, for everyone on the way "
                             "to read: use TLS.", "token")


class ChannelPlan:
    """What a channel is made of, for _sync.py and _asyncio.py to make one, and others like it.

    ArapError INVALID_OPTION with the field for options that do not go together, a file that cannot
    be read, or a token that would travel in plaintext."""

    def __init__(self, address: str, options: ConnectOptions):
        _check(address, options)
        self.address = address
        self.credentials: grpc.ChannelCredentials | None = None
        if options.wants_tls:
            self.credentials = grpc.ssl_channel_credentials(
                _read(options.root_certificates, "root_certificates"), _read(options.key, "key"),
                _read(options.certificate, "certificate"))
        self.arguments: list[tuple[str, Any]] = [
            ("grpc.max_receive_message_length", MAX_MESSAGE_BYTES),
            ("grpc.max_send_message_length", MAX_MESSAGE_BYTES),
            # A server that is back is found soon: by default pauses grow to two minutes.
            ("grpc.initial_reconnect_backoff_ms", 100),
            ("grpc.max_reconnect_backoff_ms", 2000),
            # Channels to one address share a connection unless each has its own pool.
            ("grpc.use_local_subchannel_pool", 1),
        ]
        if is_local(address):  # what http_proxy names cannot reach this machine
            self.arguments.append(("grpc.enable_http_proxy", 0))
        if options.server_name:
            self.arguments.append(("grpc.ssl_target_name_override", options.server_name))
        identity = []
        if options.token:
            identity.append(("authorization", f"Bearer {options.token}"))
        if options.user:
            identity.append(("x-arapd-owner", options.user))
        self.identity = tuple(identity)  # sent with every call

    def make(self, module: Any) -> Any:
        """A channel of `module`, grpc or grpc.aio."""
        if self.credentials is None:
            return module.insecure_channel(self.address, self.arguments)
        return module.secure_channel(self.address, self.credentials, self.arguments)
