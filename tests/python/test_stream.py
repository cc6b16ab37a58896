"""Live streams, blocking, of a server that nothing happens to."""

import threading

import numpy as np
import pytest

import arapd
from arapd import Handle, Reason
from support import grid, wait_until


@pytest.fixture
def puppet(session):
    session.register_mesh(*grid(), "m")
    session.compile_handles("h", "m", [Handle("l", vertex=0), Handle("r", vertex=8, oriented=True)])
    return session


def test_updates_are_answered_by_shapes(puppet):
    with puppet.open_stream("h") as stream:
        assert [handle.id for handle in stream.handle_set.handles] == ["l", "r"]
        assert stream.send({"r": (8, 1)}) == 1
        shape = stream.read()
        assert (shape.sequence, shape.replaced) == (1, 0)
        assert stream.send(positions=[[0, 0], [8, 0]], picks=[[4, 4.25]], sequence=7) == 7
        shape = stream.read()
        assert shape.sequence == 7
        np.testing.assert_allclose(shape.picks[0].rest, (4, 4.25), atol=1e-3)
        assert stream.send({"r": arapd.Target(8, 0, 0.5, 1.5), "l": 0j}) == 8
        assert stream.read().sequence == 8
        stream.ping(5)
        assert stream.read() == arapd.Pong(5)
        assert stream.connected
        stream.close_sending()
        assert stream.read() is None
        assert stream.read() is None
        with pytest.raises(arapd.ArapError) as over:
            stream.send({"r": (8, 1)})
        assert over.value.reason is Reason.PROTOCOL
        assert (stream.counts.sent, stream.counts.answered) == (3, 3)


def test_edits(puppet):
    with puppet.open_stream("h") as stream:
        stream.edit(remove=["l"], add=[Handle("t", vertex=80)])
        shape = stream.read()
        assert shape.handle_set_revision == stream.handle_set.revision + 1
        stream.send(positions=[[8, 0], [8, 9]])
        np.testing.assert_allclose(stream.read().positions[80], (8, 9), atol=1e-2)
    assert [handle.id for handle in puppet.get_handle_set("h").handles] == ["l", "r"]


def test_a_bad_update_is_told_and_the_stream_goes_on(puppet):
    with puppet.open_stream("h") as stream:
        stream.send({"nobody": (0, 0)})
        event = stream.read()
        assert isinstance(event, arapd.UpdateError)
        assert event.sequence == 1
        assert event.error.reason is Reason.UNKNOWN_HANDLE
        assert event.error.field == "targets[0].handle_id"
        stream.send({"r": (float("nan"), 0)})
        assert stream.read().error.reason is Reason.NON_FINITE_TARGET
        stream.send({"r": (8, 1)})
        assert stream.read().sequence == 3
        assert stream.counts.refused == 2


def test_shapes_are_measured_as_often_as_was_asked(puppet):
    options = arapd.ShapeOptions(measure_every=3)
    with puppet.open_stream("h", arapd.StreamOptions(shape=options)) as stream:
        marks = []
        for number in range(7):
            stream.send({"r": (8, number / 4)})
            marks.append(stream.read().measured)
        assert marks == [True, False, False, True, False, False, True]
        stream.edit(add=[Handle("t", vertex=80)])
        assert stream.read().measured
        stream.send({"r": (9, 1)})
        left = stream.read()
        assert not left.measured
        assert (left.flipped_count, left.energy, left.mean_stretch, left.max_stretch) == (0, 0, 0, 0)
        assert left.worst_handle_id and left.worst_handle_error >= 0
        stream.send(measure=True)  # the hand rests
        rests = stream.read()
        assert rests.measured and rests.energy > 0 and rests.max_stretch > 1
        np.testing.assert_array_equal(rests.positions, left.positions)
    never = arapd.ShapeOptions(measure_every=0, float64=True)
    whole = puppet.deform("h", {"l": (0, 0), "r": (9, 1)}, arapd.ShapeOptions(float64=True))
    shape = puppet.deform("h", {"l": (0, 0), "r": (9, 1)}, never)
    assert whole.measured and not shape.measured
    np.testing.assert_array_equal(shape.positions, whole.positions)
    frames = puppet.deform_track("h", ["l", "r"], [[(0, 0), (8, y)] for y in range(5)],
                                 options=arapd.ShapeOptions(measure_every=2))
    assert [frame.measured for frame in frames] == [True, False, True, False, True]


