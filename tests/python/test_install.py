"""pip installs the package without a network, from the repository and from an sdist without protoc."""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import tarfile
import tomllib

import pytest

from support import ROOT

PROGRAM = """
import sys, arapd, arapd.aio
assert arapd.__file__.startswith(sys.prefix), arapd.__file__
with arapd.connect(sys.argv[1]) as client:
    client.server_info()
"""


def run(*command, **environment):
    inherited = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    ran = subprocess.run([str(part) for part in command], text=True, capture_output=True, timeout=300,
                         env={**inherited, **environment})
    assert ran.returncode == 0, ran.stdout + ran.stderr
    return ran.stdout


@pytest.fixture(scope="module")
def tree(tmp_path_factory):
    """What pip writes beside the sources must not land in the repository."""
    copy = tmp_path_factory.mktemp("tree")
    ignored = shutil.ignore_patterns("__pycache__", "build", "*.egg-info")
    shutil.copytree(ROOT / "client/python", copy / "client/python", ignore=ignored)
    shutil.copytree(ROOT / "proto", copy / "proto")
    return copy / "client/python"


def install(what, folder, address, **environment):
    """Installs it into a scratch environment and talks to a server from there."""
    run(sys.executable, "-m", "venv", "--system-site-packages", folder)
    run(folder / "bin/pip", "install", "--no-index", "--no-build-isolation", what, **environment)
    run(folder / "bin/python", "-c", PROGRAM, address)
    [description] = folder.glob("lib/*/site-packages/arapd/wire.binpb")
    return description.read_bytes()


def test_pip_installs_the_tree_and_an_sdist(server, tree, tmp_path):
    of_tree = install(tree, tmp_path / "tree", server.address)
    run(sys.executable, "-c",
        "import setuptools.build_meta as b, sys, os; os.chdir(sys.argv[1]); "
        "b.build_sdist(sys.argv[2])", tree, tmp_path)
    [sdist] = tmp_path.glob("*.tar.gz")
    with tarfile.open(sdist) as archive:
        names = {str(pathlib.Path(*pathlib.Path(name).parts[1:])) for name in archive.getnames()}
    assert {"arapd/wire.binpb", "arapd/__init__.py", "pyproject.toml", "setup.py"} <= names
    of_sdist = install(sdist, tmp_path / "sdist", server.address, PROTOC="/nowhere/protoc")
    assert of_sdist == of_tree
    assert not (tree / "arapd/wire.binpb").exists()


def test_the_version_is_that_of_the_project():
    project = tomllib.loads((ROOT / "client/python/pyproject.toml").read_text())["project"]
    cmake = (ROOT / "CMakeLists.txt").read_text()
    assert re.search(r"project\(arap VERSION ([0-9.]+)", cmake)[1] == project["version"]
