"""What the tests of the Python package share: a real arapd in a process of its own, meshes, and waits
that say what they waited for."""

import os
import pathlib
import re
import signal
import subprocess
import threading
import time

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
ARAPD = os.environ.get("ARAPD", str(ROOT / "build/dev/bin/arapd"))
ARAPCTL = os.environ.get("ARAPCTL", str(ROOT / "build/dev/bin/arapctl"))
PATIENCE = 120.0  # seconds; nothing that works takes so long


def wait_until(true, what):
    """Polls `true()` until it is."""
    end = time.monotonic() + PATIENCE
    while not true():
        assert time.monotonic() < end, f"waited {PATIENCE:g} s for {what}"
        time.sleep(0.005)


class Server:
    """arapd on a unix socket in `folder`, with its sessions there too, so that it may be started
    again; or where `listen` says."""

    def __init__(self, folder, *flags, listen=None):
        self.address = listen or f"unix:{folder}/socket"
        self._command = [ARAPD, "--listen", self.address, "--store", f"sqlite:{folder}/state",
                         "--no-admin", "--access-log", "off", *flags]
        self._process = None
        self._lines = []

    def start(self):
        self._lines = []
        self._process = subprocess.Popen(self._command, stdout=subprocess.PIPE,
                                         stderr=subprocess.STDOUT, text=True)
        threading.Thread(target=self._read, args=(self._process,), daemon=True).start()
        wait_until(lambda: any("listening on" in line for line in self._lines)
                   or self._process.poll() is not None, "arapd to listen")
        assert self._process.poll() is None, "".join(self._lines)
        if self.address.endswith(":0"):  # any free port: it says which
            self.address = re.search(r"listening on (\S+:[0-9]+)", "".join(self._lines))[1]
        return self

    def _read(self, process):
        for line in process.stdout:
            self._lines.append(line)

    def signal(self, number):
        self._process.send_signal(number)

    def freeze(self):
        """Every thread of it has stopped."""
        self.signal(signal.SIGSTOP)
        os.waitid(os.P_PID, self._process.pid, os.WSTOPPED)

    def thaw(self):
        self.signal(signal.SIGCONT)

    def wait(self):
        return self._process.wait(PATIENCE)

    def kill(self):
        if self._process is not None and self._process.poll() is None:
            self.signal(signal.SIGKILL)
            self.wait()

    __enter__ = start

    def __exit__(self, *_):
        self.kill()


def grid(columns=9, rows=9):
    """Vertices and triangles of a grid with unit squares."""
    x, y = np.meshgrid(np.arange(columns), np.arange(rows))
    vertices = np.stack([x.ravel(), y.ravel()], axis=1).astype(float)
    at = np.arange(columns * rows).reshape(rows, columns)
    a, b, c, d = (part.ravel() for part in (at[:-1, :-1], at[:-1, 1:], at[1:, 1:], at[1:, :-1]))
    return vertices, np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])


def bent(columns=9, rows=9):
    """A grid as a piece of a cylinder, which flattens without distortion."""
    vertices, triangles = grid(columns, rows)
    angle = vertices[:, 0] / 8
    return np.stack([8 * np.sin(angle), vertices[:, 1], 8 * np.cos(angle)], axis=1), triangles
