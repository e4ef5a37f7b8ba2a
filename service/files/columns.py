"""Headings of columns: the field of a stop or a vehicle that each stands for, and its unit."""

import re
import unicodedata
from collections.abc import Mapping, Sequence

# By field, the names that people give it, the best names first; without accents, units and signs.
_NAMES = {
    "id": "id orderid stopid stringid orderno ordernumber ordernr order jobid nodeid customerid"
    " customerno custno deliveryid shipmentid bestellnummer auftragsnummer kundennummer auftrag"
    " stop ref reference code key name stopname customer kunde node city label site no nr number",
    "longitude": "longitude lon lng long longitud laengengrad langengrad laenge lange lond",
    "latitude": "latitude lat latitud breitengrad breite latd",
    "place": "wkt wktgeom geom geometry thegeom point location coordinates coords coordinate latlon"
    " latlng latlong position gps",
    "x": "x xcoord coordx xcoordinate xc xpos posx easting rechtswert ost",
    "y": "y ycoord coordy ycoordinate yc ypos posy northing hochwert nord",
    "demand": "demand qty quantity load amount pallets parcels boxes items weight volume menge"
    " bedarf gewicht demanda cantidad kg",
    "window_from": "windowfrom windowstart timewindowstart timewindowfrom timefrom starttime "
    " twstart twfrom twopen readytime ready earliest open opens opening from begin von start",
    "window_to": "windowto windowend timewindowend timewindowto timeto endtime twend twto twclose"
    " duedate duetime due latest close closes closing to until end bis",
    "window": "window timewindow tw deliverywindow zeitfenster",
    "service": "service duration servicetime serviceduration stoptime handlingtime dwell"
    " servicezeit standzeit",
    "skills": "skills skill",
    "prize": "prize",
    "cost": "cost costs risk danger exposure co2 emissions kosten risiko",
}
_AMOUNTS = _NAMES["demand"].split()
_TOLD_BY = {
    "id": "vehicleid vehicle vehiclename vehicletype truckid truck driverid driver van fahrzeug"
    " fahrer",
    "capacity": "capacity vehiclecapacity maxcapacity payload kapazitaet kapazitat nutzlast "
    + " ".join(f"max{each} capacity{each} {each}capacity" for each in _AMOUNTS),
    "shift_from": "shiftstart shiftfrom shiftbegin workstart schichtbeginn",
    "shift_to": "shiftend shiftto workend schichtende",
    "shift": "shift workinghours workhours schicht arbeitszeit",
    "longest_time": "maxtime maxtraveltime maxdrivingtime maxduration maxrouteduration",
    "longest_distance": "maxdistance maxdistancekm maxkm range rangekm",
    "fixed": "fixed fixedcost fixedcosts costfixed fixkosten",
    "per_km": "costperkm costkm kmcost perkm priceperkm kmkosten",
}  # fields that only vehicles have
_NAMES_OF_VEHICLES = {
    "start": "start startid startstop startplace startlocation startdepot",
    "end": "end endid endstop endplace endlocation enddepot destination",
    "depot": "depot depotid home base",
    "start_latitude": "startlatitude startlat",
    "start_longitude": "startlongitude startlon startlng",
    "end_latitude": "endlatitude endlat",
    "end_longitude": "endlongitude endlon endlng",
    "depot_latitude": "depotlatitude depotlat homelatitude homelat latitude lat",
    "depot_longitude": "depotlongitude depotlon depotlng homelongitude homelon homelng longitude"
    " lon lng",
    **_TOLD_BY,
    "id": f"{_TOLD_BY['id']} id name type",
    "capacity": f"{_TOLD_BY['capacity']} {_NAMES['demand']}",
    "shift_from": f"{_TOLD_BY['shift_from']} {_NAMES['window_from']}",
    "shift_to": f"{_TOLD_BY['shift_to']} {_NAMES['window_to']}",
    "shift": f"{_TOLD_BY['shift']} {_NAMES['window']}",
    "count": "count vehicles available anzahl",
    "skills": "skills skill",
}
_PLACES = ("longitude", "latitude", "x", "y")
_BEFORE = re.compile(r"^(stop|geo|gps|location|customer|address|position|pos|point)(?=l)")
_AFTER = re.compile(r"(deg|degree|degrees|wgs84|dd|decimal)$")
_UNIT = re.compile(r"[\[(](.*?)[\])]")
_SECONDS = {"s": 1, "sec": 1, "min": 60, "mins": 60, "minutes": 60, "h": 3600, "hours": 3600}
_SEVERAL = ("demand", "capacity")  # fields that a table may have several times
FLEET = ("demand", "window_from", "window_to", "window", "service", "skills", "prize")


def fields_of(heading: Sequence[str]) -> list[str | None]:
    """Return the field of stops that each column may be, or None.

    Only demand may come several times. Of two columns for any other field, the one whose name
    comes first in `_NAMES` gets it, and the other one gets None.
    """
    return _taken(heading, _NAMES)


def fields_of_vehicles(heading: Sequence[str]) -> list[str | None]:
    """Return the field of vehicles that each column may be; only capacity may come several times.

    Columns `start` and `end` may be times of a shift instead: their contents decide.
    """
    return _taken(heading, _NAMES_OF_VEHICLES)


def is_about_vehicles(heading: Sequence[str]) -> bool:
    """Return whether a heading has columns of vehicles alone, and none of stops alone."""
    stops, told = fields_of(heading), set(_taken(heading, _TOLD_BY))
    located = {"latitude", "x", "place"} & set(stops)
    return bool(told - ({"id", None} if located else {None})) and "demand" not in stops


def amount_of(name: str) -> str:
    """Return the amount that a column of demands or capacities is about, as `weight`, or ""."""
    plain = plain_name(name)
    forms = ("{}", "max{}", "capacity{}", "{}capacity")
    return next((each for each in _AMOUNTS for form in forms if form.format(each) == plain), "")


def _taken(heading: Sequence[str], names: Mapping[str, str]) -> list[str | None]:
    ranks = [_rank(plain_name(name), names) for name in heading]
    taken: list[str | None] = [None] * len(heading)
    for at in sorted(range(len(heading)), key=lambda at: (ranks[at][1], at)):
        field = ranks[at][0]
        if field in _SEVERAL or field not in taken:
            taken[at] = field
    return taken


def seconds_of(name: str) -> int | None:
    """Return the seconds of the unit in a heading, as in `service [min]`; None without a unit."""
    unit = _UNIT.search(name)
    plain = unit[1].strip().casefold() if unit else re.split(r"[\s_]", name.casefold())[-1]
    return _SECONDS.get(plain)


def _rank(plain: str, names: Mapping[str, str]) -> tuple[str | None, int]:
    for field, words in names.items():
        known = words.split()
        for name in (plain, _AFTER.sub("", _BEFORE.sub("", plain))):
            if name in known and (name == plain or field in _PLACES):
                return field, known.index(name)
    return None, 0


def plain_name(name: str) -> str:
    """Return a heading without its unit, reduced to small letters and digits."""
    decomposed = unicodedata.normalize("NFKD", _UNIT.sub("", name).casefold()[:200])
    words = re.sub(r"[^a-z0-9]+", " ", re.sub(r"[\u0300-\u036f]", "", decomposed)).split()
    kept = words[:-1] if len(words) > 1 and words[-1] in _SECONDS else words
    return "".join(kept)
