"""What type checkers know of the package: what calls answer, in both ways of waiting."""

import inspect
import os
import subprocess
import sys

import pytest

import arapd
import arapd.aio
from arapd import _wire

USE = '''
from collections.abc import AsyncIterator, Iterator
from typing import assert_type

import arapd
import arapd.aio
from arapd.model import Event


def blocking(client: arapd.Client) -> None:
    assert_type(client.server_info(timeout=1), arapd.ServerInfo)
    assert_type(client.flatten([], []), arapd.Flattening)
    with client.create_session() as session:
        assert_type(session, arapd.Session)
        assert_type(session.register_mesh([], [], "m").mesh, arapd.MeshInfo)
        assert_type(session.deform("h", {"head": (0, 60)}), arapd.Shape)
        assert_type(session.deform_track("h", ["head"], []), Iterator[arapd.Shape])
        assert_type(session.watch_job("j"), Iterator[arapd.Job])
        assert_type(session.delete(), None)
        with session.open_stream("h") as stream:
            assert_type(stream.send({"head": 1 + 2j}), int)
            assert_type(stream.read(), Event | None)
            for event in stream:
                assert_type(event, Event)
    if arapd.ArapError.__doc__ and arapd.Reason.NOT_FOUND == "NOT_FOUND":
        arapd.Handle("head", vertex=0)


async def awaited(client: arapd.aio.Client) -> None:
    assert_type(await client.server_info(timeout=1), arapd.ServerInfo)
    async with client.create_session() as session:
        assert_type(session, arapd.aio.Session)
        assert_type((await session.compile_handles("h", "m", [])).handle_set, arapd.HandleSet)
        assert_type(session.deform_track("h", ["head"], []), AsyncIterator[arapd.Shape])
        async with session.open_stream("h") as stream:
            assert_type(await stream.read(), Event | None)
'''

WRONG = '''
import arapd

arapd.Handle("head", corner=1)
arapd.connect("localhost:1").get_mesh("m")
arapd.connect("localhost:1").server_info().verson
'''


def check(tmp_path, text):
    pytest.importorskip("mypy")
    program = tmp_path / "program.py"
    program.write_text(text)
    package = os.path.dirname(os.path.dirname(arapd.__file__))
    config = tmp_path / "mypy.ini"
    config.write_text("[mypy]\nstrict = true\n[mypy-grpc.*,google.protobuf.*]\n"
                      "ignore_missing_imports = true\n")
    return subprocess.run(
        [sys.executable, "-m", "mypy", "--config-file", config, "--cache-dir", tmp_path / "cache",
         program], capture_output=True, text=True, env={**os.environ, "MYPYPATH": package})


def test_results_have_types_and_the_package_is_right_by_them(tmp_path):
    ran = check(tmp_path, USE)
    assert ran.returncode == 0, ran.stdout + ran.stderr


def test_mistakes_are_found(tmp_path):
    lines = check(tmp_path, WRONG).stdout.splitlines()
    assert [line.split(":")[1] for line in lines if ": error: " in line] == ["4", "5", "6"], lines


def test_help_tells_what_is_answered():
    def answered(method):
        return inspect.signature(method).return_annotation

    assert answered(arapd.Client.server_info) == "model.ServerInfo"
    assert answered(arapd.aio.Session.deform) == "model.Shape"
    assert answered(arapd.Session.deform_track) == "Iterator[model.Shape]"


def test_every_reason_of_the_protocol_has_its_name():
    names = {name.removeprefix("ERROR_REASON_")
             for name, number in _wire.enum_names("ErrorReason").items() if number}
    assert {reason.name for reason in arapd.Reason} == names
    assert all(reason == reason.name for reason in arapd.Reason)
