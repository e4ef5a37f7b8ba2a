"""Answers that the service is said to have stored, so that the page shows plans that are known."""

import base64
import json
import zlib
from typing import Any

from playwright.sync_api import Page

from tests.helpers.browsing import know, open_link


def open_stored_answer(page: Page, request: dict[str, Any], answer: dict[str, Any]) -> None:
    """Have a page open an answer by a link that has its request, and wait until it is shown."""
    asked = {"request": request, "objectives": request["objectives"]}
    packer = zlib.compressobj(wbits=-15)
    packed = packer.compress(json.dumps(asked).encode()) + packer.flush()
    text = base64.urlsafe_b64encode(packed).decode().rstrip("=")
    front = answer["id"]
    know(page, {f"front/{front}": answer})
    open_link(page, f"#front={front}&balance=0&asked={text}")
