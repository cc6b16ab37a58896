"""script/cluster: starts, does as it is told, and leaves nothing behind. With the real haproxy and Redis."""

import os
import pathlib
import re
import signal
import subprocess
import time

import pytest

SCRIPT = str(pathlib.Path(__file__).resolve().parents[3] / "script/cluster")
ARAPCTL = os.environ["ARAPCTL"]
PATIENCE = 120


@pytest.fixture
def env():
    # Not in tmp_path, which may be too long for the path of a socket.
    folder = pathlib.Path(f"/tmp/arap-cluster-test-{os.getpid()}-{time.monotonic_ns()}")
    yield {**os.environ, "ARAP_CLUSTER": str(folder)}
    assert not folder.exists(), "something was left behind"


def ask(env, *words, code=0):
    done = subprocess.run([SCRIPT, *words], env=env, capture_output=True, text=True, timeout=PATIENCE)
    assert done.returncode == code, done.stdout + done.stderr
    return done.stdout + done.stderr


def start(env, *words):
    """The script, ready to serve, and the address of the balancer."""
    process = subprocess.Popen([SCRIPT, *words], env=env, stdout=subprocess.PIPE, text=True)
    line = process.stdout.readline()
    assert line.startswith("cluster at 127.0.0.1:"), line
    return process, line.split()[-1]


def pids(env):
    return [int(pid) for pid in re.findall(r"pid (\d+)", ask(env, "status"))]


def alive(pid):
    try:
        return pathlib.Path(f"/proc/{pid}/stat").read_text().rpartition(") ")[2][0] not in "ZX"
    except OSError:
        return False


def eventually(condition):
    deadline = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.02)


def test_run_takes_a_command_to_the_balancer_and_its_exit_code_back(env):
    assert "version" in ask(env, "2", "--run", ARAPCTL, "info")
    assert "127.0.0.1:" in ask(env, "1", "--run", "sh", "-c", "echo $ARAPCTL_SERVER; exit 5", code=5)
    ask(env, "1", "--run", "sh", "-c", "kill -9 $$", code=137)


def test_members_end_and_come_back(env):
    process, address = start(env, "2")
    assert ask(env, "kill", "1") == "1 ended with -9\n"
    assert "it has ended with -9" in ask(env, "freeze", "1", code=1)
    assert ask(env, "start", "1") == "1 runs\n"
    assert "runs already" in ask(env, "start", "1", code=1)
    assert ask(env, "freeze", "2") == "2 frozen\n"
    eventually(lambda: re.search(r"2 .* haproxy: down", ask(env, "status")))
    assert ask(env, "thaw", "2") == "2 runs\n"
    assert ask(env, "add").startswith("3 serves on 127.0.0.1:")
    assert ask(env, "drain", "3") == "3 ended with 0\n"
    for member in ("redis", "haproxy"):
        assert ask(env, "kill", member) == f"{member} ended with -9\n"
        assert ask(env, "start", member) == f"{member} runs\n"
    eventually(lambda: re.search(r"2 .* readyz 200, haproxy: up", ask(env, "status")))
    assert "version" in subprocess.run(
        [ARAPCTL, "info", "--server", address], capture_output=True, text=True, timeout=PATIENCE).stdout
    assert "there is no member 9" in ask(env, "kill", "9", code=1)
    assert "usage" in ask(env, "kill", code=1)
    everybody = pids(env)
    assert len(everybody) == 5
    assert ask(env, "stop") == "stopped\n"
    assert process.wait(PATIENCE) == 0
    assert not any(alive(pid) for pid in everybody)


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT, signal.SIGHUP])
def test_a_signal_ends_everything(env, number):
    process, _ = start(env, "2")
    everybody = pids(env)
    ask(env, "freeze", "1")
    process.send_signal(number)
    assert process.wait(PATIENCE) == 0
    assert not any(alive(pid) for pid in everybody)


def test_when_the_script_is_killed_nobody_is_left(env):
    process, _ = start(env, "2")
    everybody = pids(env)
    ask(env, "freeze", "1")
    process.kill()
    process.wait(PATIENCE)
    eventually(lambda: not any(alive(pid) for pid in everybody))
    # The next one takes its place.
    assert "no cluster runs" in ask(env, "status", code=1)
    process, _ = start(env, "1")
    ask(env, "stop")
    assert process.wait(PATIENCE) == 0


def test_there_is_one_cluster_in_a_folder(env):
    process, _ = start(env, "1")
    assert "runs in" in ask(env, "1", code=1)
    ask(env, "stop")
    process.wait(PATIENCE)


def test_what_is_wrong_is_said(env):
    assert "N is 1 to 16" in ask(env, "17", code=1)
    assert "there is no server at /nowhere" in ask({**env, "ARAPD": "/nowhere"}, "1", code=1)
    assert "1 does not get ready" in ask({**env, "ARAPD": "/bin/false"}, "1", code=1)
    assert "no-such-flag" in ask(env, "1", "--flag=--no-such-flag", code=1)
    folder = pathlib.Path(env["ARAP_CLUSTER"])
    folder.mkdir()
    assert "not of a cluster" in ask(env, "1", code=1)
    folder.rmdir()
