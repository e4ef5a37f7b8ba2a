"""The files that deploy the cluster: addresses and names agree, and Redis takes its options."""

from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import kubernetes_validate
import pytest
import redis

from service.cluster.celery_app import QUEUE
from tests.helpers.deploy_files import (
    AUTOSCALING,
    CLUSTER,
    CLUSTER_COMPOSE,
    containers_of,
    our_pods,
    our_services,
)
from tests.helpers.redis_server import redis_server

PASSWORD = "0f1e"


def redis_urls() -> dict[str, str]:
    pods = {
        name: variable["value"]
        for name, pod in our_pods().items()
        for container in containers_of(pod)
        for variable in container.get("env", [])
        if variable["name"] == "PARETOUR_REDIS_URL"
    }
    services = {
        name: service["environment"]["PARETOUR_REDIS_URL"]
        for name, service in our_services().items()
        if name.startswith(CLUSTER_COMPOSE.name)
    }
    return pods | services


def test_replicas_and_workers_share_one_redis() -> None:
    assert len(redis_urls()) == 4
    [service] = [each for name, each in CLUSTER.named("Service").items() if name.endswith("redis")]
    [port] = service["spec"]["ports"]
    for name, url in redis_urls().items():
        parts = urlsplit(url)
        if name.startswith(CLUSTER.name):
            assert (parts.hostname, parts.port) == (service["metadata"]["name"], port["port"])
            assert parts.password == "$(REDIS_PASSWORD)"
        else:
            assert parts.hostname in CLUSTER_COMPOSE.services
        assert parts.path == "/0"


def test_redis_is_where_nobody_else_comes() -> None:
    services, networks = CLUSTER_COMPOSE.services, CLUSTER_COMPOSE.document["networks"]
    assert networks["inside"]["internal"] is True
    assert services["redis"]["networks"] == ["inside"]
    assert "ports" not in services["redis"]
    assert all("inside" in services[name]["networks"] for name in ("paretour", "worker"))


def test_workers_are_scaled_by_the_messages_that_wait() -> None:
    """KEDA's own objects are beyond the tool that knows those of Kubernetes."""
    [scaled] = AUTOSCALING.named("ScaledObject").values()
    target = scaled["spec"]["scaleTargetRef"]["name"]
    assert "replicas" not in CLUSTER.named("Deployment")[target]["spec"]
    [trigger] = scaled["spec"]["triggers"]
    assert (trigger["type"], trigger["metadata"]["listName"]) == ("redis", QUEUE)
    host, _, port = trigger["metadata"]["address"].partition(":")
    service = CLUSTER.named("Service")[host.partition(".")[0]]
    assert int(port) == service["spec"]["ports"][0]["port"]
    access = AUTOSCALING.named("TriggerAuthentication")[trigger["authenticationRef"]["name"]]
    [secret] = access["spec"]["secretTargetRef"]
    [redis_pod] = CLUSTER.pods["paretour-redis"]["spec"]["containers"]
    sources = [each.get("valueFrom", {}).get("secretKeyRef") for each in redis_pod["env"]]
    assert {"name": secret["name"], "key": secret["key"]} in sources
    [policy] = AUTOSCALING.named("NetworkPolicy").values()
    kubernetes_validate.validate(policy, kubernetes_validate.latest_version(), strict=True)
    assert policy["spec"]["podSelector"] == service_pods("paretour-redis")


def service_pods(name: str) -> dict[str, Any]:
    return {"matchLabels": CLUSTER.named("Service")[name]["spec"]["selector"]}


def test_redis_is_reached_by_replicas_and_workers_alone() -> None:
    spec = CLUSTER.named("NetworkPolicy")["paretour-redis"]["spec"]
    assert spec["podSelector"] == service_pods("paretour-redis")
    [rule] = spec["ingress"]
    [source] = rule["from"]
    [expression] = source["podSelector"]["matchExpressions"]
    names = {pod["metadata"]["labels"][expression["key"]] for pod in CLUSTER.pods.values()}
    assert set(expression["values"]) == names - {"paretour-redis"}
    assert rule["ports"] == [{"protocol": "TCP", "port": "redis"}]


def test_nobody_calls_a_worker() -> None:
    spec = CLUSTER.named("NetworkPolicy")["paretour-worker"]["spec"]
    assert spec["policyTypes"] == ["Ingress"]
    assert "ingress" not in spec


def redis_commands() -> dict[str, list[str]]:
    [container] = CLUSTER.pods["paretour-redis"]["spec"]["containers"]
    services = CLUSTER_COMPOSE.services
    return {"kubernetes": container["command"], "compose": services["redis"]["command"]}


@pytest.mark.parametrize("command", redis_commands().values(), ids=redis_commands())
def test_redis_keeps_everything_and_drops_nothing(command: list[str], tmp_path: Path) -> None:
    given = [each.replace("$(REDIS_PASSWORD)", PASSWORD) for each in command]
    with redis_server(tmp_path, given) as server:
        password = PASSWORD if PASSWORD in given else None
        connection = redis.Redis.from_url(server.url, password=password, decode_responses=True)
        found: dict[str, Any] = connection.config_get("*")
        connection.close()
    assert (found["appendonly"], found["maxmemory-policy"]) == ("yes", "noeviction")
    assert int(found["maxmemory"]) == 2**30
    assert found["save"] == ""
    assert (tmp_path / "appendonlydir").is_dir()
