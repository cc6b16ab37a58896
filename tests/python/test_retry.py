"""Which calls are made again, and which are not; answers in pieces that go on where they were lost."""

import asyncio
import time

import grpc
import numpy as np
import pytest

import arapd
import arapd.aio
from arapd import ArapError, Reason, faults
from fake import handle_set, message, serving
from support import bent

Code = grpc.StatusCode
DETAILS = "grpc-status-details-bin"


def blocking(address, ask):
    with arapd.connect(address) as client:
        answer = ask(client, client.attach_session("s"))
        return list(answer) if hasattr(answer, "__next__") else answer


def with_asyncio(address, ask):
    async def run():
        async with arapd.aio.connect(address) as client:
            answer = ask(client, client.attach_session("s"))
            return [one async for one in answer] if hasattr(answer, "__anext__") else await answer
    return asyncio.run(asyncio.wait_for(run(), 200))


@pytest.fixture(params=[blocking, with_asyncio])
def way(request):
    return request.param


def refusal(context, code, reason, delay=None):
    """Ends a call as arapd does that has not begun it."""
    status = faults._Status(code=code.value[0], message="Not now.")
    status.details.add().Pack(faults._ErrorInfo(reason=reason, domain="arapd"))
    if delay is not None:
        retry = faults._RetryInfo()
        retry.retry_delay.nanos = int(delay * 1e9)
        status.details.add().Pack(retry)
    context.set_trailing_metadata([(DETAILS, status.SerializeToString())])
    context.abort(code, "Not now.")


class Answers:
    """Does what it is told, call after call; the last thing for ever."""

    def __init__(self, *steps):
        self.steps = list(steps)
        self.calls = 0
        self.request_ids = set()

    def __call__(self, request, context):
        self.calls += 1
        self.request_ids.add(dict(context.invocation_metadata())["x-request-id"])
        step = self.steps[min(self.calls, len(self.steps)) - 1]
        return step(request, context) if callable(step) else step


def lost(_, context):
    context.abort(Code.UNAVAILABLE, "connection reset")


def overloaded(_, context):
    refusal(context, Code.RESOURCE_EXHAUSTED, "OVERLOADED", 0.01)


def not_found(_, context):
    refusal(context, Code.NOT_FOUND, "NOT_FOUND")


SESSION = message("GetSessionResponse")(session=message("Session")(session_id="s"))
EDITED = message("EditHandlesResponse")(handle_set=handle_set())
DELETED = message("DeleteSessionResponse")()


def info(_, session):
    return session.info(retry_within=100)


def edit(_, session):
    return session.edit_handles("h", retry_within=100)


def delete(_, session):
    return session.delete(retry_within=100)


@pytest.mark.parametrize("method, ask, steps", [
    ("GetSession", info, [lost, overloaded, lost, SESSION]),
    ("EditHandles", edit, [overloaded, overloaded, EDITED]),
    ("DeleteSession", delete, [lost, DELETED]),
    ("DeleteSession", delete, [lost, not_found]),  # it was done, and the answer was lost
])
def test_calls_that_are_made_again(tmp_path, way, method, ask, steps):
    answers = Answers(*steps)
    with serving(tmp_path, **{method: answers}) as address:
        way(address, ask)
    assert answers.calls == len(steps)
    assert len(answers.request_ids) == 1, "all attempts are one call"


@pytest.mark.parametrize("method, ask, steps, reason", [
    ("EditHandles", edit, [lost, EDITED], Reason.DRAINING),  # it may have been done
    ("DeleteSession", delete, [not_found], Reason.NOT_FOUND),
    ("GetSession", info, [not_found, SESSION], Reason.NOT_FOUND),
    ("GetSession", lambda _, session: session.info(retry_within=0), [lost], Reason.DRAINING),
])
def test_calls_that_are_not(tmp_path, way, method, ask, steps, reason):
    answers = Answers(*steps)
    with serving(tmp_path, **{method: answers}) as address:
        with pytest.raises(ArapError) as ended:
            way(address, ask)
    assert answers.calls == 1
    assert ended.value.reason is reason
    assert ended.value.details["request_id"] in answers.request_ids


def test_attempts_end_in_time(tmp_path, way):
    for times in ({"retry_within": 0.5}, {"retry_within": 100, "timeout": 0.5}):
        answers = Answers(lost)
        began = time.monotonic()
        with serving(tmp_path, GetSession=answers) as address:
            with pytest.raises(ArapError):
                way(address, lambda _, session: session.info(**times))
        assert time.monotonic() - began < 60


