"""Demands on the service under load: which do not hold, and how RESULTS.md shows them."""

import threading
from typing import Any

import pytest

from tests.benchmarks import provenance
from tests.benchmarks.demands import growth, unmet_by_attack, unmet_by_load, unmet_by_soak
from tests.benchmarks.traffic import (
    Client,
    as_fast_as_answered,
    at_random,
    evenly,
    now_and_then,
    quantiles,
    when_due,
)
from tests.benchmarks.under_load import section
from tests.helpers.serving import app_of, serving, workers_of

WHERE = {"cpu": "abacus", "threads": 2, "date": "today", "commit": "none"}
QUICK = {"median_ms": 1.0, "p99_ms": 2.0, "worst_ms": 50.0}
BODY = b'{"coordinates": [[0, 0, 0, 0], [1, 2, 3, 4], [9, 8, 7, 6]], "time_limit": 0}'


def loaded(**other: Any) -> dict[str, Any]:
    return {
        **WHERE,
        "seconds": 20.0,
        "bare": [{"per_second": 100.0, "session_ms": 20.0}],
        "apart": [{"per_second": 120.0, "session_ms": 18.0}],
        "served": [{"per_second": 90.0, "workers_ms": 18.5, "server_ms": 1.0, "clients_ms": 0.25}],
        "share_of_apart": 0.9,
        "processor_share": 0.911,
        "at_80_percent": {"median_ms": 20.0, "p99_ms": 79.9, "worst_ms": 90.0},
        "at_80_percent_at_random": {"median_ms": 20.0, "p99_ms": 95.0, "worst_ms": 99.0},
        "under_full_load": {"/metrics": QUICK},
        "with_long_bodies": {"/metrics": QUICK},
        "long_bodies": {"gzip": {"415": 3}},
        **other,
    }


LOGGED = {"tracebacks_in_log": 1, "tracebacks": {"E: e": 1}}


def soaked(**other: Any) -> dict[str, Any]:
    return {
        **WHERE,
        "minutes": 10.0,
        "visitors": 8,
        "answers": {"plan": {"200": 7, "503": 1}},
        "faults": [],
        "jobs": {"accepted": 4, "done": 2, "cancelled": 1, "forgotten once done": 1},
        "tracebacks_in_log": 0,
        "tracebacks": {},
        "exit_status": 0,
        "megabytes": [500.0, 600.0],
        "growth_over_last_half": 0.0999,
        **other,
    }


def attacked(**other: Any) -> dict[str, Any]:
    return {
        **WHERE,
        "minutes": 5.0,
        "busy": 0.5,
        "quiet": {"statuses": {"200": 120}, **QUICK},
        "beside": {"statuses": {"200": 600}, **QUICK, "worst_ms": 1050.0},
        "crowds": {"hang-ups": {"answers": {"hung up": 5}, "faults": []}},
        "megabytes": 2048,
        "workers_lost": 0,
        "workers_present": 2,
        "tracebacks_in_log": 0,
        "tracebacks": {},
        "exit_status": 0,
        **other,
    }


def test_nothing_is_unmet_just_where_all_demands_hold() -> None:
    assert list(unmet_by_load(loaded())) == []
    assert list(unmet_by_soak(soaked())) == []
    assert list(unmet_by_attack(attacked())) == []


@pytest.mark.parametrize(
    ("other", "sentence"),
    [
        ({"share_of_apart": 0.899}, "answers a second must be 90%"),
        (
            {"at_80_percent": {"median_ms": 20.0, "p99_ms": 80.0, "worst_ms": 90.0}},
            "p99 must be under 4 times the median, got 4.00 times",
        ),
        (
            {"with_long_bodies": {"/metrics": {**QUICK, "worst_ms": 50.1}}},
            "/metrics must answer within 50 ms with long bodies, got 50.1 ms",
        ),
    ],
)
def test_a_demand_that_load_does_not_meet_is_named(other: dict[str, Any], sentence: str) -> None:
    [unmet] = unmet_by_load(loaded(**other))
    assert unmet.startswith(sentence)


