"""A hook of the build: with PARETOUR_PRECOMPILE=1 the wheel carries compiled code."""

import os
import shutil
import subprocess
import sys
from importlib.metadata import version as version_of
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class Precompile(BuildHookInterface[Any]):
    """Compiles the code of the service for the Python that builds the wheel.

    numba loads compiled code of its own version alone, so the wheel demands this version. Where the
    code is not for a processor, the service compiles it again.
    """

    def dependencies(self) -> list[str]:
        """Return what the build has to install: to compile the service it has to be imported."""
        return self.metadata.core.dependencies if _asked_for() else []

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Compile a copy of the service, and add the compiled code to the wheel."""
        if not _asked_for() or version != "standard":
            return
        self.folder = TemporaryDirectory()
        package = Path(self.folder.name, "service")
        shutil.copytree(
            Path(self.root, "service"),
            package,
            ignore=shutil.ignore_patterns("__pycache__", "precompiled"),
        )
        environment = {**os.environ, "PYTHONPATH": self.folder.name}
        command = [sys.executable, "-m", "service.jobs.precompile"]
        subprocess.run(command, cwd=self.folder.name, env=environment, check=True)
        build_data["force_include"][str(package / "precompiled")] = "service/precompiled"
        build_data["dependencies"].append(f"numba=={version_of('numba')}")
        build_data["infer_tag"], build_data["pure_python"] = True, False

    def finalize(self, *_: object) -> None:
        """Remove the copy."""
        if hasattr(self, "folder"):
            self.folder.cleanup()


def _asked_for() -> bool:
    return os.environ.get("PARETOUR_PRECOMPILE") == "1"
