"""The policy of turns in its own words, to compare the queues of both engines with."""

from hypothesis import strategies as st

# A letter is a submission of that client, a full stop a turn, a minus the end of the oldest run.
EVENTS = st.text("abcd...-", max_size=40)


def clients_by_policy(events: str) -> str:
    """Return the clients in the order of their turns."""
    waiting: list[str] = []
    running: list[str] = []
    turns: list[str] = []
    for event in events:
        if event == "-":
            del running[:1]
        elif event != ".":
            waiting.append(event)
        elif waiting:
            client = _next(waiting, running, turns)
            waiting.remove(client)
            running.append(client)
            turns.append(client)
    return "".join(turns)


def _next(waiting: list[str], running: list[str], turns: list[str]) -> str:
    candidates = [each for each in waiting if each not in running] or waiting
    newcomers = [each for each in candidates if each not in turns]
    return newcomers[0] if newcomers else max(candidates, key=lambda each: turns[::-1].index(each))
