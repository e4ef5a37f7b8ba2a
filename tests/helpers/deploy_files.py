"""The files that deploy, read."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

ROOT = Path(__file__).parents[2]
DEPLOY = ROOT / "service/deploy"
IMAGE = (ROOT / "Dockerfile").read_text()
USER = re.search(r"^USER (\d+):(\d+)", IMAGE, re.MULTILINE)
CACHE = re.search(r"^VOLUME (\S+)", IMAGE, re.MULTILINE)


@dataclass(frozen=True)
class Manifest:
    """The objects of Kubernetes in one file."""

    name: str

    @property
    def objects(self) -> list[dict[str, Any]]:
        return list(yaml.safe_load_all((DEPLOY / self.name).read_text()))

    @property
    def pods(self) -> dict[str, dict[str, Any]]:
        """Of each that has them, how its pods are made."""
        return {
            each["metadata"]["name"]: each["spec"]["template"]
            for each in self.objects
            if "template" in each.get("spec", {})
        }

    def named(self, kind: str) -> dict[str, dict[str, Any]]:
        return {each["metadata"]["name"]: each for each in self.objects if each["kind"] == kind}


@dataclass(frozen=True)
class Composition:
    """The services of Compose in one file, with what they have in common merged into each."""

    name: str

    @property
    def whole(self) -> dict[str, Any]:
        whole: dict[str, Any] = yaml.safe_load((DEPLOY / self.name).read_text())
        return whole

    @property
    def services(self) -> dict[str, dict[str, Any]]:
        services: dict[str, dict[str, Any]] = self.whole["services"]
        return services


EMBEDDED, CLUSTER = Manifest("kubernetes.yaml"), Manifest("cluster-kubernetes.yaml")
AUTOSCALING = Manifest("cluster-autoscaling.yaml")
MANIFESTS = (EMBEDDED, CLUSTER)
CLUSTER_COMPOSITION = Composition("cluster-compose.yaml")
COMPOSITIONS = (Composition("compose.yaml"), CLUSTER_COMPOSITION)


def all_pods() -> dict[str, dict[str, Any]]:
    return {f"{file.name} {name}": pod for file in MANIFESTS for name, pod in file.pods.items()}


def all_services() -> dict[str, dict[str, Any]]:
    return {
        f"{file.name} {name}": service
        for file in COMPOSITIONS
        for name, service in file.services.items()
    }


def containers_of(pod: dict[str, Any]) -> Iterator[dict[str, Any]]:
    for part in ("initContainers", "containers"):
        yield from pod["spec"].get(part, [])


def is_ours(container: dict[str, Any]) -> bool:
    """Whether it, or a service of Compose, is of our image."""
    return bool(container["image"] == "paretour")


def our_pods() -> dict[str, dict[str, Any]]:
    return {
        name: pod
        for name, pod in all_pods().items()
        if all(is_ours(container) for container in containers_of(pod))
    }


def our_services() -> dict[str, dict[str, Any]]:
    return {name: service for name, service in all_services().items() if is_ours(service)}
