"""TLS, tokens and gateways; blocking and with asyncio."""

import asyncio
import subprocess

import pytest

import arapd
import arapd.aio
from arapd import ArapError, Reason
from support import ARAPCTL, PATIENCE, Server


def run(*command):
    ran = subprocess.run(command, text=True, capture_output=True, timeout=PATIENCE)
    assert ran.returncode == 0, ran.stderr
    return ran.stdout.strip()


def token(folder, *arguments):
    return run(ARAPCTL, "token", "add", "--file", f"{folder}/tokens.json", *arguments)


@pytest.fixture(scope="module")
def secured(tmp_path_factory):
    """A server with TLS that wants tokens: itself, its certificate, a token of alice, one of a
    gateway."""
    folder = tmp_path_factory.mktemp("secured")
    certificate, key = f"{folder}/cert.pem", f"{folder}/key.pem"
    run("openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj",
        "/CN=arap.test", "-addext", "subjectAltName=DNS:arap.test", "-out", certificate, "-keyout",
        key)
    alice = token(folder, "--owner", "alice")
    gateway = token(folder, "--owner", "web", "--role", "gateway")
    with Server(folder, "--tls-cert", certificate, "--tls-key", key, "--token-file",
                f"{folder}/tokens.json", listen="127.0.0.1:0") as server:
        yield server, certificate, alice, gateway


def owners(server, certificate, token_, user=""):
    """The sessions that such a caller sees after it has opened one, blocking and with asyncio."""
    options = dict(root_certificates=certificate, server_name="arap.test", token=token_, user=user)

    async def ask():
        async with arapd.aio.connect(server.address, **options) as client:
            async with client.create_session():
                return len((await client.list_sessions()).sessions)

    with arapd.connect(server.address, **options) as client, client.create_session():
        return len(client.list_sessions().sessions), asyncio.run(ask())


def test_who_has_the_token_is_let_in_and_sees_what_is_theirs(secured):
    server, certificate, alice, gateway = secured
    assert owners(server, certificate, alice) == (1, 2)
    assert owners(server, certificate, gateway, "ann") == (1, 2)
    with arapd.connect(server.address, root_certificates=certificate, server_name="arap.test",
                       token=alice) as client, client.create_session():
        assert owners(server, certificate, gateway, "bob") == (1, 2)


@pytest.mark.parametrize("options, reason", [
    ({}, Reason.UNAUTHENTICATED),
    ({"token": "arapd_wrong"}, Reason.UNAUTHENTICATED),
    ({"server_name": "other.test"}, Reason.DRAINING),
    ({"root_certificates": "", "tls": True}, Reason.DRAINING),
], ids=["no_token", "wrong_token", "other_name", "unknown_authority"])
def test_others_are_not(secured, options, reason):
    server, certificate, _, _ = secured
    given = {"root_certificates": certificate, "server_name": "arap.test", **options}
    with arapd.connect(server.address, **given) as client:
        with pytest.raises(ArapError) as refused:
            client.create_session(retry_within=0)
        assert refused.value.reason is reason


def test_without_tls_nobody_answers(secured):
    server, *_ = secured
    with arapd.connect(server.address) as client, pytest.raises(ArapError) as refused:
        client.server_info(retry_within=0)
    assert refused.value.reason is Reason.DRAINING
