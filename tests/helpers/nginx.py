"""nginx with the configuration of service/deploy, as a process before a service."""

import re
import shutil
import socket
import subprocess
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from urllib.parse import urlsplit

from tests.helpers.deploy_files import DEPLOY
from tests.helpers.ports import free_port
from tests.helpers.required import give_up

CONFIGURATION = DEPLOY / "nginx.conf"
_MAIN = """
user root;  # whose the folder is where it is run by root; others are not asked for
daemon off; pid {folder}/pid; error_log {folder}/error.log; worker_processes 1;
events {{ worker_connections 2000; }}
http {{
    access_log off;
    client_body_temp_path {folder}/bodies; proxy_temp_path {folder}/answers;
    fastcgi_temp_path {folder}/f; uwsgi_temp_path {folder}/u; scgi_temp_path {folder}/s;
    include {folder}/paretour.conf;
}}
"""


@contextmanager
def nginx_before(
    service: str, folder: Path, changed: Mapping[str, str] | None = None
) -> Iterator[str]:
    """Run nginx before the service at a URL until the block ends, and yield its own.

    The configuration is the one that is shipped, but for both ports and the lines that are changed.
    """
    port = free_port()
    text = CONFIGURATION.read_text()
    for line, other in (changed or {}).items():
        assert text.count(line) == 1, line
        text = text.replace(line, other)
    text, listens = re.subn(r"listen 80;", f"listen 127.0.0.1:{port};", text)
    text, servers = re.subn(r"server 127.0.0.1:8000;", f"server {urlsplit(service).netloc};", text)
    assert (listens, servers) == (1, 1)
    (folder / "paretour.conf").write_text(text)
    (folder / "nginx.conf").write_text(_MAIN.format(folder=folder))
    nginx = shutil.which("nginx", path="/usr/sbin:/usr/local/sbin:/usr/bin")
    if nginx is None:
        give_up("nginx is not installed")
    command = [nginx, "-p", folder, "-c", folder / "nginx.conf", "-e", folder / "error.log"]
    with subprocess.Popen(command) as process:
        try:
            _wait_until_listening(port, process)
            yield f"http://127.0.0.1:{port}"
        finally:
            process.terminate()


def _wait_until_listening(port: int, process: "subprocess.Popen[bytes]") -> None:
    while process.poll() is None:
        try:
            socket.create_connection(("127.0.0.1", port), timeout=60).close()
        except ConnectionRefusedError:
            time.sleep(0.02)
        else:
            return
    raise AssertionError("nginx has ended")
