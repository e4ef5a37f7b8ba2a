"""Ask which of a few options of a front is best, until the picks have led to a tour or plan."""

import json
import sys
from pathlib import Path
from typing import Any

from paretour import Front, FrontOfAnyKind
from paretour.kinds import kind_of
from paretour.questions import Option, Question
from rich.console import Console
from rich.prompt import Prompt

from service.cli.backends import RemoteBackend
from service.cli.data import print_csv, print_data
from service.cli.errors import UsageError, exit_on_error
from service.cli.inputs import read_front
from service.cli.options import Asking, Service
from service.cli.output import ids_of, labels_of, lengths_as_text, plans_as_rows, stops_of, table_of
from service.requests.questions import members_of

_BACK = "b"


def run_ask(source: str, asking: Asking, as_json: bool, service: Service) -> None:
    """Ask about a front, and print the tour or plan that the picks lead to.

    Picks that are not given are asked for at the terminal.

    Args:
        source: The id of a front of the service; without one the file of an answer.
        asking: The picks that are given, and how many questions and options there are.
        as_json: Whether to print what the service answers, which may be a question.
        service: The service, if one has the front.
    """
    console = Console(stderr=True)
    with exit_on_error():
        picks = _numbers(asking.picks or "")
        if service.url is None:
            front = read_front(Path(source))
        else:
            front = RemoteBackend(service.url, service.api_key).stored(source)
        question = _question(front, picks, asking)
        while question.left and not as_json:
            _show(front, question, asking.questions, console)
            picks = _picked(picks, question, console)
            question = _question(front, picks, asking)
        _print(front, question, as_json)
    if question.chosen is not None:
        noun, lengths = kind_of(front.document).item, front.lengths[question.chosen]
        said = f"{noun} {question.chosen}: {lengths_as_text(front, lengths)}"
        given = f"; the same again: --picks {_joined(picks)}" if picks else ""
        console.print(said + given, highlight=False, markup=False)


def _numbers(picks: str) -> list[int]:
    try:
        return [int(pick) for pick in picks.split(",") if picks]
    except ValueError:
        demand = "must be numbers of options with commas between, such as 0,2"
        raise UsageError(f"--picks {demand}, got {picks!r}") from None


def _question(front: FrontOfAnyKind, picks: list[int], asking: Asking) -> Question:
    try:
        return front.ask(picks, questions=asking.questions, options=asking.options)
    except ValueError as error:
        raise UsageError(f"--{error}") from None


def _show(front: FrontOfAnyKind, question: Question, questions: int, console: Console) -> None:
    """Print a question: for each option the range of each length of what is within reach."""
    kind = kind_of(front.document)
    rows = [
        (str(number), *_ranges(option), str(option.within_reach))
        for number, option in enumerate(question.options)
    ]
    console.print(
        f"Question {questions - question.left + 1} of {questions}. Where you stand:"
        f" {', '.join(_ranges(question.current))}. Each option is as good or better in everything:",
        highlight=False,
        markup=False,
    )
    console.print(table_of(("option", *labels_of(front), f"{kind.item}s within reach"), rows))


def _ranges(option: Option) -> list[str]:
    """Return the range of each length of what is within reach from a point."""
    pairs = zip(option.best, option.point, strict=True)
    return [f"{low:.6g}" if low == high else f"{low:.6g} to {high:.6g}" for low, high in pairs]


def _picked(picks: list[int], question: Question, console: Console) -> list[int]:
    """Return the picks with that of a question, which is asked for, or without the last one."""
    numbers = [str(number) for number in range(len(question.options))]
    demand = f"a pick is needed, 0 to {numbers[-1]}: --picks {_joined([*picks, 0])}"
    if not sys.stdin.isatty():
        raise UsageError(f"{demand}, or run it at a terminal")
    back = [_BACK] if picks else []
    said = f"Which one{', or b to go back' if back else ''}?"
    try:
        picked = Prompt.ask(said, choices=[*numbers, *back], console=console)
    except EOFError:
        raise UsageError(demand) from None
    return picks[:-1] if picked == _BACK else [*picks, int(picked)]


def _print(front: FrontOfAnyKind, question: Question, as_json: bool) -> None:
    kind, number = kind_of(front.document), question.chosen
    if as_json:
        chosen: dict[str, Any] = {}
        if number is not None:
            chosen = {kind.item: front.document["front"][number]}
        named = {name: front.document[name] for name in ("objectives",) if name in front.document}
        print_data(json.dumps({"front": front.id, **members_of(question), **named, **chosen}))
    elif isinstance(front, Front):
        print_csv([stops_of(front[number or 0].tour, ids_of(front))], delimiter=" ")
    else:
        print_csv(plans_as_rows(front, kind, [number or 0]))


def _joined(picks: list[int]) -> str:
    return ",".join(map(str, picks))
