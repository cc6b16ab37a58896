"""Streams of servers that are silent, late, confused, or full; blocking and with asyncio."""

import asyncio
import threading

import grpc
import pytest

import arapd
import arapd.aio
from arapd import ArapError, Reason, StreamOptions
from fake import message, opened, serving, shape, streamed

QUICK = dict(heartbeat=0.05, silence=0.3)


def talk(address, steps, options=StreamOptions()):
    """Opens a stream and sends (x, 0) for every number of `steps`; a None reads events up to one that
    is not Resumed."""
    events = []
    with arapd.connect(address) as client:
        with client.attach_session("s").open_stream("h", options, timeout=100) as stream:
            for step in steps:
                if step is None:
                    events.append(stream.read())
                    while isinstance(events[-1], arapd.Resumed):
                        events.append(stream.read())
                else:
                    stream.send({"a": (step, 0)})
    return events


def talk_async(address, steps, options=StreamOptions()):
    async def run():
        events = []
        async with arapd.aio.connect(address) as client:
            async with client.attach_session("s").open_stream("h", options, timeout=100) as stream:
                for step in steps:
                    if step is None:
                        events.append(await stream.read())
                        while isinstance(events[-1], arapd.Resumed):
                            events.append(await stream.read())
                    else:
                        await stream.send({"a": (step, 0)})
        return events
    return asyncio.run(asyncio.wait_for(run(), 200))


@pytest.fixture(params=[talk, talk_async], ids=["blocking", "asyncio"])
def way(request):
    return request.param


def pong(nonce=0):
    answer = message("StreamDeformResponse")()
    answer.pong.nonce = nonce
    answer.pong.SetInParent()
    return answer


def answering(*answers, then=()):
    """Opens, answers the first updates so, and then says what is left, whatever comes."""
    def stream(requests, context):
        next(requests)
        yield opened("a")
        left = list(answers)
        for request in requests:
            if request.HasField("ping"):
                yield pong(request.ping.nonce)
            elif left:
                yield left.pop(0)
            if not left and then:
                yield from then
                return
    return stream


def silent(requests, context):
    """Opens, and hears nothing any more."""
    next(requests)
    yield opened("a")
    gone = threading.Event()
    context.add_callback(gone.set)
    gone.wait(100)


@pytest.mark.parametrize("answer, says", [
    (streamed(sequence=2), "sequence 2, for which it was not asked"),
    (opened("a"), "does not belong here"),
    (pong(9), "ping that was not sent"),
    (message("StreamDeformResponse")(), "does not belong here"),
    (streamed(vertices=0), "empty"),
    (b"\xff", "no message"),
])
def test_answers_that_do_not_fit(tmp_path, way, answer, says):
    with serving(tmp_path, StreamDeform=answering(answer)) as address:
        for options in (StreamOptions(), StreamOptions(resume_within=60)):
            with pytest.raises(ArapError, match=says) as wrong:
                way(address, [1, None], options)
            assert wrong.value.reason is Reason.INTERNAL


def test_an_end_without_answers_is_none(tmp_path, way):
    with serving(tmp_path, StreamDeform=answering(streamed(), then=[pong()])) as address:
        with pytest.raises(ArapError, match="ended the stream early|ping"):
            way(address, [1, None, 2, None])


def test_shapes_change_their_size(tmp_path, way):
    with serving(tmp_path, StreamDeform=answering(
            streamed(), streamed(vertices=4, sequence=2))) as address:
        with pytest.raises(ArapError, match="4 vertices; the mesh has 3"):
            way(address, [1, None, 2, None])


def test_silence_is_noticed(tmp_path, way):
    with serving(tmp_path, StreamDeform=silent) as address:
        with pytest.raises(ArapError, match="Nothing was heard from the server for 0.3 s") as gone:
            way(address, [1, None], StreamOptions(**QUICK))
        assert gone.value.reason is Reason.DRAINING
        assert gone.value.code is grpc.StatusCode.UNAVAILABLE


def test_signs_of_life_are_no_answer(tmp_path, way):
    with serving(tmp_path, StreamDeform=answering()) as address:
        with pytest.raises(ArapError, match="not (answered an update or edit|opened the stream) for 0.6 s") as late:
            way(address, [1, None], StreamOptions(heartbeat=0.05, silence=60, answer=0.6))
        assert late.value.reason is Reason.DEADLINE_EXCEEDED


def test_an_opening_that_never_comes(tmp_path, way):
    def stream(requests, context):
        for request in requests:
            if request.HasField("ping"):
                yield pong()

    with serving(tmp_path, StreamDeform=stream) as address:
        with pytest.raises(ArapError, match="opened the stream for 0.5 s"):
            way(address, [None], StreamOptions(heartbeat=0.05, silence=60, answer=0.5))


def test_a_silent_server_is_left_for_one_that_answers(tmp_path, way):
    calls = []

    def stream(requests, context):
        calls.append(context.peer())
        yield from (silent if len(calls) == 1 else answering(streamed()))(requests, context)

    with serving(tmp_path, StreamDeform=stream) as address:
        options = StreamOptions(resume_within=60, heartbeat=0.05, silence=3)
        resumed, told = way(address, [1, None], options)
        assert isinstance(resumed, arapd.Resumed) and resumed.attempts >= 1
        assert (told.sequence, told.replaced) == (1, 0)


def test_what_proxies_say_of_a_lost_server(tmp_path, way):
    code = grpc.StatusCode
    left = [(code.UNAVAILABLE, "x"), (code.UNKNOWN, "Stream removed"),
            (code.INTERNAL, "Received RST_STREAM with error code 2"),
            (code.RESOURCE_EXHAUSTED, "no room"), (code.CANCELLED, "")]

    def stream(requests, context):
        if not left:
            yield from answering(streamed())(requests, context)
            return
        how, says = left.pop(0)
        next(requests)
        if how is not code.RESOURCE_EXHAUSTED:
            yield opened("a")
        context.abort(how, says)

    with serving(tmp_path, StreamDeform=stream) as address:
        events = way(address, [1, None], StreamOptions(resume_within=60))
        assert not left
        assert len(events) > 1 and events[-1].sequence == 1


def test_other_ends_are_final(tmp_path, way):
    def stream(requests, context):
        next(requests)
        yield opened("a")
        context.abort(grpc.StatusCode.UNAUTHENTICATED, "who are you?")

    with serving(tmp_path, StreamDeform=stream) as address:
        with pytest.raises(ArapError, match="who are you") as final:
            way(address, [None], StreamOptions(resume_within=60))
        assert final.value.code is grpc.StatusCode.UNAUTHENTICATED


def test_resuming_gives_up_in_time(tmp_path, way):
    def stream(requests, context):
        context.abort(grpc.StatusCode.UNAVAILABLE, "never here")
        yield shape()

    calls = []

    def first_well(requests, context):
        calls.append(1)
        if len(calls) > 1:
            yield from stream(requests, context)
        next(requests)
        yield opened("a")
        context.abort(grpc.StatusCode.UNAVAILABLE, "gone")

    with serving(tmp_path, StreamDeform=first_well) as address:
        with pytest.raises(ArapError, match="never here") as gone:
            way(address, [None], StreamOptions(resume_within=0.3))
        assert gone.value.reason is Reason.DRAINING
