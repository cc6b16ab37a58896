"""docker/compose.yaml, without an engine: its files are there, its commands are ones that the programs take, and what is said
to be for this machine alone is. Where Debian's docker-compose is installed it judges the files too."""

import os
import pathlib
import shutil
import subprocess

import pytest
import yaml

DOCKER = pathlib.Path(__file__).resolve().parents[3] / "docker"
ARAPD = os.environ["ARAPD"]
OVERLAYS = [["compose.yaml"], ["compose.yaml", "compose.secure.yaml"]]


def load(name):
    return yaml.safe_load((DOCKER / name).read_text())


def services():
    """Every service with its file, as far as that file says."""
    return [(name, service) for file in ("compose.yaml", "compose.secure.yaml")
            for name, service in load(file)["services"].items()]


@pytest.mark.parametrize("files", OVERLAYS, ids="+".join)
def test_compose_takes_the_files(files):
    compose = shutil.which("docker-compose")
    if compose is None:
        pytest.skip("docker-compose is not installed (script/setup)")
    words = [word for file in files for word in ("-f", str(DOCKER / file))]
    for profile in ([], ["--profile", "watch"]):
        done = subprocess.run([compose, *words, *profile, "config", "-q"], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr


def test_what_is_mounted_or_built_is_there():
    for _, service in services():
        for volume in service.get("volumes", []):
            source = volume.partition(":")[0]
            assert source in load("compose.yaml")["volumes"] or (DOCKER / source).is_file(), volume
        if "build" in service:
            assert (DOCKER / service["build"]["context"] / service["build"]["dockerfile"]).is_file()


@pytest.mark.parametrize("file", ["compose.yaml", "compose.secure.yaml"])
def test_arapd_takes_its_flags(file, tmp_path):
    token = subprocess.run([os.environ["ARAPCTL"], "token", "add", "--file", tmp_path / "tokens.json", "--owner", "alice"],
                           capture_output=True, text=True)
    assert token.returncode == 0, token.stderr
    (tmp_path / "redis-password").write_text("secret\n")
    (tmp_path / "redis-password").chmod(0o600)
    words = [word.replace("/run/secrets", str(tmp_path)).replace("/var/lib/arapd", str(tmp_path))
             for word in load(file)["services"]["arapd"]["command"]]
    done = subprocess.run([ARAPD, "--check-config", *words], capture_output=True, text=True,
                          env={**os.environ, "ARAPD_ADMIN": "0.0.0.0:9464", "STATE_DIRECTORY": str(tmp_path)})
    assert done.returncode == 0, done.stderr


def test_redis_keeps_everything():
    for file in ("compose.yaml", "compose.secure.yaml"):
        command = " ".join(load(file)["services"]["redis"]["command"])
        assert "--appendonly yes --appendfsync always --maxmemory-policy noeviction" in command
    assert "records:/data" in load("compose.yaml")["services"]["redis"]["volumes"]


def test_nothing_can_be_written_to_and_no_port_is_for_other_machines():
    for name, service in load("compose.yaml")["services"].items():
        assert service["read_only"] and service["cap_drop"] == ["ALL"], name
        assert all(port.startswith("127.0.0.1:") for port in service.get("ports", [])), name
    # The admin page asks nobody who they are.
    assert "ports" not in load("compose.yaml")["services"]["arapd"]


def test_haproxy_finds_the_service_of_the_servers():
    done = subprocess.run(["haproxy", "-c", "-f", DOCKER / "haproxy.cfg"], capture_output=True, text=True,
                          env={"PATH": "/usr/sbin:/usr/bin"})
    assert done.returncode == 0, done.stderr
    text = (DOCKER / "haproxy.cfg").read_text()
    assert '"${ARAPD_ADDRESS-arapd:50051}"' in text and "arapd" in load("compose.yaml")["services"]
    # script/cluster has as many places as the file.
    assert "server-template s 1-16 " in text
    assert "MOST_SERVERS = 16 " in (DOCKER.parent / "script/cluster").read_text()
    assert "EXPOSE 50051 9464" in (DOCKER / "Dockerfile").read_text()


def test_with_a_certificate_haproxy_takes_tls_alone(tmp_path):
    """What compose.secure.yaml puts into ARAP_BIND is several words."""
    made = subprocess.run(["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-subj", "/CN=haproxy", "-days", "2", "-keyout",
                           tmp_path / "key", "-out", tmp_path / "crt"], capture_output=True, text=True)
    assert made.returncode == 0, made.stderr
    (tmp_path / "tls.pem").write_text((tmp_path / "crt").read_text() + (tmp_path / "key").read_text())
    bind = load("compose.secure.yaml")["services"]["haproxy"]["environment"]["ARAP_BIND"]
    done = subprocess.run(["haproxy", "-c", "-V", "-f", DOCKER / "haproxy.cfg"], capture_output=True, text=True,
                          env={"PATH": "/usr/sbin:/usr/bin", "ARAP_BIND": bind.replace("/run/secrets", str(tmp_path))})
    assert done.returncode == 0, done.stderr
    done = subprocess.run(["haproxy", "-c", "-f", DOCKER / "haproxy.cfg"], capture_output=True, text=True,
                          env={"PATH": "/usr/sbin:/usr/bin", "ARAP_BIND": bind.replace("/run/secrets", "/nowhere")})
    assert done.returncode != 0, "the certificate is not looked at"


@pytest.mark.parametrize("file", ["prometheus.yaml", "alerts.yaml", "grafana-sources.yaml", "grafana-folders.yaml"])
def test_what_watches_can_be_read(file):
    assert isinstance(load(file), dict)
    assert "arapd" in (DOCKER / file).read_text() or file == "grafana-sources.yaml"
