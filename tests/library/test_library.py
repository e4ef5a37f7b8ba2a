"""The package as a library: fronts planned in the caller's process, or in several of its own."""

import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import numpy as np
import paretour
import psutil
import pytest

from tests.helpers.command import ROOT

CITIES = np.random.default_rng(1).random((12, 4))
STOPS = [{"id": f"stop-{number}"} for number in range(6)]
COSTS = np.random.default_rng(2).integers(1, 99, (2, 6, 6))
OBJECTIVES: Any = [
    {"name": name, "matrix": costs} for name, costs in zip(("time", "risk"), COSTS, strict=True)
]
pytestmark = pytest.mark.usefixtures("compiled")


def python(code: str, *options: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, *options, "-c", code]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True)


def test_a_front_has_the_lengths_of_its_tours() -> None:
    front = paretour.plan(CITIES, time_limit=0.1)
    for tour in front:
        way = CITIES[np.append(tour.tour, tour.tour[0])].reshape(-1, 2, 2)
        assert np.linalg.norm(np.diff(way, axis=0), axis=2).sum(axis=0) == pytest.approx(
            tour.lengths
        )
    assert (front.status, front.id) == ("done", "")


def test_a_front_of_matrices_is_that_of_named_objectives() -> None:
    named = paretour.plan(stops=STOPS, objectives=OBJECTIVES, time_limit=0.1)
    plain = paretour.plan(matrices=COSTS, time_limit=0.1)
    np.testing.assert_array_equal(named.lengths, plain.lengths)
    assert named.names == ["time", "risk"]


def test_a_fleet_is_planned_and_replanned() -> None:
    front = paretour.plan_fleet(
        stops=STOPS,
        objectives=OBJECTIVES,
        vehicles=[{"id": "van", "start": 0, "end": 0}],
        time_limit=0.2,
    )
    rest = paretour.replan(front, remove=["stop-3"], time_limit=0.2)
    assert {stop for plan in rest.plans for route in plan.routes for stop in route.stops} == {
        f"stop-{number}" for number in (0, 1, 2, 4, 5)
    }


def test_an_order_is_offered_slots_and_an_offer_is_taken() -> None:
    minutes: Any = [{**OBJECTIVES[0], "unit": "min"}, OBJECTIVES[1]]
    front = paretour.plan_fleet(
        stops=STOPS[:5],
        objectives=[{**each, "matrix": COSTS[m][:5, :5]} for m, each in enumerate(minutes)],
        clock="time",
        vehicles=[{"id": "van", "start": 0, "end": 0, "shift": [0, 900]}],
        time_limit=0.2,
    )
    costs: Any = [{"to": [9] * 6, "from": [9] * 6}] * 2
    slots = [[100, 200], [900, 999]]
    offers = paretour.offer_slots(front, order={"id": "new", "costs": costs}, slots=slots)
    possible, late = offers.offers
    assert possible.replan is not None
    assert not late.possible
    taken: Any = paretour.replan(front, **possible.replan, time_limit=0.2)
    for plan in taken:
        route = plan.routes[0]
        assert 100 <= route.arrivals[list(route.stops).index("new")] <= 200
    with pytest.raises(paretour.Refused, match="POST /fleet, and one vehicle"):
        paretour.offer_slots(paretour.plan(coordinates=CITIES, time_limit=0), order={"id": "new"})


