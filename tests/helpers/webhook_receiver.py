"""Receive webhooks, answer as a test says, and check signatures by the specification."""

import base64
import hashlib
import hmac
import json
import shutil
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler
from pathlib import Path
from typing import Any

from service.webhooks.sender import Webhooks
from service.webhooks.signature import Secret
from service.webhooks.targets import Target, Targets
from tests.helpers.http_handler import serving_handler
from tests.helpers.required import give_up

KEY = bytes(range(32))
SECRET = f"whsec_{base64.b64encode(KEY).decode()}"
_PATIENCE = 60.0  # seconds


@dataclass
class Receiver:
    """The webhooks that came: headers and body of each; and what the next are answered."""

    url: str = ""
    came: list[tuple[dict[str, str], bytes]] = field(default_factory=list)
    statuses: list[int] = field(default_factory=list)
    headers: dict[str, str] = field(default_factory=dict)

    def wait(self, n: int = 1) -> list[dict[str, Any]]:
        """Wait for a number of webhooks and return the events of all that came."""
        ends = time.monotonic() + _PATIENCE
        while len(self.came) < n and time.monotonic() < ends:
            time.sleep(0.02)
        assert len(self.came) >= n
        return [checked(*each) for each in self.came]


def checked(headers: dict[str, str], body: bytes, key: bytes = KEY) -> dict[str, Any]:
    """Return the event of a webhook, after a check of its signature as a receiver makes it."""
    assert abs(int(headers["webhook-timestamp"]) - time.time()) < 300
    signed = f"{headers['webhook-id']}.{headers['webhook-timestamp']}.".encode() + body
    expected = base64.b64encode(hmac.new(key, signed, hashlib.sha256).digest()).decode()
    assert f"v1,{expected}" in headers["webhook-signature"].split()
    assert headers["content-type"] == "application/json"
    event: dict[str, Any] = json.loads(body)
    return event


@contextmanager
def receiving(certificate: Path | None = None) -> Iterator[Receiver]:
    """Receive webhooks until the block ends, with this certificate and key by TLS."""
    receiver = Receiver()

    class Handler(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            body = self.rfile.read(int(self.headers["content-length"]))
            receiver.came.append(({k.lower(): v for k, v in self.headers.items()}, body))
            self.send_response(receiver.statuses.pop(0) if receiver.statuses else 204)
            for name, value in receiver.headers.items():
                self.send_header(name, value)
            self.end_headers()

        def log_message(self, *_: object) -> None:
            """Be silent."""

    with serving_handler(Handler, certificate) as url:
        receiver.url = url
        yield receiver


def webhooks_to(*targets: str, pauses: tuple[float, ...] = (0.2, 0.2), **more: Any) -> Webhooks:
    """Return webhooks to these targets, as the setting writes them, tried again soon."""
    return Webhooks(
        targets=Targets(map(Target.read, targets)),
        secrets=[Secret.read(SECRET)],
        pauses=pauses,
        **more,
    )


def certificate_for(host: str, folder: Path) -> Path:
    """Return a file with a new key, and its certificate for a host, which is its own authority."""
    file, key = folder / f"{host}.pem", folder / f"{host}.key"
    if shutil.which("openssl") is None:
        give_up("openssl is not installed")
    named = ["-subj", f"/CN={host}", "-addext", f"subjectAltName=DNS:{host}"]
    made = ["-newkey", "rsa:2048", "-nodes", "-days", "1", "-keyout", str(key), "-out", str(file)]
    subprocess.run(["openssl", "req", "-x509", *named, *made], check=True, capture_output=True)
    file.write_bytes(file.read_bytes() + key.read_bytes())
    return file
