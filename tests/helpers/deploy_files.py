"""The files of service/deploy, parsed, and what the Dockerfile says of user and volume."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
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
    """A file of Kubernetes objects."""

    name: str

    @cached_property
    def objects(self) -> list[dict[str, Any]]:
        """All objects of the file."""
        return list(yaml.load_all((DEPLOY / self.name).read_text(), yaml.CSafeLoader))

    @property
    def pods(self) -> dict[str, dict[str, Any]]:
        """The pod template of each object that has one, by the object's name."""
        return {
            item["metadata"]["name"]: item["spec"]["template"]
            for item in self.objects
            if "template" in item.get("spec", {})
        }

    def named(self, kind: str) -> dict[str, dict[str, Any]]:
        """Return the objects of a kind by name."""
        return {item["metadata"]["name"]: item for item in self.objects if item["kind"] == kind}


@dataclass(frozen=True)
class ComposeFile:
    """A file of Docker Compose, with its YAML anchors resolved."""

    name: str

    @cached_property
    def document(self) -> dict[str, Any]:
        """The whole file."""
        text = (DEPLOY / self.name).read_text()
        document: dict[str, Any] = yaml.load(text, yaml.CSafeLoader)
        return document

    @property
    def services(self) -> dict[str, dict[str, Any]]:
        """Its services by name, each with what it extends."""
        return {name: _extended(each) for name, each in self.document["services"].items()}


def _extended(service: dict[str, Any]) -> dict[str, Any]:
    """Return a service of Compose with the members, and the environment, of the one it extends."""
    if "extends" not in service:
        return service
    extended = service["extends"]
    base = ComposeFile(extended["file"]).services[extended["service"]]
    environment = base["environment"] | service.get("environment", {})
    return base | service | {"environment": environment}


EMBEDDED, CLUSTER = Manifest("kubernetes.yaml"), Manifest("cluster-kubernetes.yaml")
AUTOSCALING = Manifest("cluster-autoscaling.yaml")
ROADS = Manifest("roads-kubernetes.yaml")
MANIFESTS = (EMBEDDED, CLUSTER)
CLUSTER_COMPOSE = ComposeFile("cluster-compose.yaml")
ROADS_COMPOSE = ComposeFile("roads-compose.yaml")
COMPOSE_FILES = (ComposeFile("compose.yaml"), CLUSTER_COMPOSE, ROADS_COMPOSE)


def all_pods() -> dict[str, dict[str, Any]]:
    """Return the pod templates of all manifests by file and name."""
    files = (*MANIFESTS, ROADS)
    return {f"{file.name} {name}": pod for file in files for name, pod in file.pods.items()}


def all_services() -> dict[str, dict[str, Any]]:
    """Return the services of all Compose files by file and name."""
    return {
        f"{file.name} {name}": service
        for file in COMPOSE_FILES
        for name, service in file.services.items()
    }


def containers_of(pod: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """Yield the containers of a pod template."""
    yield from pod["spec"]["containers"]


def is_ours(container: dict[str, Any]) -> bool:
    """Whether a container, or a service of Compose, runs the image of the Dockerfile."""
    return bool(container["image"] == "paretour")


def our_pods() -> dict[str, dict[str, Any]]:
    """Return the pods whose containers all run our image."""
    return {
        name: pod
        for name, pod in all_pods().items()
        if all(is_ours(container) for container in containers_of(pod))
    }


def our_services() -> dict[str, dict[str, Any]]:
    """Return the services of Compose that run our image."""
    return {name: service for name, service in all_services().items() if is_ours(service)}
