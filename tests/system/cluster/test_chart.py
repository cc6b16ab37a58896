"""docker/helm: what the chart renders to is what Kubernetes' schemas say, and what arapd and haproxy take. Rendered by
render_chart.go, which stands in for helm; needs what script/setup --lint installs."""

import functools
import json
import os
import pathlib
import shutil
import subprocess

import pytest
import yaml

ROOT = pathlib.Path(__file__).resolve().parents[3]
CHART = ROOT / "docker/helm"
TSC = ROOT / "web/client/node_modules/typescript/bin/tsc"
GOCODE = pathlib.Path("/usr/share/gocode")

PLAIN = "redis: {url: 'redis://redis.example:6380'}"
EVERYTHING = """
redis: {url: 'redis://redis.example', passwordSecret: redis}
identity: {tokensSecret: tokens}
haproxy: {tlsSecret: tls, serviceType: LoadBalancer}
autoscaling: {enabled: true, queueLength: 5, openStreams: 100}
blobs: {storageClass: shared}
flags: ['--workers', '4']
networkPolicy: {clients: [{namespaceSelector: {matchLabels: {team: art}}}], monitoring: [{namespaceSelector: {}}]}
"""
BUNDLED = "{redis: {bundled: true, storageClass: fast}, blobs: {existingClaim: mine}, networkPolicy: {enabled: false}}"

pytestmark = pytest.mark.skipif(
    shutil.which("go") is None or not (GOCODE / "src/sigs.k8s.io/yaml").is_dir(),
    reason="Go and its packages are not installed (script/setup --lint)")


@functools.cache
def renderer():
    program = ROOT / "build/render_chart"
    program.parent.mkdir(exist_ok=True)
    done = subprocess.run(["go", "build", "-o", program, pathlib.Path(__file__).with_name("render_chart.go")], capture_output=True,
                          text=True, env={**os.environ, "GO111MODULE": "off", "GOPATH": str(GOCODE), "GOFLAGS": "",
                                          "GOCACHE": str(ROOT / "build/go")})
    assert done.returncode == 0, done.stderr
    return program


def run(tmp_path, values):
    (tmp_path / "values.yaml").write_text(values)
    return subprocess.run([renderer(), CHART, tmp_path / "values.yaml"], capture_output=True, text=True)


def render(tmp_path, values):
    done = run(tmp_path, values)
    assert done.returncode == 0, done.stderr
    return [document for document in yaml.safe_load_all(done.stdout) if document]


def find(documents, kind, name):
    return next(document for document in documents if document["kind"] == kind and document["metadata"]["name"] == name)


@pytest.mark.parametrize("values", [PLAIN, EVERYTHING, BUNDLED], ids=["plain", "everything", "bundled"])
def test_the_schemas_of_kubernetes_are_met(tmp_path, values):
    """As types: TypeScript refuses what is missing, of another type, and not known."""
    if not (ROOT / "node_modules/kubernetes-models").is_dir() or not TSC.is_file():
        pytest.skip("kubernetes-models or TypeScript is not installed (script/setup --lint)")
    documents = render(tmp_path, values)
    # Beside the packages, where the compiler looks for them.
    source = ROOT / f"build/chart-{tmp_path.name}.ts"
    source.write_text("\n".join(
        f'import type {{ I{document["kind"]} as Kind{i} }} from "kubernetes-models/{document["apiVersion"]}";\n'
        f"export const document{i}: Kind{i} = {json.dumps(document, indent=1)};" for i, document in enumerate(documents)))
    done = subprocess.run(["node", TSC, "--noEmit", "--strict", "--skipLibCheck", "--moduleResolution", "node", "--target", "es2020",
                           source], capture_output=True, text=True)
    source.unlink()
    assert done.returncode == 0, done.stdout


@pytest.mark.parametrize("values", [PLAIN, EVERYTHING, BUNDLED], ids=["plain", "everything", "bundled"])
def test_arapd_and_haproxy_take_what_they_are_given(tmp_path, values):
    documents = render(tmp_path, values)
    container = find(documents, "Deployment", "shapes")["spec"]["template"]["spec"]["containers"][0]
    subprocess.run([os.environ["ARAPCTL"], "token", "add", "--file", tmp_path / "tokens.json", "--owner", "alice"], check=True,
                   capture_output=True)
    (tmp_path / "redis-password").write_text("secret\n")
    for old in ("/etc/arapd/tokens", "/etc/arapd/redis", "/var/lib/arapd"):
        container["args"] = [word.replace(old, str(tmp_path)) for word in container["args"]]
    done = subprocess.run([os.environ["ARAPD"], "--check-config", *container["args"]], capture_output=True, text=True,
                          env={**os.environ, "ARAPD_ADMIN": "0.0.0.0:9464"})
    assert done.returncode == 0, done.stderr
    assert find(documents, "ConfigMap", "shapes-haproxy")["data"]["haproxy.cfg"] == (ROOT / "docker/haproxy.cfg").read_text()
    balancer = find(documents, "Deployment", "shapes-haproxy")["spec"]["template"]["spec"]["containers"][0]
    assert balancer["env"][0] == {"name": "ARAPD_ADDRESS", "value": "shapes-servers.studio.svc:50051"}


def test_a_pod_has_the_time_that_a_drain_takes_and_secrets_are_not_for_others(tmp_path):
    spec = find(render(tmp_path, EVERYTHING), "Deployment", "shapes")["spec"]["template"]["spec"]
    args = spec["containers"][0]["args"]
    drain = sum(int(args[args.index(flag) + 1]) for flag in ("--drain-delay", "--drain-seconds"))
    assert spec["terminationGracePeriodSeconds"] >= drain + 5
    assert spec["securityContext"]["fsGroup"] == 10001 and spec["securityContext"]["runAsNonRoot"]
    secrets = [volume["secret"] for volume in spec["volumes"] if "secret" in volume]
    assert [secret["defaultMode"] for secret in secrets] == [0o440, 0o440]


def test_what_does_not_go_together_is_refused(tmp_path):
    assert "redis.url or redis.bundled=true" in run(tmp_path, "{}").stderr
    assert "a Redis of yours" in run(tmp_path, "redis: {bundled: true, passwordSecret: secret}").stderr
