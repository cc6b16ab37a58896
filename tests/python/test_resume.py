"""Streams outlive a server that is killed, drained or frozen under a running drag.

ARAPD_TEST_REPEATS says how often each is done to one stream; 20 is the full test."""

import asyncio
import os
import signal
import threading

import numpy as np
import pytest

import arapd
import arapd.aio
from support import Server, grid, wait_until

REPEATS = int(os.environ.get("ARAPD_TEST_REPEATS", "2"))
HANDLES = [arapd.Handle("l", vertex=0), arapd.Handle("r", vertex=8)]
TOP = arapd.Handle("t", vertex=76)
OPTIONS = dict(shape=arapd.ShapeOptions(float64=True), resume_within=300.0)


def options_for(harm, **more):
    """Only who is frozen has to be noticed by silence."""
    return arapd.StreamOptions(heartbeat=0.2, silence=2.0 if harm is freeze else 60.0, **OPTIONS,
                               **more)


def kill(server, connected):
    server.kill()
    server.start()


def drain(server, connected):
    server.signal(signal.SIGTERM)
    assert server.wait() == 0
    server.start()


def freeze(server, connected):
    server.freeze()
    try:
        wait_until(lambda: not connected(), "the silence to be noticed")
    finally:
        server.thaw()


HARMS = [kill, drain, freeze]


def prepare(server):
    """A session with a mesh and a handle set."""
    with arapd.connect(server.address) as client:
        session = client.create_session()
        session.register_mesh(*grid(), "m")
        session.compile_handles("h", "m", HANDLES)
        return session.id


def last_shape(server, session_id):
    """What a stream ends with that nothing happens to."""
    with arapd.connect(server.address) as client:
        options = arapd.StreamOptions(shape=OPTIONS["shape"])
        with client.attach_session(session_id).open_stream("h", options) as stream:
            stream.send({"r": (8, 3)})
            stream.read()
            stream.edit(add=[TOP])
            stream.read()
            stream.send({"l": (-1, 0), "r": (9, 1)})
            return stream.read()


def check_last(shape, expected):
    assert shape.handle_set_revision == expected.handle_set_revision
    np.testing.assert_array_equal(shape.positions, expected.positions)


def check(shape, expected, counts, sent):
    check_last(shape, expected)
    assert counts.sent == sent
    assert counts.refused == 0
    assert counts.answered + counts.replaced == counts.sent
    assert counts.resumed >= REPEATS
    print(f"{sent} sent, {counts.answered} answered, {counts.replaced} replaced by newer ones, "
          f"{counts.resumed} times resumed")


def step(number):
    """Where the drag has the handles; each update moves one."""
    return {"lr"[number % 2]: (8 * (number % 2), np.sin(number / 50))}


@pytest.mark.parametrize("delivery", ["latest", "every"])
@pytest.mark.parametrize("harm", HARMS)
def test_a_drag_goes_on(tmp_path, harm, delivery):
    with Server(tmp_path) as server:
        session_id = prepare(server)
        expected = last_shape(server, session_id)
        with arapd.connect(server.address) as client:
            session = client.attach_session(session_id)
            options = options_for(harm, delivery=delivery)
            with session.open_stream("h", options, timeout=600) as stream:
                stream.send({"r": (8, 3)})
                assert stream.read().sequence == 1
                stream.edit(add=[TOP])
                assert stream.read().sequence == 2
                done = threading.Event()
                failed, last = [], []

                def drag():
                    try:
                        while not done.wait(0.002):
                            stream.send(step(stream.counts.sent))
                        stream.send({"l": (-1, 0)})
                        last.append(stream.send({"r": (9, 1)}))
                        stream.close_sending()
                    except Exception as error:  # the test is that there is none
                        failed.append(error)
                        stream.cancel()

                shapes = []

                def read():
                    try:
                        shapes.extend(event for event in stream if isinstance(event, arapd.Shape))
                    except Exception as error:
                        failed.append(error)

                threads = [threading.Thread(target=drag), threading.Thread(target=read)]
                for thread in threads:
                    thread.start()
                try:
                    for times in range(REPEATS):
                        harm(server, lambda: stream.connected)
                        wait_until(lambda: failed or stream.counts.resumed > times and
                                   stream.connected, "the stream to resume")
                        answered = stream.counts.answered
                        wait_until(lambda: failed or stream.counts.answered > answered, "a shape")
                finally:
                    done.set()
                    for thread in threads:
                        thread.join(120)
                assert not failed, failed
                assert not any(thread.is_alive() for thread in threads)
        sequences = [shape.sequence for shape in shapes]
        assert sequences == sorted(set(sequences))
        assert sequences[-1] == last[0]
        check(shapes[-1], expected, stream.counts, last[0])


