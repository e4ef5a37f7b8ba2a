"""The files that deploy: valid to their own tools, and in agreement with image and settings."""

import re
from pathlib import Path
from typing import Any

import kubernetes_validate
import pytest
import yaml
from compose_spec import PyCompose

from service.settings import Settings

ROOT = Path(__file__).parent.parent
DEPLOY = ROOT / "service/deploy"
COMPOSE_TEXT = (DEPLOY / "compose.yaml").read_text()
COMPOSE = yaml.safe_load(COMPOSE_TEXT)
OBJECTS = list(yaml.safe_load_all((DEPLOY / "kubernetes.yaml").read_text()))
PODS = {
    each["metadata"]["name"]: each["spec"]["template"]
    for each in OBJECTS
    if "template" in each.get("spec", {})
}
OWN = {"paretour"}
IMAGE = (ROOT / "Dockerfile").read_text()
USER = re.search(r"^USER (\d+):(\d+)", IMAGE, re.MULTILINE)
CACHE = re.search(r"^VOLUME (\S+)", IMAGE, re.MULTILINE)


def named(kind: str) -> dict[str, dict[str, Any]]:
    return {each["metadata"]["name"]: each for each in OBJECTS if each["kind"] == kind}


def containers() -> dict[str, dict[str, Any]]:
    return {
        f"{pod}: {container['name']}": container
        for pod, template in PODS.items()
        for part in ("initContainers", "containers")
        for container in template["spec"].get(part, [])
    }


@pytest.mark.parametrize(
    "each", OBJECTS, ids=lambda each: f"{each['kind']} {each['metadata']['name']}"
)
def test_kubernetes_knows_every_field(each: dict[str, Any]) -> None:
    kubernetes_validate.validate(each, kubernetes_validate.latest_version(), strict=True)


def test_compose_knows_every_field() -> None:
    PyCompose.from_yaml(COMPOSE_TEXT).validate()


@pytest.mark.parametrize("name", PODS)
def test_pods_are_confined(name: str) -> None:
    spec = PODS[name]["spec"]
    assert spec["enableServiceLinks"] is False
    assert spec["automountServiceAccountToken"] is False
    assert spec["securityContext"]["runAsNonRoot"] is True
    assert spec["securityContext"]["seccompProfile"] == {"type": "RuntimeDefault"}


@pytest.mark.parametrize("container", containers().values(), ids=containers())
def test_containers_are_confined_and_bounded(container: dict[str, Any]) -> None:
    context = container["securityContext"]
    assert context["readOnlyRootFilesystem"] is True
    assert context["allowPrivilegeEscalation"] is False
    assert context["capabilities"] == {"drop": ["ALL"]}
    assert {"cpu", "memory"} <= set(container["resources"]["limits"])
    assert {"cpu", "memory"} <= set(container["resources"]["requests"])


@pytest.mark.parametrize("service", COMPOSE["services"].values(), ids=COMPOSE["services"])
def test_services_of_compose_are_confined_and_bounded(service: dict[str, Any]) -> None:
    assert service["read_only"] is True
    assert service["cap_drop"] == ["ALL"]
    assert service["security_opt"] == ["no-new-privileges:true"]
    assert {"cpus", "memory", "pids"} <= set(service["deploy"]["resources"]["limits"])
    for published in service.get("ports", []):
        assert published.startswith("127.0.0.1:")


def test_pods_run_as_the_user_of_the_image_and_write_where_it_may() -> None:
    assert USER is not None
    assert CACHE is not None
    for name in OWN & set(PODS):
        spec = PODS[name]["spec"]
        context = spec["securityContext"]
        assert (str(context["runAsUser"]), str(context["fsGroup"])) == USER.groups()
        for container in spec["containers"]:
            mounted = {mount["mountPath"]: mount["name"] for mount in container["volumeMounts"]}
            volumes = {volume["name"] for volume in spec["volumes"]}
            assert set(mounted.values()) <= volumes
            assert CACHE[1] in mounted
        [compiled] = [each for each in spec["initContainers"] if each["name"] == "compiled"]
        assert f"{CACHE[1]}/." in compiled["command"]


def test_every_variable_is_a_setting_that_takes_its_value(monkeypatch: pytest.MonkeyPatch) -> None:
    kubernetes = [
        (each["name"], each["value"])
        for container in containers().values()
        for each in container.get("env", [])
        if "value" in each
    ]
    compose = [
        (name, value)
        for service in COMPOSE["services"].values()
        for name, value in service.get("environment", {}).items()
        if not value.startswith("${")
    ]
    for name, value in (*kubernetes, *compose):
        assert name.removeprefix("PARETOUR_").lower() in Settings.model_fields
        monkeypatch.setenv(name, value)
        Settings()


def test_there_is_time_to_drain() -> None:
    drain = Settings().drain_seconds
    for name in OWN & set(PODS):
        spec = PODS[name]["spec"]
        [container] = spec["containers"]
        waited = container["lifecycle"]["preStop"]["sleep"]["seconds"]
        assert spec["terminationGracePeriodSeconds"] > waited + drain
    for name in OWN & set(COMPOSE["services"]):
        assert int(COMPOSE["services"][name]["stop_grace_period"].removesuffix("s")) > drain


def test_probes_ask_for_paths_that_there_are_where_the_service_listens() -> None:
    for name in OWN & set(PODS):
        [container] = PODS[name]["spec"]["containers"]
        [port] = container["ports"]
        assert f"EXPOSE {port['containerPort']}" in IMAGE
        for probe, path in (("startup", "live"), ("liveness", "live"), ("readiness", "ready")):
            asked = container[f"{probe}Probe"]["httpGet"]
            assert asked == {"path": f"/health/{path}", "port": port["name"]}


def test_services_find_their_pods_and_ports() -> None:
    for service in named("Service").values():
        [labels] = [
            each["metadata"]["labels"]
            for each in PODS.values()
            if service["spec"]["selector"].items() <= each["metadata"]["labels"].items()
        ]
        ports = {
            port["name"]
            for each in PODS.values()
            if each["metadata"]["labels"] == labels
            for container in each["spec"]["containers"]
            for port in container["ports"]
        }
        assert {port["targetPort"] for port in service["spec"]["ports"]} <= ports
