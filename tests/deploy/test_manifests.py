"""The files of service/deploy are valid to Kubernetes and Compose, and fit image and settings."""

from collections.abc import Iterator
from typing import Any

import kubernetes_validate
import pytest
import yaml
from compose_spec import PyCompose

from service.__main__ import main
from service.settings import Settings
from tests.helpers.deploy_files import (
    AUTOSCALING,
    CACHE,
    COMPOSE_FILES,
    DEPLOY,
    IMAGE,
    MANIFESTS,
    ROADS,
    ROADS_COMPOSE,
    USER,
    ComposeFile,
    Manifest,
    all_pods,
    all_services,
    containers_of,
    our_pods,
    our_services,
)

ALIASES = {field.validation_alias for field in Settings.model_fields.values()} - {None}
SETTINGS = ALIASES | {f"PARETOUR_{name.upper()}" for name in Settings.model_fields}
CONTAINERS = {
    f"{name} {container['name']}": container
    for name, pod in all_pods().items()
    for container in containers_of(pod)
}
of_each_manifest = pytest.mark.parametrize("manifest", MANIFESTS, ids=lambda each: each.name)
of_our_pods = pytest.mark.parametrize("pod", our_pods().values(), ids=our_pods())


def test_no_file_is_left_out() -> None:
    tested = {each.name for each in (*MANIFESTS, *COMPOSE_FILES, AUTOSCALING, ROADS)}
    tested.update(
        ("alerts.yaml", "constraints.txt", "dashboard.json", "hatch_build.py", "nginx.conf")
    )
    assert tested == {path.name for path in DEPLOY.iterdir() if path.is_file()}


@pytest.mark.parametrize("manifest", [*MANIFESTS, ROADS], ids=lambda each: each.name)
def test_kubernetes_knows_every_field(manifest: Manifest) -> None:
    for each in manifest.objects:
        kubernetes_validate.validate(each, kubernetes_validate.latest_version(), strict=True)


@pytest.mark.parametrize("compose_file", COMPOSE_FILES, ids=lambda each: each.name)
def test_compose_knows_every_field(compose_file: ComposeFile) -> None:
    PyCompose.from_yaml(yaml.safe_dump(compose_file.document)).validate()


@pytest.mark.parametrize("pod", all_pods().values(), ids=all_pods())
def test_pods_are_confined(pod: dict[str, Any]) -> None:
    spec = pod["spec"]
    assert spec["enableServiceLinks"] is False
    assert spec["automountServiceAccountToken"] is False
    assert spec["securityContext"]["runAsNonRoot"] is True
    assert spec["securityContext"]["seccompProfile"] == {"type": "RuntimeDefault"}


@pytest.mark.parametrize("container", CONTAINERS.values(), ids=CONTAINERS)
def test_containers_are_confined_and_bounded(container: dict[str, Any]) -> None:
    context = container["securityContext"]
    assert context["readOnlyRootFilesystem"] is True
    assert context["allowPrivilegeEscalation"] is False
    assert context["capabilities"] == {"drop": ["ALL"]}
    assert {"cpu", "memory"} <= set(container["resources"]["limits"])
    assert {"cpu", "memory"} <= set(container["resources"]["requests"])


@pytest.mark.parametrize("service", all_services().values(), ids=all_services())
def test_services_of_compose_are_confined_and_bounded(service: dict[str, Any]) -> None:
    assert service["read_only"] is True
    assert service["cap_drop"] == ["ALL"]
    assert service["security_opt"] == ["no-new-privileges:true"]
    assert {"cpus", "memory", "pids"} <= set(service["deploy"]["resources"]["limits"])
    for published in service.get("ports", []):
        where = published if isinstance(published, str) else f"{published['host_ip']}:"
        assert where.startswith("127.0.0.1:")


@of_our_pods
def test_pods_run_as_the_user_of_the_image_and_write_where_it_may(pod: dict[str, Any]) -> None:
    assert USER is not None
    assert CACHE is not None
    spec = pod["spec"]
    context = spec["securityContext"]
    assert (str(context["runAsUser"]), str(context["fsGroup"])) == USER.groups()
    for container in spec["containers"]:
        mounted = {mount["mountPath"]: mount["name"] for mount in container["volumeMounts"]}
        volumes = {volume["name"] for volume in spec["volumes"]}
        assert set(mounted.values()) <= volumes
        assert CACHE[1] in mounted


def variables() -> Iterator[tuple[str, str]]:
    for pod in our_pods().values():
        for container in pod["spec"]["containers"]:
            yield from ((each["name"], each.get("value", "$")) for each in container["env"])
    for service in our_services().values():
        yield from service["environment"].items()


@pytest.mark.parametrize(("name", "value"), sorted(set(variables())))
def test_every_variable_is_a_setting_that_takes_its_value(
    monkeypatch: pytest.MonkeyPatch, name: str, value: str
) -> None:
    if name not in SETTINGS:
        assert any(f"$({name})" in other for _, other in variables())
        return
    if not value.startswith("$"):
        monkeypatch.setenv(name, value)
        Settings()


@pytest.mark.parametrize("file", COMPOSE_FILES, ids=lambda each: each.name)
def test_compose_asks_for_keys_and_for_the_proxy(file: ComposeFile) -> None:
    given = file.services["paretour"]["environment"]
    # Without it Compose starts nothing, and says why.
    assert given["PARETOUR_API_KEYS"].startswith("${PARETOUR_API_KEYS?must be CALLER:HASH")
    assert given["FORWARDED_ALLOW_IPS"] == "${FORWARDED_ALLOW_IPS:-127.0.0.1}"
    assert (DEPLOY / file.name).read_text().startswith("# PARETOUR_API_KEYS= docker compose")


