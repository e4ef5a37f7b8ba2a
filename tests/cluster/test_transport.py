"""The list of messages in Redis may hold anything: a worker drops it and goes on."""

import json
from ssl import CERT_NONE, CERT_REQUIRED
from typing import Any

import pytest
import redis as redis_client
from kombu import Consumer, Queue

from service.cluster.celery_app import QUEUE, make_celery, send_record
from tests.helpers.redis_server import Redis

HEADERS = {"task": "paretour.plan", "id": "a"}
PROPERTIES = {"delivery_tag": "t", "delivery_info": {"exchange": "", "routing_key": "paretour"}}
MESSAGE: dict[str, Any] = {
    "headers": HEADERS,
    "properties": PROPERTIES,
    "body": "e30=",
    "content-type": "application/json",
    "content-encoding": "utf-8",
}
GARBAGE = [
    b"garbage",
    b"\xff\xfe",
    b"",
    b"7",
    b"[1, 2]",
    b"{}",
    b"[" * 100_000,
    *(
        json.dumps({**MESSAGE, **change}).encode()
        for change in (
            {"headers": None},
            {"headers": {**HEADERS, "task": {}}},
            {"properties": {}},
            {"properties": {**PROPERTIES, "delivery_tag": []}},
            {"properties": {**PROPERTIES, "delivery_info": None}},
            {"body": {}},
            {"content-type": 7},
        )
    ),
]


@pytest.mark.parametrize(
    ("url", "ssl"),
    [
        ("redis://:pass@127.0.0.1:7/3", False),
        ("rediss://:pass@127.0.0.1:7/3", {"ssl_cert_reqs": CERT_REQUIRED}),
        ("rediss://:pass@127.0.0.1:7/3?ssl_cert_reqs=none", {"ssl_cert_reqs": CERT_NONE}),
    ],
)
def test_addresses_mean_what_they_mean_to_kombus_own(url: str, ssl: object) -> None:
    connection = make_celery(url, seconds=1).connection_for_read()
    assert connection.transport_cls.endswith("celery_app:Transport")
    found = (connection.hostname, connection.port, connection.virtual_host, connection.password)
    assert found == ("127.0.0.1", 7, "3", "pass")
    assert connection.ssl == ssl


def test_what_is_no_message_is_dropped_and_logged_once(
    redis: Redis, caplog: pytest.LogCaptureFixture
) -> None:
    connection = redis_client.Redis.from_url(redis.url)
    connection.flushall()
    celery = make_celery(redis.url, seconds=1)
    for element in GARBAGE:
        connection.lpush(QUEUE, element)
    send_record(celery, "a")
    received = []

    def receive(message: Any) -> None:
        received.append(message.decode()[0])
        message.ack()

    with celery.connection_for_read() as broker, broker.channel() as channel:
        queue = Queue(QUEUE, channel=channel)
        with Consumer(channel, [queue], on_message=receive):
            while not received:
                broker.drain_events(timeout=60)
    assert received == [["a"]]
    assert connection.llen(QUEUE) == 0
    assert len([line for line in caplog.messages if "is dropped" in line]) == len(GARBAGE)
    connection.close()