@pytest.mark.parametrize(
    ("other", "sentence"),
    [
        ({"jobs": {"accepted": 3, "done": 2}}, "every accepted job must end, got 3 and 2 ends"),
        ({"jobs": {"accepted": 1, "failed": 1}}, "no job may fail, got 1"),
        ({"faults": ["plan: 500"]}, "there must be no fault, got 1: plan: 500"),
        (
            {"tracebacks_in_log": 1, "tracebacks": {"E: e": 1}},
            "the log must have no traceback, got 1: E: e",
        ),
        ({"exit_status": -9}, "the service must end with 0, got -9"),
        ({"growth_over_last_half": 0.1}, "memory must grow by less than 10%"),
    ],
)
def test_a_demand_that_soak_does_not_meet_is_named(other: dict[str, Any], sentence: str) -> None:
    [unmet] = unmet_by_soak(soaked(**other))
    assert unmet.startswith(sentence)


@pytest.mark.parametrize(
    ("other", "sentence"),
    [
        (
            {"beside": {"statuses": {"0": 1, "200": 9, "503": 2}, **QUICK}},
            "every honest request must be a 200, got 0, 503 (beside)",
        ),
        (
            {"beside": {"statuses": {"200": 9}, **QUICK, "worst_ms": 1060.0}},
            "honest requests must take at most 1 s more, got 1.01 s",
        ),
        (
            {"crowds": {"hostile bodies": {"answers": {"500": 1}, "faults": ["500 oh"]}}},
            "hostile bodies must see no fault, got 500 oh",
        ),
        ({"megabytes": 2049}, "memory must stay under 2048 MB, got 2049 MB"),
        ({"workers_lost": 1}, "no worker may be lost, got 1"),
        ({"workers_present": 1}, "2 workers must be there afterwards, got 1"),
        (
            {"tracebacks_in_log": 1, "tracebacks": {"E: e": 1}},
            "the log must have no traceback, got 1: E: e",
        ),
        ({"exit_status": -9}, "the service must end with 0, got -9"),
    ],
)
def test_a_demand_that_attack_does_not_meet_is_named(other: dict[str, Any], sentence: str) -> None:
    [unmet] = unmet_by_attack(attacked(**other))
    assert unmet.startswith(sentence)


def test_growth_is_that_of_the_last_half() -> None:
    assert growth([1.0] * 20 + [100.0] * 20) == 0
    assert growth([1.0] * 20 + [100.0] * 10 + [110.0] * 10) == pytest.approx(0.1)


def test_the_page_shows_what_was_found_and_what_does_not_hold(
    tmp_path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(provenance, "RESULTS", tmp_path)
    assert section().count("Not measured.") == 3
    monkeypatch.setattr(provenance, "changed_files", list)
    provenance.store("load", loaded(share_of_apart=0.8))
    provenance.store("soak", soaked())
    provenance.store("attack", attacked(workers_lost=3))
    page = section()
    assert "| their share of bare sessions' calls | 80.0% | at least 90% |" in page
    assert "| 80 % of that, at random: median, p99, ratio | 20.0 ms, 95.0 ms, 4.75 |" in page
    assert "- answers a second must be 90% of bare sessions' calls, got 80.0%" in page
    assert "| hang-ups: statuses | hung up: 5 |  |" in page
    assert "- no worker may be lost, got 3" in page
    assert "| plan: statuses | 200: 7, 503: 1 |  |" in page
    assert "`none`. Does not hold: nothing." in page


def test_clients_tell_each_status_and_how_long_it_took() -> None:
    # More than it is asked at once, however slow the machine.
    workers = workers_of(queue=100)
    with serving(app_of(workers=workers)) as url:
        address = ("127.0.0.1", int(url.rpartition(":")[2]))
        client = Client(address)
        asked = [("GET", "/openapi.json"), ("GET", "/nowhere"), ("POST", "/front")]
        assert [client.ask(*each) for each in asked] == [200, 404, 400]
        assert client.ask("POST", "/front", BODY) == 200
        assert client.ask("POST", "/front", BODY, "gzip") == 415
        client.close()
        answers = as_fast_as_answered(address, [BODY], clients=2, seconds=0.5)
        answers += when_due(address, [BODY], evenly(rate=20, seconds=0.5))
        answers += when_due(address, [BODY], at_random(rate=20, seconds=0.5))
        stop = threading.Event()
        threading.Timer(0.3, stop.set).start()
        answers += now_and_then(address, "/health/live", 0.01, stop)
    assert {each.status for each in answers} == {200}
    times = quantiles(answers)
    assert 0 < times["median_ms"] <= times["p99_ms"] <= times["worst_ms"]