def test_an_optional_shipment_whose_vehicle_broke_down_is_left_out() -> None:
    minutes = [[0, 4, 5, 6], [4, 0, 3, 5], [5, 3, 0, 4], [6, 5, 4, 0]]
    van, bike = ({"id": name, "start": "depot", "end": "depot"} for name in ("van", "bike"))
    front = paretour.plan_fleet(
        stops=[
            {"id": "depot"},
            {"id": "from", "prize": 1000, "vehicle": "bike"},
            {"id": "to", "vehicle": "bike"},
            {"id": "other", "vehicle": "van"},
        ],
        shipments=[{"pickup": "from", "delivery": "to"}],
        vehicles=[van, bike],
        objectives=[
            {"name": "time", "matrix": minutes},
            {"name": "vehicles", "measure": "vehicles"},
        ],
        clock="time",
        time_limit=5,
    )
    number = [route.vehicle for route in front[0].routes].index("bike")
    gone = {"route": number, "broken_down": True, "position": "depot"}
    rest = paretour.replan(front, plan=0, now=1, routes=[gone], time_limit=5)
    assert [*rest[0].unassigned] == ["from", "to"]


def test_tours_are_replanned_and_so_is_what_was_replanned() -> None:
    front = paretour.plan(stops=STOPS, objectives=OBJECTIVES, time_limit=0.1)
    rest = paretour.replan(front, done=["stop-0"], remove=["stop-3"], time_limit=0.1)
    assert rest[0].stops is not None
    assert "stop-3" not in rest[0].stops
    assert len(paretour.replan(rest, remove=["stop-5"], time_limit=0.1))


def test_maps_are_covered_by_one_robot_and_by_two() -> None:
    request: Any = {
        "grid": np.zeros((8, 8), dtype=int),
        "cell_size": 1,
        "spacing": 3,
        "time_limit": 0.1,
    }
    assert len(paretour.plan_coverage(**request, cost_layer=np.ones((8, 8))))
    robots: Any = [{"id": "a", "start": 0}, {"id": "b", "start": 1}]
    assert len(paretour.plan_robots(**request, robots=robots))


def test_a_front_of_a_service_cannot_be_replanned_here() -> None:
    from paretour.values import parse_front

    from tests.helpers.answers import FRONT

    with pytest.raises(ValueError, match="planned in this process"):
        paretour.replan(parse_front(FRONT), done=[0])


def test_what_cannot_be_planned_is_refused_as_by_a_service() -> None:
    with pytest.raises(paretour.Refused) as raised:
        paretour.plan(coordinates=CITIES, seed=-1)
    assert raised.value.code == "invalid-request"
    assert raised.value.errors[0]["pointer"] == "/seed"


def test_ctrl_c_returns_the_best_front_so_far(monkeypatch: pytest.MonkeyPatch) -> None:
    from paretour.bars import Silent

    class PressCtrlC(Silent):
        def planning(self, seconds: float) -> Any:  # noqa: ARG002
            from contextlib import nullcontext

            return nullcontext(
                lambda _: signal.pthread_kill(threading.main_thread().ident, signal.SIGINT)
            )

    monkeypatch.setattr("paretour.library.Silent", PressCtrlC)
    front = paretour.plan(coordinates=np.random.default_rng(5).random((100, 4)), time_limit=10)
    assert (front.status, front.terminated) == ("cancelled", "cancelled")
    assert len(front)


def test_progress_is_a_bar_on_stderr(capsys: pytest.CaptureFixture[str]) -> None:
    paretour.plan(
        coordinates=np.random.default_rng(5).random((100, 4)), time_limit=1, progress=True
    )
    assert "hypervolume" in capsys.readouterr().err


