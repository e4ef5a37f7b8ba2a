"""What is asked, and who plans it: a service that runs somewhere, or else this process."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.console import Console

from service.client import Actor, Client, Front
from service.commands.exits import Wrong
from service.commands.reading import Request, read_request
from service.commands.there import plan_there


@dataclass(frozen=True, kw_only=True)
class Asked:
    """What files say, and options instead: those that are None leave it to the files."""

    file: Path
    file2: Path | None
    unrounded: bool
    angles: str | None = None
    options: Mapping[str, Any]

    def request(self) -> Request:
        """Both, as a request.

        Raises:
            NotRead: a file is nothing that can be planned.
            Wrong: there is no such file, or the angles are none.
        """
        files = [self.file] if self.file2 is None else [self.file, self.file2]
        given = {**self.options, "preferences": self._angles()}
        try:
            read = read_request(files, unrounded=self.unrounded)
        except OSError as error:
            raise Wrong(f"{error.filename}: {error.strerror}") from None
        return {**read, **{name: value for name, value in given.items() if value is not None}}

    def _angles(self) -> list[float] | None:
        try:
            return None if self.angles is None else [float(a) for a in self.angles.split(",")]
        except ValueError:
            sentence = f"--angles must be numbers with commas between, got {self.angles!r}"
            raise Wrong(sentence) from None


@dataclass(frozen=True)
class Planner:
    """The service at a URL, or this process.

    What plans in this process is imported where it does, as it takes a second and the compiler.
    """

    url: str | None
    api_key: str | None

    def plan(self, request: Request, stderr: Console) -> Front:
        """The front that a request asks for."""
        if self.url is not None:
            with Client(self.url, api_key=self.api_key) as client:
                return plan_there(client, request, stderr)
        from service.commands.here import plan_here

        return plan_here(request, stderr)

    def actors(self) -> tuple[Actor, ...]:
        """The networks to choose from."""
        if self.url is not None:
            with Client(self.url, api_key=self.api_key) as client:
                return client.actors()
        from service.commands.here import actors_here

        return actors_here()
