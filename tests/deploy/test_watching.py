"""Alert rules and the dashboard name only metrics and labels that /metrics has."""

import json
import re
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import httpx
import pytest
import yaml
from prometheus_client.parser import text_string_to_metric_families

from service.api.app import Edge
from service.api.metrics import Metrics
from service.jobs.engine import EngineStats
from tests.api.test_metrics import FOUND, FRONT, FixedStats
from tests.guide.pages import GUIDE
from tests.helpers.deploy_files import DEPLOY
from tests.helpers.serving import app_of, serving

RULES = [
    rule
    for group in yaml.safe_load((DEPLOY / "alerts.yaml").read_text())["groups"]
    for rule in group["rules"]
]
DASHBOARD = json.loads((DEPLOY / "dashboard.json").read_text())
EXPRESSIONS = {rule["alert"]: rule["expr"] for rule in RULES} | {
    f"{panel['title']} {target['refId']}": target["expr"]
    for panel in DASHBOARD["panels"]
    for target in panel["targets"]
}
OF_PROMETHEUS = {"job", "instance"}  # labels that it adds to each sample, and to `up`
METRIC = re.compile(r"\b(?:paretour|process|python)_\w+|\bup\b")
FUNCTIONS = {"by", "sum", "max", "rate", "increase", "histogram_quantile"}


@pytest.fixture(scope="module")
def labels() -> dict[str, set[str]]:
    """The labels of each metric of a service that has planned, asked for roads and posted."""
    metrics = Metrics()
    metrics.planned(replace(FOUND, gained=0.1, timings_ms={"construction": 1.0}))
    metrics.routed("answered", 0.1)
    metrics.posted("delivered")
    engine = FixedStats(EngineStats(waiting=0, working=0, lost=0, workers=1))
    metrics.watch(engine)
    found: dict[str, set[str]] = defaultdict(set)
    with serving(app_of(edge=Edge(metrics=metrics))) as url:
        httpx.post(f"{url}/front", json=FRONT)
        text = httpx.get(f"{url}/metrics").text
    for family in text_string_to_metric_families(text):
        for sample in family.samples:
            found[sample.name] |= set(sample.labels)
    return {**found, "up": set()}


def selectors(expression: str) -> Iterator[tuple[str, set[str]]]:
    """Yield each metric of an expression with the labels that it is selected by."""
    for found in re.finditer(rf"({METRIC.pattern})(?:{{([^}}]*)}})?", expression):
        yield found[1], set(re.findall(r"(\w+)\s*(?:=~|!~|!=|=)", found[2] or ""))


@pytest.mark.parametrize("name", EXPRESSIONS)
def test_every_metric_and_label_is_one_of_the_service(
    name: str, labels: dict[str, set[str]]
) -> None:
    expression = EXPRESSIONS[name]
    named = list(selectors(expression))
    assert named
    for metric, selected in named:
        assert metric in labels
        assert selected <= labels[metric] | OF_PROMETHEUS
        assert "job" in selected
    known = set().union(*(labels[metric] for metric, _ in named)) | OF_PROMETHEUS
    for grouped in re.findall(r"\bby \(([^)]*)\)", expression):
        assert {each.strip() for each in grouped.split(",")} <= known


@pytest.mark.parametrize("name", EXPRESSIONS)
def test_every_expression_is_whole(name: str) -> None:
    expression = EXPRESSIONS[name]
    for opening, closing in ("()", "[]", "{}"):
        assert expression.count(opening) == expression.count(closing)
    called = set(re.findall(r"\b([a-z_]+)\s*(?=\()", re.sub(r'"[^"]*"', "", expression)))
    assert called <= FUNCTIONS
    # A counter is only of use as a rate; a gauge has none.
    for metric in re.findall(r"(\w+_total|\w+_bucket|\w+_sum|\w+_count)\b", expression):
        assert re.search(rf"(?:rate|increase)\({metric}", expression)


@pytest.mark.parametrize("rule", RULES, ids=lambda rule: rule["alert"])
def test_every_alert_has_a_sentence_and_a_row_in_the_guide(rule: dict[str, Any]) -> None:
    assert rule["annotations"]["summary"]
    assert rule["labels"]["severity"] in ("critical", "warning")
    assert f"| `{rule['alert']}` |" in (GUIDE / "watch-it.md").read_text()


def test_panels_have_titles_and_places_of_their_own() -> None:
    taken: set[tuple[int, int]] = set()
    panels = DASHBOARD["panels"]
    for panel in panels:
        place = panel["gridPos"]
        cells = {
            (x, y)
            for x in range(place["x"], place["x"] + place["w"])
            for y in range(place["y"], place["y"] + place["h"])
        }
        assert place["x"] + place["w"] <= 24
        assert not cells & taken
        taken |= cells
        assert panel["fieldConfig"]["defaults"]["unit"]
        assert panel["datasource"]["uid"] == "${datasource}"
    assert len({panel["title"] for panel in panels}) == len(panels)
    assert len({panel["id"] for panel in panels}) == len(panels)


def test_legends_name_labels_that_are_left() -> None:
    for panel in DASHBOARD["panels"]:
        for target in panel["targets"]:
            used = set(re.findall(r"{{(\w+)}}", target["legendFormat"]))
            kept = {
                each.strip()
                for grouped in re.findall(r"\bby \(([^)]*)\)", target["expr"])
                for each in grouped.split(",")
            }
            assert used <= (kept or OF_PROMETHEUS), panel["title"]


def test_every_metric_of_the_service_is_on_the_dashboard(labels: dict[str, set[str]]) -> None:
    shown = {metric for expression in EXPRESSIONS.values() for metric, _ in selectors(expression)}
    own = {name for name in labels if name.startswith("paretour_") and "_created" not in name}
    families = {re.sub(r"_(bucket|sum|count)$", "", name) for name in own}
    assert families == {
        re.sub(r"_(bucket|sum|count)$", "", name) for name in shown if name.startswith("paretour_")
    }
