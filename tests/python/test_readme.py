"""The examples of the pages are programs that run."""

import os
import pathlib
import re
import subprocess
import sys

import pytest

import arapd
from support import PATIENCE, ROOT


@pytest.mark.parametrize("page", ["README.md", "client/python/README.md"])
def test_the_example_runs(server, page):
    text = (ROOT / page).read_text()
    examples = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    assert len(examples) == 1
    assert '"localhost:50051"' in examples[0]
    program = examples[0].replace("localhost:50051", server.address)
    package = str(pathlib.Path(arapd.__file__).parents[1])
    ran = subprocess.run([sys.executable, "-B", "-c", program], text=True, timeout=PATIENCE,
                         capture_output=True, env={**os.environ, "PYTHONPATH": package})
    assert ran.returncode == 0, ran.stderr
    assert ran.stdout.count("[") == 1, ran.stdout
