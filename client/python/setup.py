"""Puts the description of the wire into the package: arapd/wire.binpb, made by protoc from proto/.

The files of proto/ have one home, the repository. A wheel and an sdist carry the description that
was made of them; an sdist is installed without protoc.
"""

import os
import pathlib
import subprocess

from setuptools import setup
from setuptools.command.build_py import build_py
from setuptools.command.sdist import sdist

HERE = pathlib.Path(__file__).resolve().parent
PROTO = HERE.parent.parent / "proto"
DESCRIPTION = pathlib.Path("arapd", "wire.binpb")


def make_description(folder):
    """Writes the description below `folder`. In an sdist it is there already."""
    target = pathlib.Path(folder) / DESCRIPTION
    if (HERE / DESCRIPTION).exists():
        return
    if not PROTO.is_dir():
        raise FileNotFoundError(f"Neither {DESCRIPTION} nor {PROTO} is there to make it of.")
    target.parent.mkdir(parents=True, exist_ok=True)
    files = sorted(str(path) for path in PROTO.glob("*/*/*.proto") if path.is_file())
    subprocess.run(
        [os.environ.get("PROTOC", "protoc"), "-I", str(PROTO), "--include_imports",
         f"--descriptor_set_out={target}", *files],
        check=True)


class BuildPy(build_py):
    def run(self):
        super().run()
        if not self.editable_mode:
            make_description(self.build_lib)

    def get_outputs(self, include_bytecode=True):
        made = os.path.join(self.build_lib, DESCRIPTION)
        outputs = super().get_outputs(include_bytecode)
        return outputs if made in outputs else [*outputs, made]


class Sdist(sdist):
    def make_release_tree(self, base_dir, files):
        super().make_release_tree(base_dir, files)
        make_description(base_dir)


setup(cmdclass={"build_py": BuildPy, "sdist": Sdist})
