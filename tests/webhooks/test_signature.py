"""Signatures are those of Standard Webhooks, and secrets of its form alone."""

import base64
import os
import time

import pytest

from service.webhooks.signature import Secret, signed_headers
from tests.helpers.webhook_receiver import KEY, SECRET, checked

ID, BODY = "msg_p5jXN8AQM9LWM0D4loKWxJek", b'{"test": 2432232314}'


def test_a_signature_is_that_of_the_reference_libraries() -> None:
    # The example in the tests of the specification's own libraries.
    secret = Secret.read("whsec_MfKQ9r8GKYqrTwjUPD8ILPZIo2LaLaSw")
    headers = signed_headers(ID, 1614265330, BODY, [secret])
    assert headers == {
        "webhook-id": ID,
        "webhook-timestamp": "1614265330",
        "webhook-signature": "v1,g0hM9SsE+OTPJTGt/tmIKtSyZlE3uFJELVlNIOLJ1OE=",
    }


def test_each_secret_signs() -> None:
    other = os.urandom(24)
    secrets = [Secret.read(SECRET), Secret(other)]
    headers = {
        **signed_headers(ID, int(time.time()), BODY, secrets),
        "content-type": "application/json",
    }
    for key in (KEY, other):
        assert checked(headers, BODY, key) == {"test": 2432232314}


@pytest.mark.parametrize(
    "text",
    [
        *("", "whsec_", SECRET.removeprefix("whsec_"), SECRET + "!", "whsec_geheim"),
        f"whsec_{base64.b64encode(bytes(23)).decode()}",
        f"whsec_{base64.b64encode(bytes(65)).decode()}",
    ],
)
def test_a_secret_of_another_form_is_refused_without_being_shown(text: str) -> None:
    with pytest.raises(ValueError, match="must be whsec_ and 24 to 64 bytes in base64") as refused:
        Secret.read(text)
    assert text in ("", "whsec_") or text not in str(refused.value)


def test_a_secret_is_not_shown() -> None:
    assert "key" not in repr(Secret.read(SECRET))
