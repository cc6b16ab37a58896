"""The messages of the package do not meet those of others in protobuf's default pool."""

import os
import pathlib
import subprocess
import sys

import pytest

import arapd
from support import PATIENCE

# What googleapis-common-protos does when it is imported, and what another generated client would do:
# files of the same names in the default pool, here with other content, which protobuf does not stand.
OTHERS = '''
from google.protobuf import descriptor_pb2, descriptor_pool, symbol_database
pool = descriptor_pool.Default()
for name, package, message in (("google/rpc/status.proto", "google.rpc", "Status"),
                               ("google/rpc/error_details.proto", "google.rpc", "ErrorInfo"),
                               ("arap/v1/deformation_service.proto", "arap.v1", "Shape")):
    file = descriptor_pb2.FileDescriptorProto(name=name, package=package, syntax="proto3")
    file.message_type.add(name=message).field.add(name="other", number=77, type=9, label=1)
    pool.AddSerializedFile(file.SerializeToString())
assert pool.FindMessageTypeByName("google.rpc.Status").fields_by_name["other"].number == 77
'''
# The package itself, where it is installed.
GOOGLEAPIS = '''
try:
    from google.rpc import status_pb2, error_details_pb2
    error_details_pb2.ErrorInfo(reason="X")
except ImportError:
    pass
'''
OURS = '''
import arapd
from arapd import faults
status = faults._Status(code=5, message="Nothing.")
status.details.add().Pack(faults._ErrorInfo(reason="NOT_FOUND", metadata={"elements": "3,4"}))
error = faults.of_status(status)
assert (error.reason, error.elements) == (arapd.Reason.NOT_FOUND, (3, 4))
'''


@pytest.mark.parametrize("others", [OTHERS, GOOGLEAPIS], ids=["clashing", "googleapis"])
@pytest.mark.parametrize("first", [True, False], ids=["others_first", "ours_first"])
@pytest.mark.parametrize("implementation", ["cpp", "python"])
def test_both_orders(others, first, implementation):
    program = others + OURS if first else OURS + others + OURS
    package = str(pathlib.Path(arapd.__file__).parents[1])
    ran = subprocess.run(
        [sys.executable, "-B", "-c", program], text=True, capture_output=True, timeout=PATIENCE,
        env={**os.environ, "PYTHONPATH": package,
             "PROTOCOL_BUFFERS_PYTHON_IMPLEMENTATION": implementation})
    assert ran.returncode == 0, ran.stderr
