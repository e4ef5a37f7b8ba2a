"""A request as vehicles of one profile have it."""

from typing import Any

from tests.fuzz.fleets_judged.timeline import Json


def driven_by(profile: str, request: Json) -> Json:
    """Return a request whose vehicles all drive by one profile."""

    def plain(item: Any) -> Any:
        if not isinstance(item, dict) or "matrices" not in item:
            return item
        [own] = [each for each in item["matrices"] if each["profile"] == profile]
        return {k: v for k, v in {**item, **own}.items() if k not in ("matrices", "profile")}

    vehicles = [{k: v for k, v in each.items() if k != "profile"} for each in request["vehicles"]]
    objectives = [plain(each) for each in request["objectives"]]
    clock = plain(request.get("clock"))
    return {**request, "vehicles": vehicles, "objectives": objectives, "clock": clock}
