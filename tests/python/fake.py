"""A server that answers as a test says, in this process."""

import concurrent.futures
import contextlib

import grpc

from arapd import _wire

message = _wire.message


class _Methods(grpc.GenericRpcHandler):
    """`answers` has a function per method, of the request's bytes and the context: messages, or their
    bytes, or for a stream an iterator of such."""

    def __init__(self, answers):
        self._answers = answers

    def service(self, details):
        name = details.method.rpartition("/")[2]
        answer = self._answers.get(name)
        if answer is None:
            return None
        if name == "StreamDeform":
            return grpc.stream_stream_rpc_method_handler(
                lambda requests, context: map(_bytes, answer(_parsed(requests), context)))
        if name in ("DeformTrack", "WatchJob", "DownloadResult"):
            return grpc.unary_stream_rpc_method_handler(
                lambda request, context: map(_bytes, answer(request, context)))
        return grpc.unary_unary_rpc_method_handler(
            lambda request, context: _bytes(answer(request, context)))


def _bytes(answer):
    return answer if isinstance(answer, bytes) else answer.SerializeToString()


def _parsed(requests):
    return (message("StreamDeformRequest").FromString(request) for request in requests)


@contextlib.contextmanager
def serving(folder, **answers):
    """The address of a server with these methods."""
    address = f"unix:{folder}/fake"
    server = grpc.server(concurrent.futures.ThreadPoolExecutor(16), [_Methods(answers)],
                         options=[("grpc.max_receive_message_length", -1),
                                  ("grpc.max_send_message_length", -1)])
    assert server.add_insecure_port(address)
    server.start()
    try:
        yield address
    finally:
        server.stop(0).wait()


def shape(vertices=3, **fields):
    """A good shape, with other fields where they are given."""
    made = message("Shape")(sequence=1)
    made.positions = b"\0" * 8 * vertices
    for name, value in fields.items():
        field = getattr(made, name)
        if hasattr(field, "extend"):
            field.extend(value)
        else:
            setattr(made, name, value)
    return made


def handle_set(*ids, **fields):
    made = message("HandleSetInfo")(handle_set_id="h", mesh_id="m", revision=1, **fields)
    for handle in ids:
        made.handles.add(handle_id=handle)
    return made


def opened(*ids, vertices=()):
    made = message("StreamDeformResponse")()
    made.opened.handle_set.CopyFrom(handle_set(*ids))
    made.opened.vertices.extend(vertices)
    return made


def streamed(**fields):
    """A message of a stream with a shape."""
    made = message("StreamDeformResponse")()
    made.shape.CopyFrom(shape(**fields))
    return made