@of_each_manifest
def test_a_manifest_says_which_proxies_are_believed(manifest: Manifest) -> None:
    [container] = manifest.pods["paretour"]["spec"]["containers"]
    given = {each["name"]: each.get("value") for each in container["env"]}
    assert given["FORWARDED_ALLOW_IPS"] == Settings.model_fields["forwarded_allow_ips"].default


@of_our_pods
def test_pods_have_time_to_drain(pod: dict[str, Any]) -> None:
    [container] = pod["spec"]["containers"]
    before = container.get("lifecycle", {}).get("preStop", {}).get("sleep", {}).get("seconds", 0)
    assert pod["spec"]["terminationGracePeriodSeconds"] > before + Settings().drain_seconds


@pytest.mark.parametrize("service", our_services().values(), ids=our_services())
def test_services_of_compose_have_time_to_drain(service: dict[str, Any]) -> None:
    seconds = int(service["stop_grace_period"].removesuffix("s"))
    assert seconds > Settings().drain_seconds


def commands() -> Iterator[list[str]]:
    """Yield the commands that replace the one of the image, and those of probes."""
    for pod in our_pods().values():
        for container in pod["spec"]["containers"]:
            if "command" in container:
                yield container["command"]
            probes = (container.get(f"{each}Probe", {}) for each in ("startup", "liveness"))
            yield from (probe["exec"]["command"] for probe in probes if "exec" in probe)
    for service in our_services().values():
        if "command" in service:
            yield service["command"]
        if "healthcheck" in service:
            yield service["healthcheck"]["test"][1:]


@pytest.mark.parametrize("command", list(commands()), ids=" ".join)
def test_every_command_is_one_that_there_is(command: list[str]) -> None:
    assert command[0] == "paretour"
    with pytest.raises(SystemExit) as ended:
        main([*command[1:], "--help"])
    assert ended.value.code == 0


def test_probes_ask_for_paths_that_there_are_where_the_service_listens() -> None:
    asking = [
        container
        for container in CONTAINERS.values()
        if any(port["name"] == "http" for port in container.get("ports", []))
    ]
    assert len(asking) == len(MANIFESTS)
    for container in asking:
        [port] = container["ports"]
        assert f"EXPOSE {port['containerPort']}" in IMAGE
        for probe, path in (("startup", "live"), ("liveness", "live"), ("readiness", "ready")):
            asked = container[f"{probe}Probe"]["httpGet"]
            assert asked == {"path": f"/health/{path}", "port": port["name"]}


@of_each_manifest
def test_services_find_their_pods_and_ports(manifest: Manifest) -> None:
    for service in manifest.named("Service").values():
        [pod] = selected(manifest, service["spec"]["selector"])
        ports = {
            port["name"] for container in pod["spec"]["containers"] for port in container["ports"]
        }
        assert {port["targetPort"] for port in service["spec"]["ports"]} <= ports


@of_each_manifest
def test_whoever_selects_pods_finds_its_own(manifest: Manifest) -> None:
    for each in manifest.objects:
        if labels := each.get("spec", {}).get("selector", {}).get("matchLabels"):
            [pod] = selected(manifest, labels)
            assert each.get("spec", {}).get("template", pod) == pod


def selected(manifest: Manifest, labels: dict[str, str]) -> list[dict[str, Any]]:
    return [
        pod for pod in manifest.pods.values() if labels.items() <= pod["metadata"]["labels"].items()
    ]


@of_each_manifest
def test_no_pod_is_without_a_policy_of_who_may_call_it(manifest: Manifest) -> None:
    policies = manifest.named("NetworkPolicy").values()
    governed = [selected(manifest, each["spec"]["podSelector"]["matchLabels"]) for each in policies]
    assert len(governed) == len(manifest.pods)
    assert all(any(pods == [pod] for pods in governed) for pod in manifest.pods.values())
    api = manifest.named("NetworkPolicy")["paretour"]["spec"]
    assert api["ingress"] == [{"ports": [{"protocol": "TCP", "port": "http"}]}]


@of_each_manifest
def test_no_secret_has_a_value_that_everybody_knows(manifest: Manifest) -> None:
    assert manifest.named("Secret") == {}
    [container] = manifest.pods["paretour"]["spec"]["containers"]
    [keys] = [each for each in container["env"] if each["name"] == "PARETOUR_API_KEYS"]
    # Without the secret Kubernetes starts no pod.
    assert keys["valueFrom"] == {"secretKeyRef": {"name": "paretour", "key": "api-keys"}}
    assert (
        "secret generic paretour --from-literal=api-keys=" in (DEPLOY / manifest.name).read_text()
    )


def test_the_routing_engine_is_where_the_service_asks() -> None:
    asked = ROADS_COMPOSE.services["paretour"]["environment"]["PARETOUR_ROUTER_URL"]
    assert asked == "http://valhalla:8002"
    assert f"PARETOUR_ROUTER_URL={asked}\n" in (DEPLOY / ROADS.name).read_text()
    [port] = ROADS.named("Service")["valhalla"]["spec"]["ports"]
    assert port["port"] == 8002
    [container] = ROADS.pods["valhalla"]["spec"]["containers"]
    assert container["ports"] == [{"name": port["targetPort"], "containerPort": 8002}]
    command = ROADS_COMPOSE.services["valhalla"]["command"]
    assert container["command"] == command
    [policy] = ROADS.named("NetworkPolicy").values()
    assert (
        policy["spec"]["podSelector"] == ROADS.named("Deployment")["valhalla"]["spec"]["selector"]
    )
    [rule] = policy["spec"]["ingress"]
    assert rule["ports"] == [{"protocol": "TCP", "port": "routes"}]
