import pytest

import arapd
from support import Server


@pytest.fixture(scope="session")
def server(tmp_path_factory):
    """One arapd for the tests that do not harm it."""
    with Server(tmp_path_factory.mktemp("arapd")) as running:
        yield running


@pytest.fixture
def client(server):
    with arapd.connect(server.address) as connected:
        yield connected


@pytest.fixture
def session(client):
    with client.create_session() as created:
        yield created
