"""The messages of the wire, as this package sees them.

They live in a pool of their own, so that nothing here meets what another package has put under the
same names into the default one (googleapis-common-protos: google.rpc.Status and its details).

Every packed run of floating-point numbers is declared `bytes` here. On the wire the two are the
same; read as bytes, a shape of 5,041 vertices costs one copy instead of a Python object for each
coordinate. numbers() and packed() turn such bytes into arrays and back.
"""

from __future__ import annotations

import functools
import importlib.resources
from typing import Any

import numpy as np
from numpy.typing import NDArray
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory

_Field = descriptor_pb2.FieldDescriptorProto
_RUNS: dict[int, np.dtype[Any]] = {_Field.TYPE_FLOAT: np.dtype("<f4"),
                                   _Field.TYPE_DOUBLE: np.dtype("<f8")}
_runs: dict[tuple[str, str], np.dtype[Any]] = {}


def _runs_as_bytes(message: Any, full_name: str) -> None:
    for field in message.field:
        if field.label == _Field.LABEL_REPEATED and field.type in _RUNS:
            _runs[full_name, field.name] = _RUNS[field.type]
            field.label, field.type = _Field.LABEL_OPTIONAL, _Field.TYPE_BYTES
    for nested in message.nested_type:
        _runs_as_bytes(nested, f"{full_name}.{nested.name}")


def _load() -> descriptor_pool.DescriptorPool:
    resource = importlib.resources.files(__package__).joinpath("wire.binpb")
    try:
        description = resource.read_bytes()
    except FileNotFoundError:
        raise ImportError("arapd/wire.binpb is missing: install the package with pip, which makes "
                          "it, or run `setup.py build_py`.") from None
    pool = descriptor_pool.DescriptorPool()
    for file in descriptor_pb2.FileDescriptorSet.FromString(description).file:
        for message in file.message_type:
            _runs_as_bytes(message, f"{file.package}.{message.name}")
        pool.AddSerializedFile(file.SerializeToString())
    return pool


_pool = _load()
_factory = message_factory.MessageFactory(_pool)


@functools.cache
def message(name: str) -> Any:
    """The class of a message: "arap.v1.Shape", or of arap.v1 without the package."""
    full_name = name if name.startswith("google.") else f"arap.v1.{name}"
    descriptor = _pool.FindMessageTypeByName(full_name)
    if hasattr(message_factory, "GetMessageClass"):  # protobuf 4 and later
        return message_factory.GetMessageClass(descriptor)
    return _factory.GetPrototype(descriptor)


def serialized(message_: Any) -> bytes:
    data: bytes = message_.SerializeToString()
    return data


def enum_names(name: str) -> dict[str, int]:
    """The values of an enumeration of arap.v1 by their names."""
    descriptor = _pool.FindEnumTypeByName(f"arap.v1.{name}")
    return {value.name: value.number for value in descriptor.values}


def numbers(message_: Any, field: str) -> NDArray[Any]:
    """A run of numbers, as a read-only array on the bytes of the message; nothing is copied.

    ValueError when the bytes are no whole number of them."""
    return np.frombuffer(getattr(message_, field), _runs[message_.DESCRIPTOR.full_name, field])


def packed(values: Any) -> bytes:
    """Numbers as a run of doubles."""
    return np.ascontiguousarray(values, "<f8").tobytes()


def has_field(message_class: Any, field: str) -> bool:
    return field in message_class.DESCRIPTOR.fields_by_name