def test_a_server_that_asks_for_more_time_than_there_is_is_not_waited_for(tmp_path, way):
    def later(_, context):
        refusal(context, Code.RESOURCE_EXHAUSTED, "OVERLOADED", 0.9)

    answers = Answers(later)
    with serving(tmp_path, GetSession=answers) as address:
        with pytest.raises(ArapError) as busy:
            way(address, lambda _, session: session.info(retry_within=0.8))
    assert answers.calls == 1
    assert busy.value.retry_after == pytest.approx(0.9)


def flattened(triangles):
    count = triangles.max() + 1
    made = message("FlattenResponse")(uv=b"\0" * 8 * count, uv_vertex=range(count),
                                      corner_uv=triangles.ravel(),
                                      triangle_chart=[0] * len(triangles))
    made.charts.add(triangle_count=len(triangles))
    return made


def downloading(data, piece, fail_at=()):
    """Sends `data` in pieces from where it is asked, and is lost before some of them, once each."""
    left = set(fail_at)

    def download(request, context):
        offset = message("DownloadResultRequest").FromString(request).offset
        while offset < len(data):
            if offset in left:
                left.discard(offset)
                context.abort(Code.UNAVAILABLE, "connection reset")
            yield message("DownloadResultResponse")(
                data=data[offset:offset + piece], offset=offset, total_bytes=len(data))
            offset += piece
    return download


def test_a_result_goes_on_where_it_was_lost(tmp_path, way):
    surface = bent(5, 5)
    data = flattened(surface[1]).SerializeToString()
    download = downloading(data, 50, fail_at=(0, 50, 150))
    with serving(tmp_path, DownloadResult=download) as address:
        flat = way(address, lambda _, session: session.job_result("j", *surface, retry_within=100))
    np.testing.assert_array_equal(flat.corner_uv, surface[1])


@pytest.mark.parametrize("spoil", [
    lambda piece: setattr(piece, "offset", piece.offset + 1),
    lambda piece: setattr(piece, "total_bytes", piece.total_bytes + piece.offset),
    lambda piece: setattr(piece, "total_bytes", 1),
    lambda piece: setattr(piece, "total_bytes", 1 << 40),
])
def test_pieces_that_do_not_fit(tmp_path, way, spoil):
    data = bytes(200)

    def download(request, context):
        for offset in (0, 50):
            piece = message("DownloadResultResponse")(data=data[:50], offset=offset,
                                                      total_bytes=len(data))
            spoil(piece)
            yield piece

    with serving(tmp_path, DownloadResult=download) as address:
        with pytest.raises(ArapError, match="do not fit"):
            way(address, lambda _, session: session.job_result("j", *bent(5, 5)))


def test_a_result_that_ends_early(tmp_path, way):
    def download(request, context):
        yield message("DownloadResultResponse")(data=bytes(50), total_bytes=100)

    with serving(tmp_path, DownloadResult=download) as address:
        with pytest.raises(ArapError, match="50 bytes of a result of 100"):
            way(address, lambda _, session: session.job_result("j", *bent(5, 5)))


def job(state, **fields):
    made = message("WatchJobResponse")()
    made.job.job_id = "j"
    made.job.state = state
    for name, value in fields.items():
        setattr(made.job, name, value)
    return made


def test_watching_goes_on_where_it_was_lost(tmp_path, way):
    calls = []

    def watch(_, context):
        calls.append(1)
        yield job(2, phase="charts", fraction=0.25 * len(calls))
        if len(calls) < 3:
            context.abort(Code.UNAVAILABLE, "connection reset")
        yield job(3, fraction=1, result_bytes=7)

    with serving(tmp_path, WatchJob=watch) as address:
        told = way(address, lambda _, session: session.watch_job("j", retry_within=100))
    assert [one.state for one in told] == ["running"] * 3 + ["done"]
    assert told[-1].result_bytes == 7


@pytest.mark.parametrize("answers, says", [
    ([job(2)], "stopped telling"), ([job(0)], "no state"), ([job(9)], "no state"),
    ([job(2, fraction=1.5)], "1.5 of a job"), ([job(3, job_id="other")], 'the job "other"'),
])
def test_jobs_that_do_not_fit(tmp_path, way, answers, says):
    with serving(tmp_path, WatchJob=lambda *_: answers) as address:
        with pytest.raises(ArapError, match=says):
            way(address, lambda _, session: session.wait_job("j"))
