"""Client of arapd: as-rigid-as-possible deformation and flattening as a service.

    import arapd

    with arapd.connect("localhost:50051") as client, client.create_session() as session:
        mesh = session.register_mesh(vertices, triangles).mesh          # #V×2, #F×3
        session.compile_handles("puppet", mesh.id, [arapd.Handle("head", vertex=0),
                                                    arapd.Handle("foot", vertex=8)])
        with session.open_stream("puppet") as stream:
            stream.send({"head": (0.0, 60.0)})
            shape = stream.read()                                       # shape.positions is #V×2

The same with `async with` and `await` is arapd.aio. What calls take and answer is in arapd.model,
what goes wrong in arapd.faults.
"""

from ._calls import QUICK_LIMIT, WORK_LIMIT, CallOptions
from ._channel import ConnectOptions
from ._stream_state import StreamOptions
from ._sync import Client, Session, Stream, connect
from .faults import ArapError, Reason
from .model import (Chart, Compilation, Distortion, Drawing, DrawingFile, DrawingOptions, Energy, FlattenOptions, Flattening, GrainLine,
                    Handle, HandleSet, Job, MeshInfo, OutlineMesh, Pick, Pin, PlacedHandle, Pong,
                    Registration, Repair, Resumed, ServerInfo, SessionInfo, SessionPage, Shape,
                    ShapeOptions, Target, UpdateError, Warning)

__all__ = [
    "ArapError", "CallOptions", "Chart", "Client", "Compilation", "ConnectOptions", "Distortion", "Drawing",
    "DrawingFile", "DrawingOptions",
    "Energy", "FlattenOptions", "Flattening", "GrainLine", "Handle", "HandleSet", "Job", "MeshInfo",
    "OutlineMesh", "Pick", "Pin", "PlacedHandle", "Pong", "QUICK_LIMIT", "Reason", "Registration",
    "Repair", "Resumed", "ServerInfo", "Session", "SessionInfo", "SessionPage", "Shape",
    "ShapeOptions", "Stream", "StreamOptions", "Target", "UpdateError", "WORK_LIMIT", "Warning",
    "connect",
]
