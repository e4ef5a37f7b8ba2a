"""`python -m tests.deploy.container`: build the image, and run it as an operator would.

Builds the Dockerfile with Podman, which needs no daemon. The container runs read-only, as the user
of the image, with no capabilities, within 2 GiB. It plans a front, a fleet and a coverage, lists
the tools of agents, and is started again. Prints the size of the image, what it is made of, and the
seconds until it is ready.

Where no registry of images can be reached, `--debian URL` makes the base image with debootstrap
from a mirror of Debian. `--mount PATH` shows the build a file or folder of this machine, such as
the settings of pip. `--run OPTION` is passed on to `podman run`, and `--runtime` to Podman.
"""

import argparse
import json
import subprocess
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import httpx

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "service" / "examples"
IMAGE = "paretour"
BASE = "docker.io/library/python:3.11-slim"  # as the Dockerfile names it, in full
PORT = 8123
URL = f"http://127.0.0.1:{PORT}"
PACKAGES = "/opt/paretour/lib/python3.11/site-packages"
PLANS = {  # an example of each path
    "/front": "helsinki-deliveries.json",
    "/fleet": "helsinki-vans.json",
    "/coverage": "warehouse-cleaning.json",
}
HARDENED = ["--read-only", "--cap-drop=all", "--security-opt=no-new-privileges", "--memory=2g"]


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser("python -m tests.deploy.container", description=__doc__)
    parser.add_argument("--debian", metavar="URL")
    parser.add_argument("--mount", action="append", default=[], metavar="PATH")
    parser.add_argument("--run", action="append", default=[], metavar="OPTION")
    parser.add_argument("--runtime", default="crun")
    given = parser.parse_args()
    if given.debian is not None:
        make_base(given.debian)
    build(given.mount)
    options = [f"--runtime={given.runtime}", "run", "--network=host", *given.run]
    measured: dict[str, Any] = {"image, MB": size(), "largest, MB": largest(options)}
    with container(options) as name:
        measured["ready, s"] = ready()
        measured["points"] = {path: points(path) for path in PLANS}
        measured["tools of agents"] = tools()
        began = time.monotonic()
        podman("restart", name)
        measured["ready again, s"] = ready(began)
    print(json.dumps(measured, indent=1))


def podman(*arguments: str, **options: Any) -> str:
    """Run a command of Podman and return what it prints."""
    command = ["podman", *arguments]
    return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True, **options).stdout


def make_base(mirror: str) -> None:
    """Make the base image of Debian's own Python, under the name that the Dockerfile gives."""
    with TemporaryDirectory() as folder:
        root = Path(folder, "root")
        packages = "python3,python3-venv,ca-certificates"
        command = ["debootstrap", "--variant=minbase", f"--include={packages}", "bookworm"]
        subprocess.run([*command, root, mirror], check=True)
        (root / "usr/bin/python").symlink_to("python3")
        packed = ["tar", "-C", str(root), "-c", "."]
        with subprocess.Popen(packed, stdout=subprocess.PIPE) as tar:
            podman("import", "-", BASE, stdin=tar.stdout)


def build(mounts: Sequence[str]) -> None:
    """Build the image, in the format that knows health checks."""
    shown = [f"--volume={path}:{path}:ro" for path in mounts]
    how = ["--format=docker", "--isolation=chroot", "--network=host", *shown]
    podman("build", *how, "--tag", IMAGE, str(ROOT))


def size() -> int:
    """Return the size of the image in megabytes."""
    return int(podman("image", "inspect", "--format={{.Size}}", IMAGE)) // 10**6


def largest(options: Sequence[str]) -> dict[str, int]:
    """Return the megabytes of the largest packages in the image."""
    sizes = podman(*options, "--rm", IMAGE, "du", "-m", "-d1", PACKAGES).splitlines()
    by_name = {Path(path).name: int(megabytes) for megabytes, path in map(str.split, sizes)}
    return dict(sorted(by_name.items(), key=lambda item: -item[1])[:12])


@contextmanager
def container(options: Sequence[str]) -> Iterator[str]:
    """Run the image until the block ends, and yield the container's name."""
    name = f"{IMAGE}-tried"
    settings = (f"PARETOUR_PORT={PORT}", "PARETOUR_HOST=127.0.0.1", "PARETOUR_MCP=1")
    variables = [f"--env={setting}" for setting in settings]
    podman(*options, "-d", f"--name={name}", *HARDENED, *variables, IMAGE)
    try:
        yield name
    finally:
        print(podman("logs", name, stderr=subprocess.STDOUT))
        podman("rm", "-f", name)


def ready(began: float | None = None) -> float:
    """Wait until the service is ready, and return the seconds since `began`, or now."""
    began = time.monotonic() if began is None else began
    while not is_ready():
        time.sleep(0.05)
    return round(time.monotonic() - began, 1)


def is_ready() -> bool:
    """Return whether the service answers that it is ready, with nothing left to compile."""
    try:
        answer = httpx.get(f"{URL}/health/ready")
    except httpx.TransportError:
        return False
    return answer.json() == {"status": "ready"}


def points(path: str) -> int:
    """Plan an example, and return the number of points that were found."""
    request = {**json.loads((EXAMPLES / PLANS[path]).read_text()), "time_limit": 1}
    answer = httpx.post(f"{URL}{path}", json=request, timeout=300).raise_for_status()
    found: int = answer.json()["points"]
    return found


def tools(url: str = URL) -> list[str]:
    """Return the names of the tools that a service gives to agents."""
    message = {"jsonrpc": "2.0", "id": 1, "method": "tools/list"}
    accepted = {"Accept": "application/json, text/event-stream"}
    answer = httpx.post(f"{url}/mcp", json=message, headers=accepted).raise_for_status()
    return [tool["name"] for tool in answer.json()["result"]["tools"]]


if __name__ == "__main__":
    main()