def test_many_are_planned_in_order_in_processes_of_a_program_without_guard(tmp_path: Path) -> None:
    program = tmp_path / "program.py"
    program.write_text(
        "import numpy as np, paretour\n"
        "given = [np.random.default_rng(n).random((n, 4)) for n in (5, 7, 6, 8)]\n"
        "many = [{'coordinates': given[0]}, *given[1:]]\n"
        "fronts = paretour.plan_many(many, workers=2, progress=True, time_limit=0.05)\n"
        "print([front.tours.shape[1] for front in fronts])\n"
        "try:\n"
        "    paretour.plan_many([*many, {'coordinates': [[0, 0, 1, 1]], 'seed': -1}], workers=2)\n"
        "except paretour.InstanceFailed as error:\n"
        "    print(error.index, error.__cause__.code, error)\n"
    )
    done = subprocess.run(
        [sys.executable, program], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    shapes, failed = done.stdout.splitlines()
    assert shapes == "[5, 7, 6, 8]"
    assert failed.startswith("4 invalid-request instance 4: seed must be")
    assert "4/4" in done.stderr


MANY = """
import numpy as np, paretour
many = [{"coordinates": np.random.default_rng(n).random((200, 4))} for n in range(4)]
try:
    paretour.plan_many(many, workers=2, time_limit=60)
except paretour.InstanceFailed as error:
    print("failed", error)
except KeyboardInterrupt:
    print("interrupted")
"""


def _plans(process: psutil.Process) -> bool:
    """Whether a process is one of those that plan, and has been busy for a second."""
    with suppress(psutil.Error):  # it has just ended
        busy = sum(process.cpu_times()[:2])
        return "service.library.crew" in process.cmdline() and busy > 1
    return False


@contextmanager
def planning_many() -> Iterator[tuple[subprocess.Popen[bytes], list[psutil.Process]]]:
    """A program that plans many, and its processes, which have all begun."""
    command = [sys.executable, "-c", MANY]
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE) as program:
        try:
            begun = psutil.Process(program.pid).children
            while len(crew := [each for each in begun() if _plans(each)]) < 2:
                assert program.poll() is None
                time.sleep(0.05)
            yield program, crew
        finally:
            program.kill()


def test_ctrl_c_ends_all_who_plan_many() -> None:
    with planning_many() as (program, crew):
        program.send_signal(signal.SIGINT)
        printed, _ = program.communicate(timeout=120)
        assert printed == b"interrupted\n"
        assert not any(each.is_running() for each in crew)


def test_a_process_that_dies_names_its_instance_and_ends_the_others() -> None:
    with planning_many() as (program, crew):
        crew[1].kill()
        printed, _ = program.communicate(timeout=120)
        assert re.fullmatch(
            rb"failed instance [01]: its process ended with status -9\n", printed
        ), printed
        assert not any(each.is_running() for each in crew)


def test_none_are_planned_in_no_process() -> None:
    assert paretour.plan_many([]) == []
    with pytest.raises(ValueError, match="workers must be at least 1, got 0"):
        paretour.plan_many([{"coordinates": CITIES}], workers=0)


def test_the_import_loads_nothing_that_plans() -> None:
    code = (
        "import sys, paretour;"
        "sys.exit(len({'service', 'numba', 'scipy', 'onnxruntime', 'tqdm'} & set(sys.modules)))"
    )
    assert python(code).returncode == 0


def test_planning_here_loads_no_client_of_http() -> None:
    code = (
        "import sys, paretour; paretour.plan([[0, 0, 1, 1], [1, 0, 0, 1], [1, 1, 0, 0]]);"
        "assert not {'httpx', 'rich', 'starlette', 'fastapi'} & set(sys.modules);"
        "assert {'Client', '__version__'} <= set(dir(paretour)) and paretour.__version__;"
        "from paretour import *; assert Client and AsyncClient and Job and AsyncJob"
    )
    assert python(code).returncode == 0


@pytest.mark.parametrize(
    ("hidden", "call", "sentence"),
    [
        ("service", "plan(coordinates=[])", "install the whole package: pip install paretour"),
        ("service", "plan_many([])", "install the whole package: pip install paretour"),
        ("tqdm", "plan(progress=True)", "progress needs tqdm: pip install tqdm"),
    ],
)
def test_what_is_not_installed_is_named(hidden: str, call: str, sentence: str) -> None:
    code = f"""
import sys
class Hide:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] == {hidden!r}:
            raise ModuleNotFoundError(name, name=name)
sys.meta_path.insert(0, Hide())
import paretour
paretour.{call}
"""
    failed = python(code)
    assert failed.stderr.splitlines()[-1].endswith(sentence)