@pytest.mark.parametrize("harm", HARMS)
def test_a_drag_of_asyncio_goes_on(tmp_path, harm):
    async def run(server, session_id, expected):
        async with arapd.aio.connect(server.address) as client:
            session = client.attach_session(session_id)
            options = options_for(harm)
            async with session.open_stream("h", options, timeout=600) as stream:
                await stream.send({"r": (8, 3)})
                assert (await stream.read()).sequence == 1
                await stream.edit(add=[TOP])
                assert (await stream.read()).sequence == 2
                done = asyncio.Event()

                async def drag():
                    while not done.is_set():
                        await stream.send(step(stream.counts.sent))
                        await asyncio.sleep(0.002)
                    await stream.send({"l": (-1, 0)})
                    last = await stream.send({"r": (9, 1)})
                    await stream.close_sending()
                    return last

                async def read():
                    return [event async for event in stream if isinstance(event, arapd.Shape)]

                def do_harm():
                    for times in range(REPEATS):
                        harm(server, lambda: stream.connected)
                        wait_until(lambda: reading.done() or stream.counts.resumed > times and
                                   stream.connected, "the stream to resume")
                        answered = stream.counts.answered
                        wait_until(lambda: reading.done() or stream.counts.answered > answered,
                                   "a shape")

                dragging, reading = asyncio.create_task(drag()), asyncio.create_task(read())
                await asyncio.to_thread(do_harm)
                done.set()
                last, shapes = await asyncio.wait_for(asyncio.gather(dragging, reading), 120)
        sequences = [shape.sequence for shape in shapes]
        assert sequences == sorted(set(sequences))
        assert sequences[-1] == last
        check(shapes[-1], expected, stream.counts, last)

    with Server(tmp_path) as server:
        session_id = prepare(server)
        asyncio.run(run(server, session_id, last_shape(server, session_id)))


@pytest.mark.parametrize("delivery", ["latest", "every"])
def test_what_was_on_its_way_is_said_again_pings_too(tmp_path, delivery):
    with Server(tmp_path) as server:
        session_id = prepare(server)
        expected = last_shape(server, session_id)
        with arapd.connect(server.address) as client:
            session = client.attach_session(session_id)
            options = arapd.StreamOptions(delivery=delivery, **OPTIONS)
            with session.open_stream("h", options) as stream:
                stream.send({"r": (8, 3)})
                assert stream.read().sequence == 1
                stream.edit(add=[TOP])
                assert stream.read().sequence == 2
                server.kill()
                stream.send({"l": (-1, 0), "r": (9, 1)})  # nobody has read, so nobody knows yet
                stream.ping(77)
                server.start()
                events = {type(event): event for event in (stream.read() for _ in range(3))}
                assert len(events[arapd.Resumed].handle_set.handles) == 2, "before the edit"
                assert events[arapd.Pong] == arapd.Pong(77)
                check_last(events[arapd.Shape], expected)


def test_a_stream_gives_up_in_time_and_says_why_again(tmp_path):
    with Server(tmp_path) as server:
        session_id = prepare(server)
        with arapd.connect(server.address) as client:
            session = client.attach_session(session_id)
            with session.open_stream("h", arapd.StreamOptions(resume_within=0.3)) as stream:
                server.kill()
                for _ in range(2):
                    with pytest.raises(arapd.ArapError) as gone:
                        stream.read()
                    assert gone.value.reason is arapd.Reason.DRAINING
                with pytest.raises(arapd.ArapError) as over:
                    stream.send({"r": (8, 3)})
                assert over.value.reason is arapd.Reason.PROTOCOL


def test_a_connection_that_the_server_replaces_is_nothing_that_a_stream_shows(tmp_path):
    with Server(tmp_path, "--connection-age-seconds", "1", listen="127.0.0.1:0") as server:
        session_id = prepare(server)
        with arapd.connect(server.address) as client:
            session = client.attach_session(session_id)
            with session.open_stream("h", arapd.StreamOptions(**OPTIONS)) as stream:
                stream.send({"r": (8, 3)})
                events = [stream.read() for _ in range(2)]
                assert isinstance(events[1], arapd.Resumed) or isinstance(events[0], arapd.Resumed)
                number = stream.send({"l": (-1, 0), "r": (9, 1)})
                shape = stream.read()
                while not isinstance(shape, arapd.Shape) or shape.sequence != number:
                    shape = stream.read()
                assert shape.worst_handle_error < 0.1
            assert session.info().id == session_id