def test_the_newest_update_wins_and_the_others_are_counted(puppet):
    with puppet.open_stream("h") as stream:
        for number in range(500):
            stream.send({"r": (8, number / 100), "l": (0, 0)})
        stream.close_sending()
        shapes = list(stream)
        assert shapes[-1].sequence == 500
        assert sum(1 + shape.replaced for shape in shapes) == 500
        assert stream.counts.replaced == 500 - len(shapes)
        np.testing.assert_allclose(shapes[-1].positions[8], (8, 4.99), atol=1e-2)


def test_every_update_is_answered_where_that_was_asked(puppet):
    with puppet.open_stream("h", arapd.StreamOptions(delivery="every")) as stream:
        def send():
            for number in range(300):
                stream.send({"r": (8, number / 100)})
            stream.close_sending()

        sender = threading.Thread(target=send)
        sender.start()
        shapes = list(stream)
        sender.join()
        assert [shape.sequence for shape in shapes] == list(range(1, 301))


def test_several_threads_send(puppet):
    with puppet.open_stream("h", arapd.StreamOptions(delivery="every")) as stream:
        def send(handle):
            for number in range(100):
                stream.send({handle: (0, number)})

        threads = [threading.Thread(target=send, args=(handle,)) for handle in "lr"]
        for thread in threads:
            thread.start()
        sequences = [stream.read().sequence for _ in range(200)]
        for thread in threads:
            thread.join()
        assert sequences == list(range(1, 201))


def test_cancel_ends_a_waiting_read(puppet):
    stream = puppet.open_stream("h", arapd.StreamOptions(resume_within=60))
    ends = []

    def read():
        try:
            stream.read()
        except arapd.ArapError as error:
            ends.append(error.reason)

    reader = threading.Thread(target=read)
    reader.start()
    stream.cancel()
    reader.join(60)
    assert ends == [Reason.CANCELLED]
    assert not stream.connected


def test_a_client_that_is_closed_ends_its_streams(server, puppet):
    client = arapd.connect(server.address)
    stream = client.attach_session(puppet.id).open_stream(
        "h", arapd.StreamOptions(resume_within=60))
    client.close()
    with pytest.raises(arapd.ArapError) as closed:
        stream.read()
    assert closed.value.reason is Reason.CANCELLED
    with pytest.raises(arapd.ArapError) as closed:
        client.server_info()
    assert closed.value.reason is Reason.CANCELLED


def test_streams_that_are_dropped_leave_no_threads(puppet):
    def threads():
        return [thread for thread in threading.enumerate() if thread.name.startswith("arapd")]

    before = len(threads())
    for _ in range(5):
        stream = puppet.open_stream("h")
        stream.send({"r": (8, 1)})
        stream.read()
    del stream
    wait_until(lambda: len(threads()) <= before, "the threads of dropped streams to end")


def test_a_sequence_has_to_grow_where_the_stream_resumes(puppet):
    with puppet.open_stream("h", arapd.StreamOptions(resume_within=60)) as stream:
        stream.send({"r": (8, 1)}, sequence=5)
        with pytest.raises(arapd.ArapError) as same:
            stream.send({"r": (8, 1)}, sequence=5)
        assert (same.value.reason, same.value.field) == (Reason.INVALID_OPTION, "sequence")


def test_the_end_of_the_session_is_the_end_of_the_stream(puppet):
    with puppet.open_stream("h", arapd.StreamOptions(resume_within=60)) as stream:
        puppet.delete()
        with pytest.raises(arapd.ArapError) as gone:
            stream.read()
        assert gone.value.reason is Reason.NOT_FOUND
        with pytest.raises(arapd.ArapError):
            stream.read()


class Interrupted:
    """A call whose next read is hit by Ctrl-C."""

    def __init__(self, rpc):
        self._rpc = rpc

    def __next__(self):
        raise KeyboardInterrupt

    def __getattr__(self, name):
        return getattr(self._rpc, name)


def test_a_read_that_is_interrupted_ends_the_call_and_a_stream_that_resumes_goes_on(puppet):
    with puppet.open_stream("h", arapd.StreamOptions(resume_within=60)) as stream:
        stream.send({"r": (8, 2)})
        assert stream.read().sequence == 1
        call = stream._core.call
        rpc, call._rpc = call._rpc, Interrupted(call._rpc)
        with pytest.raises(KeyboardInterrupt):
            stream.read()
        call._rpc = rpc
        stream.send({"l": (0, 1)})
        assert isinstance(stream.read(), arapd.Resumed)
        shape = stream.read()
        assert shape.sequence == 2
        np.testing.assert_allclose(shape.positions[8], (8, 2), atol=1e-2)
