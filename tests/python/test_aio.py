"""The same journeys with asyncio, and what is its own: tasks that are cancelled."""

import asyncio

import numpy as np
import pytest

import arapd
import arapd.aio
from arapd import Handle, Reason
from support import bent, grid


def run(server, journey):
    async def main():
        async with arapd.aio.connect(server.address) as client:
            async with client.create_session() as session:
                await session.register_mesh(*grid(), "m")
                await session.compile_handles("h", "m", [Handle("l", vertex=0),
                                                         Handle("r", vertex=8)])
                await journey(client, session)
    asyncio.run(asyncio.wait_for(main(), 240))


def test_calls(server):
    async def journey(client, session):
        await client.wait_ready(60)
        assert (await client.server_info()).workers > 0
        shape = await session.deform("h", {"l": (0, 0), "r": (8, 0)})
        np.testing.assert_allclose(shape.positions, grid()[0], atol=1e-5)
        shapes = [shape async for shape in
                  session.deform_track("h", ["l", "r"], np.tile([[0.0, 0], [8, 1]], (4, 1, 1)))]
        assert [shape.sequence for shape in shapes] == [0, 1, 2, 3]
        assert (await session.info()).handle_set_ids == ("h",)
        with pytest.raises(arapd.ArapError) as missing:
            await session.get_mesh("none")
        assert missing.value.reason is Reason.NOT_FOUND
        assert missing.value.details["request_id"]
    run(server, journey)


def test_calls_at_the_same_time(server):
    async def journey(_, session):
        shapes = await asyncio.gather(*(session.deform("h", {"l": (0, 0), "r": (8, y)})
                                        for y in range(8)))
        for y, shape in enumerate(shapes):
            np.testing.assert_allclose(shape.positions[8], (8, y), atol=1e-2)
    run(server, journey)


def test_flattening_and_jobs(server):
    async def journey(client, session):
        surface = bent()
        flat = await client.flatten(*surface)
        await session.submit_flatten("job", *surface)
        states = [job.state async for job in session.watch_job("job")]
        assert states[-1] == "done"
        assert (await session.wait_job("job")).state == "done"
        result = await session.job_result("job", *surface)
        np.testing.assert_array_equal(result.uv, flat.uv)
    run(server, journey)


def test_a_stream(server):
    async def journey(_, session):
        async with session.open_stream("h") as stream:
            assert await stream.send({"r": (8, 1)}) == 1
            assert (await stream.read()).sequence == 1
            await stream.edit(add=[Handle("t", vertex=80)])
            assert (await stream.read()).handle_set_revision == stream.handle_set.revision + 1
            await stream.send({"nobody": (0, 0)})
            assert (await stream.read()).error.reason is Reason.UNKNOWN_HANDLE
            await stream.ping(3)
            assert await stream.read() == arapd.Pong(3)
            for y in range(200):
                await stream.send({"r": (8, y / 100)})
            await stream.close_sending()
            shapes = [shape async for shape in stream]
            assert shapes[-1].sequence == 203
            assert sum(1 + shape.replaced for shape in shapes) == 200
            assert await stream.read() is None
    run(server, journey)


def test_who_sends_without_end_lets_others_have_their_turn(server):
    async def journey(_, session):
        async with session.open_stream("h") as stream:
            reading = asyncio.create_task(stream.read())
            while not reading.done():
                await stream.send({"r": (8, 1)})
            assert isinstance(await reading, arapd.Shape)
    run(server, journey)


def test_a_read_that_is_given_up_loses_nothing(server):
    async def journey(_, session):
        async with session.open_stream("h", arapd.StreamOptions(delivery="every")) as stream:
            for _ in range(3):
                with pytest.raises(asyncio.TimeoutError):
                    await asyncio.wait_for(stream.read(), 0.01)
            await stream.send({"r": (8, 1)})
            await stream.send({"r": (8, 2)})
            assert [(await stream.read()).sequence for _ in range(2)] == [1, 2]
    run(server, journey)


def test_a_task_that_is_cancelled_cancels_its_call(server):
    async def journey(client, session):
        track = session.deform_track("h", ["l", "r"], np.zeros((1000, 2, 2)))
        async for shape in track:
            if shape.sequence == 2:
                break
        await track.aclose()
        task = asyncio.create_task(client.flatten(*bent(200, 200)))
        await asyncio.sleep(0)
        task.cancel()
        with pytest.raises(asyncio.CancelledError):
            await task
        assert (await client.server_info()).workers > 0
    run(server, journey)


def test_cancel_ends_a_waiting_read(server):
    async def journey(_, session):
        stream = await session.open_stream("h", arapd.StreamOptions(resume_within=60))
        reading = asyncio.create_task(stream.read())
        await asyncio.sleep(0)
        stream.cancel()
        with pytest.raises(arapd.ArapError) as cancelled:
            await reading
        assert cancelled.value.reason is Reason.CANCELLED
        await stream.close()
        assert stream._watching.done()
    run(server, journey)


def test_a_client_that_is_closed_ends_its_calls(server):
    async def journey(_, session):
        client = arapd.aio.connect(server.address)
        stream = await client.attach_session(session.id).open_stream(
            "h", arapd.StreamOptions(resume_within=60))
        await client.close()
        with pytest.raises(arapd.ArapError) as closed:
            await stream.read()
        assert closed.value.reason is Reason.CANCELLED
        with pytest.raises(arapd.ArapError) as closed:
            await client.server_info()
        assert closed.value.reason is Reason.CANCELLED
    run(server, journey)
