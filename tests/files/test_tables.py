"""Tables as people bring them: small files, and what each must become, or the question it raises.

Headings and cells are those of spreadsheets and of route planners; names and places are invented.
"""
# ruff: noqa: E501  a table

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import pytest
from pydantic_core import to_json

from service.files.reader import read_files
from service.files.reading import Bounds, NamedFile, Reading, UnreadableFile
from service.kinds.parsing import parse_task
from service.requests.task import TaskSource
from tests.files.test_examples import ACTORS
from tests.helpers.serving import LIMITS

DEPOT = "depot,60.171,24.941"


@dataclass(frozen=True)
class Becomes:
    """What tables must become: members of all stops, members of the request, sentences of notes."""

    ids: str = ""
    members: Mapping[str, Any] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    stops: Mapping[str, list[Any]] = field(default_factory=dict)


def stops(ids: str, *notes: str, request: Mapping[str, Any] | None = None, **each: Any) -> Becomes:
    """Return what becomes stops with these ids, members and notes, and with these of a request."""
    return Becomes(ids, request or {}, notes, each)


def planes(*rows: list[float], notes: tuple[str, ...] = ()) -> Becomes:
    return Becomes(members={"coordinates": list(rows)}, notes=notes)


ORDERS = "order,lat,lon,from,to,service (min)\n"
ORDERS += "1,60.169,24.952,09:00,11:00,15\n2,60.165,24.933,10:00,12:00,10\n"
WINDOWS = [[32400, 39600], [36000, 43200]]
LOADED = f"id,lat,lon,demand\n{DEPOT},0\na,60.169,24.952,2\nb,60.165,24.933,3\n"
TSV = "id\tlat\tlon\tweight\ndepot\t60.171\t24.941\t0\na\t60.169\t24.952\t1,250\n"
SIGNS: dict[str, tuple[list[str], Becomes | str]] = {
    "thousands beside degrees with points": (
        [f"{TSV}b\t60.165\t24.933\t900\n"],
        stops("depot a b", "'weight' has thousands signs: '1,250' is 1250", demand=[None, [1250], [900]]),
    ),
    "thousands beside degrees with commas": (
        ["id;lat;lon;weight\na;60,169;24,952;1.250\nb;60,165;24,933;900\n"],
        stops("a b", "'weight' has thousands signs: '1.250' is 1250", demand=[[1250], [900]]),
    ),
    "vans of the same request": (
        [LOADED, 'vehicle,count,capacity\nvan,2,"1,500"\n'],
        stops("depot a b", "'capacity' has thousands signs: '1,500' is 1500",
              request={"vehicles": [{"id": "van", "count": 2, "capacity": [1500], "start": "depot", "end": "depot"}]}),
    ),
    "German vans beside English orders": (
        [LOADED, "vehicle;cost per km;fixed cost\nvan;0,5;1.500\n"],
        stops("depot a b", "'fixed cost' has thousands signs: '1.500' is 1500"),
    ),
    "a decimal comma in the column": (
        ["id;x;y;weight\na;0;1;1,250\nb;1;2;2,5\n"],
        stops("a b", demand=[[125], [250]]),
    ),
    "thousands twice": (
        ["id\tx\ty\tweight\na\t0\t1\t1.250.000\nb\t1\t2\t2.500\n"],
        "row 2, column 'weight' must be 0 to 1,000,000",
    ),
    "both signs": (
        ["id;x;y;weight\na;0;1;1.250,5\nb;1;2;2.500\n"],
        stops("a b", "'weight' has thousands signs: '1.250,5' is 1250.5", demand=[[12505], [25000]]),
    ),
    "Swiss thousands": (
        ["id;x;y;weight\na;0;1;1'250\nb;1;2;900\n"],
        stops("a b", "'weight' has thousands signs", demand=[[1250], [900]]),
    ),
    "French thousands": (
        ["id;x;y;poids\na;0;1;1 250\nb;1;2;1\u202f900\n"],
        stops("a b", "'poids' has thousands signs: '1 250' is 1250", demand=[[1250], [1900]]),
    ),
    "semicolons alone say that commas are decimal": (
        ["id;x;y;weight\na;0;1;1,250\nb;1;2;900\n"],
        stops("a b", "'weight' has decimal commas: '1,250' is 1.25", demand=[[125], [90000]]),
    ),
    "decimals of programs": (
        ["id,x,y,weight\na,0,1,1.250\nb,1,2,3.125\n"],
        stops("a b", demand=[[1250], [3125]]),
    ),
    "nothing says which sign it is": (
        ["id\tx\ty\tweight\na\t0\t1\t1,250\nb\t1\t2\t900\n"],
        "column 'weight' has numbers such as '1,250', which may be 1.25 or 1250: write them",
    ),
    "the other sign": (
        ["id;x;y;weight\na;0;1;1.250\nb;1;2;900\n"],
        "column 'weight' has numbers such as '1.250', which may be 1250 or 1.25: write them",
    ),
    "vans alone do not say it": (
        ["id,x,y,demand\na,0,1,3\nb,1,2,4\n", 'vehicle,capacity\nvan,"1,500"\n'],
        "1.csv: column 'capacity' has numbers such as '1,500', which may be 1.5 or 1500",
    ),
    "columns of a file that disagree": (
        ["id;lat;lon;weight;volume\na;60.17;24.95;1,250;2,5\nb;60.16;24.93;900;3,5\n"],
        "column 'weight' has numbers such as '1,250', which may be 1.25 or 1250",
    ),
    "a phone number is not asked about": (
        ["id\tx\ty\tu\tv\tphone\na\t0\t1\t2\t3\t040,123\nb\t1\t2\t3\t4\t040,125\n"],
        stops("a b", "Not used: 'phone'"),
    ),
    "planes": (
        ["x1;y1;x2;y2\n1.234,5;2;3;4\n1.000;2;3;4\n"],
        planes([1234.5, 2, 3, 4], [1000, 2, 3, 4], notes=("'x1' has thousands signs",)),
    ),
}  # fmt: skip
NUMBERS = "got columns of numbers"
PLANES: dict[str, tuple[list[str], Becomes | str]] = {
    "an id that counts, and five numbers": (
        ["0 40 50 0 0 1236\n1 45 68 10 912 967\n2 45 70 30 825 870\n"],
        f"{NUMBERS}, '2', '3', '4', '5', '6', which may be anything",
    ),
    "an id that counts, a point and a demand": (
        ["1,40,50,3\n2,45,68,5\n3,45,70,7\n"],
        f"{NUMBERS}, '2', '3', '4', which may be anything",
    ),
    "a place, a demand and a service": (
        ["60.171,24.941,0,0\n60.169,24.952,2,300\n60.165,24.933,3,600\n"],
        f"{NUMBERS}, '1', '2', '3', '4', which may be anything",
    ),
    "two places": (
        ["60.171,24.941,60.152,24.881\n60.169,24.952,60.148,24.872\n"],
        f"{NUMBERS}, '1', '2', '3', '4', which may be anything",
    ),
    "a point, a size and a constant": (
        ["12,40,3,10\n77,68,5,10\n35,70,7,10\n"],
        f"{NUMBERS}, '1', '2', '3', '4', which may be anything",
    ),
    "headings of goods": (
        ["price,stock,length,width\n1,2,3,4\n5,6,7,8\n"],
        f"{NUMBERS}, 'price', 'stock', 'length', 'width', which may be anything",
    ),
    "headings of two places": (
        ["pickup_lat,pickup_lon,dropoff_lat,dropoff_lon\n60.1,24.1,60.2,24.2\n60.3,24.1,60.2,24.2\n"],
        f"{NUMBERS}, 'pickup_lat', 'pickup_lon', 'dropoff_lat', 'dropoff_lon', which may be",
    ),
    "one latitude twice": (
        ["pickup_lat,dropoff_lat\n60.1,60.2\n60.3,60.2\n"],
        f"{NUMBERS}, 'pickup_lat', 'dropoff_lat', which may be anything",
    ),
    "one plane beside goods": (
        ["x,y,price,stock\n1,2,3,4\n5,6,7,8\n"],
        f"{NUMBERS}, 'x', 'y', 'price', 'stock', which may be anything",
    ),
    "the year and a yield are no y": (
        ["x,year,xs,yield\n1,2,3,4\n5,6,7,8\n"],
        f"{NUMBERS}, 'x', 'year', 'xs', 'yield', which may be anything",
    ),
    "planes that are called so": (
        ["x1,y1,x2,y2\n1,2,3,4\n5,6,7,8\n"],
        planes([1, 2, 3, 4], [5, 6, 7, 8]),
    ),
    "planes whose x come first": (
        ["x1,x2,y1,y2\n1,3,2,4\n5,7,6,8\n"],
        planes([1, 2, 3, 4], [5, 6, 7, 8], notes=("'x2' (second x), 'y1' (y)",)),
    ),
    "planes beside a price": (
        ["X (m),Y (m),u,v,price\n1,2,3,4,9\n5,6,7,8,9\n"],
        planes([1, 2, 3, 4], [5, 6, 7, 8], notes=("Not used: 'price'",)),
    ),
    "three planes": (
        ["x_a,y_a,x_b,y_b,x_c,y_c\n1,2,3,4,5,6\n5,6,7,8,9,1\n"],
        planes([1, 2, 3, 4, 5, 6], [5, 6, 7, 8, 9, 1]),
    ),
    "numbers alone that are alike": (
        ["0.12 0.55 0.91 0.33\n0.97 0.05 0.42 0.78\n0.3 0.61 0.08 0.4\n"],
        planes([0.12, 0.55, 0.91, 0.33], [0.97, 0.05, 0.42, 0.78], [0.3, 0.61, 0.08, 0.4],
               notes=("4 columns without names were taken for x and y of 2 planes",)),
    ),
    "two lists of places with numbers": (
        ["1 565.0 575.0\n2 25.0 185.0\n3 345.0 750.0\n", "1 5 75\n2 25 15\n3 45 50\n"],
        Becomes("1 2 3", notes=()),
    ),
    "two squares of costs, one of which counts": (
        ["0 1 2\n1 0 3\n2 3 0\n", "0 5 6\n5 0 7\n6 7 0\n"],
        Becomes(members={"matrices": [[[0, 1, 2], [1, 0, 3], [2, 3, 0]], [[0, 5, 6], [5, 0, 7], [6, 7, 0]]]}),
    ),
    "coordinates pasted": (
        ["60.171, 24.941\n60.169, 24.952\n"],
        stops("1 2", "Two columns without names were taken for latitude, then longitude",
              location=[[24.941, 60.171], [24.952, 60.169]]),
    ),
    "coordinates pasted, longitude first": (
        ["139.767\t35.681\n139.700\t35.690\n"],
        stops("1 2", "taken for longitude, then latitude", location=[[139.767, 35.681], [139.7, 35.69]]),
    ),
    "names and coordinates pasted": (
        ["Depot,Main St 1,60.171,24.941\nAnn,Side St 2,60.169,24.952\n"],
        stops("Depot Ann", "Not used: '2'", location=[[24.941, 60.171], [24.952, 60.169]]),
    ),
    "numbers and coordinates pasted": (
        ["1;60,171;24,941\n2;60,169;24,952\n3;60,165;24,933\n"],
        stops("1 2 3", "taken for latitude", location=[[24.941, 60.171], [24.952, 60.169], [24.933, 60.165]]),
    ),
}  # fmt: skip
ANYWHERE = "is an order: vehicles start and end at any stop. Where do they start?"
DEPOTS: dict[str, tuple[list[str], Becomes | str]] = {
    "no row is a depot": (
        [ORDERS],
        stops("1 2", ANYWHERE, window=WINDOWS, service=[900, 600], request={"vehicles": [{"id": "vehicle"}]}),
    ),
    "vans do not say where they start": (
        [ORDERS, "vehicle,count,shift start,shift end\nv1,2,08:00,17:00\n"],
        stops("1 2", ANYWHERE, window=WINDOWS, service=[900, 600],
              request={"vehicles": [{"id": "v1", "count": 2, "shift": [28800, 61200]}]}),
    ),
    "the window of an order is no shift": (
        [ORDERS, "vehicle,count\nv1,2\n"],
        stops("1 2", ANYWHERE, window=WINDOWS, request={"vehicles": [{"id": "v1", "count": 2}]}),
    ),
    "a van starts at an order": (
        [ORDERS, "vehicle,start,end\nv1,1,1\n"],
        stops("1 2 1_(depot)", "'1', which are orders as well", window=[*WINDOWS, None], service=[900, 600, None],
              request={"vehicles": [{"id": "v1", "start": "1 (depot)", "end": "1 (depot)"}]}),
    ),
    "a van starts at an order in a plane": (
        ["id,x,y,demand\na,0,1,3\nb,1,2,4\n", "vehicle,start,end,capacity\nv1,a,a,9\n"],
        stops("a b a_(depot)", "which are orders as well", demand=[[3], [4], None]),
    ),
    "the last row is the depot": (
        [f"{ORDERS}Depot,60.171,24.941,,,\n"],
        stops("1 2 Depot", "from and to 'Depot'", window=[*WINDOWS, None],
              request={"vehicles": [{"id": "vehicle", "start": "Depot", "end": "Depot"}]}),
    ),
    "the last row is the depot, though the first has no window": (
        ["id,lat,lon,from,to\n1,60.169,24.952,,\n2,60.165,24.933,9:00,11:00\nWarehouse,60.171,24.941,,\n"],
        stops("1 2 Warehouse", request={"vehicles": [{"id": "vehicle", "start": "Warehouse", "end": "Warehouse"}]}),
    ),
    "two depots that are not first": (
        [f"{ORDERS}Depot 1,60.171,24.941,,,\nDepot 2,60.172,24.943,,,\n"],
        stops("1 2 Depot_1 Depot_2", ANYWHERE),
    ),
    "the opening hours of a warehouse are a shift": (
        ["name,lat,lon,open,close\nMain warehouse,60.171,24.941,06:00,20:00\nAnn,60.169,24.952,09:00,11:00\n"],
        stops("Main_warehouse Ann", window=[None, WINDOWS[0]],
              request={"vehicles": [{"id": "vehicle", "start": "Main warehouse", "end": "Main warehouse", "shift": [21600, 72000]}]}),
    ),
    "a row alone without demand is a depot": (
        ["id,x,y,demand,ready,due\n0,0,0,0,0,100\n1,3,4,2,10,40\n2,6,8,1,20,60\n"],
        stops("0 1 2", request={"vehicles": [{"id": "vehicle", "capacity": [3], "start": "0", "end": "0", "shift": [0, 100]}]}),
    ),
    "a row with a service is an order, though it has no demand": (
        ["id,lat,lon,demand,service [min]\na,60.171,24.941,,5\nb,60.169,24.952,2,5\n"],
        stops("a b", ANYWHERE, service=[300, 300]),
    ),
    "a row with a customer is an order": (
        ["id,lat,lon,customer,demand\n7,60.171,24.941,Ann Lee,\n8,60.169,24.952,Bo,2\n"],
        stops("7 8", ANYWHERE),
    ),
    "a first row without demand is where vans start, with a note": (
        ["order,lat,lon,qty\n1,60.171,24.941,0\n2,60.169,24.952,3\n", "vehicle,capacity\nv,9\n"],
        stops("1 2", "'1' has nothing to deliver or visit, so vehicles start and end there"),
    ),
    "a shop is no depot": (
        ["name,lat,lon,open,close\nThe Home Depot,60.171,24.941,06:00,20:00\nAnn,60.169,24.952,09:00,11:00\n"],
        stops("The_Home_Depot Ann", ANYWHERE, window=[[21600, 72000], WINDOWS[0]]),
    ),
    "a depot loses its service with a note": (
        ["id,lat,lon,service [min]\ndepot,60.171,24.941,20\na,60.169,24.952,5\n"],
        stops("depot a", "'depot' is a depot, so its service was not used", service=[None, 300]),
    ),
    "a type says what is a depot": (
        ["id,type,lat,lon,open,close\n1,Depot,60.171,24.941,06:00,20:00\n2,Order,60.169,24.952,09:00,11:00\n"],
        stops("1 2", window=[None, WINDOWS[0]], request={"vehicles": [{"id": "vehicle", "start": "1", "end": "1", "shift": [21600, 72000]}]}),
    ),
}  # fmt: skip
DUE = f"id,lat,lon,due\n{DEPOT},\na,60.169,24.952,{{}}\nb,60.165,24.933,{{}}\n"
FROM = f"id,lat,lon,from,to\n{DEPOT},,\na,60.169,24.952,{{}},{{}}\n"
WINDOW = f"id,lat,lon,window\n{DEPOT},\na,60.169,24.952,{{}}\n"
DATES: dict[str, tuple[list[str], Becomes | str]] = {
    "a day to be due on": (
        [DUE.format("2026-11-30", "2026-11-30")],
        stops("depot a b", "'due' has dates without times: 2026-11-30 is the end of that day", due=[None, 86400, 86400]),
    ),
    "days to be due on": (
        [DUE.format("2026-11-30", "2026-12-02")],
        stops("depot a b", "Times count from 2026-11-30 0:00, the first date: 2026-12-02 0:00 is 48:00", due=[None, 86400, 259200]),
    ),
    "midnights of a spreadsheet": (
        [DUE.format("2026-11-30 00:00:00", "2026-12-01 00:00")],
        stops("depot a b", "is the end of that day", due=[None, 86400, 172800]),
    ),
    "a midnight beside another time": (
        [DUE.format("2026-11-30 00:00", "2026-11-30 10:00")],
        stops("depot a b", "Dates, as 2026-11-30, were not used", due=[None, 0, 36000]),
    ),
    "German dates": (
        [DUE.format("30.11.2026 10:00", "1.12.2026 9:30")],
        stops("depot a b", "2026-12-01 0:00 is 24:00", due=[None, 36000, 120600]),
    ),
    "British dates": (
        [DUE.format("30/11/2026 10:00", "1/12/2026 9:30")],
        stops("depot a b", "2026-12-01 0:00 is 24:00", due=[None, 36000, 120600]),
    ),
    "American dates": (
        [DUE.format("11/30/2026 8:00 AM", "12/1/2026 1:30:00 PM")],
        stops("depot a b", "Times count from 2026-11-30", due=[None, 28800, 135000]),
    ),
    "dates of either order": (
        [DUE.format("01/02/2026", "03/02/2026")],
        "column 'due' has dates such as '01/02/2026', which may be 2026-02-01 or 2026-01-02",
    ),
    "dates beside times": (
        [f"id,lat,lon,Delivery Date,from,to\n{DEPOT},,,\na,60.169,24.952,2026-11-30,9:00,11:00\nb,60.165,24.933,2026-12-01,9:00,11:00\n"],
        stops("depot a b", "'Delivery Date' has several dates, which were not used: all is of one day"),
    ),
    "no date": ([DUE.format("2026-02-30", "2026-02-01")], "must have dates of the calendar, got '2026-02-30'"),
    "one time zone": (
        [DUE.format("2026-11-30T10:00:00+02:00", "2026-11-30T11:00:00+02:00")],
        stops("depot a b", "Times are those of UTC+02:00", due=[None, 36000, 39600]),
    ),
    "two time zones": (
        [DUE.format("2026-11-30T10:00:00Z", "2026-11-30T11:00:00+02:00")],
        stops("depot a b", "Times are those of UTC", due=[None, 36000, 32400]),
    ),
    "a time zone beside none": (
        [DUE.format("2026-11-30T10:00:00Z", "2026-11-30T11:00:00")],
        "column 'due' has a time with a time zone, '2026-11-30T10:00:00Z', beside one without",
    ),
    "a time zone in one file alone": (
        [DUE.format("2026-11-30T10:00Z", "2026-11-30T11:00Z"), "vehicle,shift start,shift end\nvan,8:00,16:00\n"],
        "beside one without, '8:00' in column 'shift start'",
    ),
    "after midnight": ([DUE.format("25:00", "26:30")], stops("depot a b", due=[None, 90000, 95400])),
    "after midnight, as planners write it": ([DUE.format("1:30 am (+1)", "23:00")], stops("depot a b", due=[None, 91800, 82800])),
    "no minute": ([DUE.format("10:75", "9:00")], "column 'due' must be seconds, or a time as 10:30"),
    "milliseconds": ([DUE.format("36000000", "39600000")], "not milliseconds or Unix time, got '36000000'"),
    "Unix time": ([DUE.format("1796032800", "1796036400")], "not milliseconds or Unix time, got '1796032800'"),
    "a window over midnight": (
        [FROM.format("2026-11-30 22:00", "2026-12-01 02:00")],
        stops("depot a", "Times count from 2026-11-30", window=[None, [79200, 93600]]),
    ),
    "a window of whole days": (
        [FROM.format("2026-11-30", "2026-12-01")],
        stops("depot a", "2026-11-30 is the begin", "2026-12-01 is the end", window=[None, [0, 172800]]),
    ),
    "a window with dates in one cell": (
        [WINDOW.format("2026-11-30 08:00 - 2026-11-30 12:00")],
        stops("depot a", window=[None, [28800, 43200]]),
    ),
    "an interval as programs write it": (
        [WINDOW.format("2026-11-30T08:00:00Z/2026-11-30T12:00:00Z")],
        stops("depot a", "UTC", window=[None, [28800, 43200]]),
    ),
    "a window with its date once": (
        [WINDOW.format("30.11.2026 08:00 - 12:00")],
        stops("depot a", window=[None, [28800, 43200]]),
    ),
    "a window is no time with a time zone": ([DUE.format("10:30-11:00", "9:00")], "column 'due' must be seconds"),
    "a shift and orders of two days": (
        [DUE.format("2026-11-30 10:00", "2026-12-01 10:00"), "van,shift start,shift end\nv,2026-11-30 8:00,2026-12-01 16:00\n"],
        stops("depot a b", due=[None, 36000, 122400], request={"vehicles": [{"id": "v", "shift": [28800, 144000], "start": "depot", "end": "depot"}]}),
    ),
    "an earliest time alone": (
        [FROM.format("10:30", "")],
        stops("depot a", "Windows without an end are open until midnight, as that of row 3", window=[None, [37800, 86400]]),
    ),
    "an earliest time without a column of latest ones": (
        [f"id,lat,lon,Earliest Time\n{DEPOT},\na,60.169,24.952,10:30\n"],
        stops("depot a", "open until midnight", window=[None, [37800, 86400]]),
    ),
}  # fmt: skip
PLACES = ["60.171,24.941", "60.169,24.952", "60.165,24.933"]
HEADINGS: dict[str, tuple[list[str], Becomes | str]] = {
    "OptimoRoute": (
        ["Order ID,Latitude,Longitude,Time window from,Time window to,Duration,Load #1,Load #2,Priority\n"
         f"D1,{PLACES[0]},,,,,,M\nA,{PLACES[1]},08:00,15:00,15,2,1.5,H\nB,{PLACES[2]},,,5,1,1,L\n"],
        stops("D1 A B", "'Duration' is in minutes, 15 at most", "Not used: 'Priority'",
              demand=[None, [20, 15], [10, 10]], service=[None, 900, 300], window=[None, [28800, 54000], None]),
    ),
    "Circuit": (
        ["Address Line 1,City,Latitude,Longitude,Earliest Time,Latest Time,Time at stop\n"
         f"Main St 1,Espoo,{PLACES[0]},08:30,15:30,5\nSide St 2,Espoo,{PLACES[1]},10:30,,2\nSide St 3,Vantaa,{PLACES[2]},,,2\n"],
        stops("1 2 3", "'Time at stop' is in minutes, 5 at most", "open until midnight", "No column has names of stops",
              "Not used: 'Address Line 1', 'City'", window=[[30600, 55800], [37800, 86400], None], service=[300, 120, 120]),
    ),
    "Route4Me": (
        ["Alias,Lat,Lng,Order Weight,Order Cube,Time Window Start,Time Window End,Service Time\n"
         f"Depot,{PLACES[0]},,,,,\nAnn,{PLACES[1]},12,1,9:00 AM,5:00 PM,10\nAnn,{PLACES[2]},8,1,,,10\n"],
        stops("Depot Ann Ann_2", "'Alias' has names that come twice, or none: they are numbered, as 'Ann 2'",
              demand=[None, [12, 1], [8, 1]], service=[None, 600, 600], window=[None, [32400, 61200], None]),
    ),
    "Routific": (
        ["name,lat,lng,start,end,duration,load,type\n"
         f"Depot,{PLACES[0]},,,,,\nAnn,{PLACES[1]},9:00,12:00,10,2,A\nBo,{PLACES[2]},,,5,1,B\n"],
        stops("Depot Ann Bo", "'duration' is in minutes", "Not used: 'type'", demand=[None, [2], [1]],
              service=[None, 600, 300], window=[None, [32400, 43200], None]),
    ),
    "Shopify, a row for each item": (
        ["Name,Email,Lineitem quantity,Shipping City,Latitude,Longitude,Total\n"
         f"#1001,ann@example.com,2,Helsinki,{PLACES[0]},20.50\n#1001,,1,,{PLACES[0]},\n#1002,bo@example.com,3,Espoo,{PLACES[1]},8.00\n"],
        stops("#1001 #1001_2 #1002", "'Name' has names that come twice", demand=[[2], [1], [3]]),
    ),
    "WooCommerce": (
        ["Order Number,Order Total,Total Items,Customer Note,Latitude,Longitude\n"
         f"501,20.50,2,ring twice,{PLACES[0]}\n502,8.00,1,,{PLACES[1]}\n"],
        stops("501 502", "'Total Items' (demand)", "Not used: 'Order Total', 'Customer Note'", demand=[[2], [1]]),
    ),
    "AntsRoute": (
        ["Id,Name,City,Latitude,Longitude,Duration,Open-date,Due-date\n"
         f"20180101-1,Ann,London,{PLACES[0]},30,2026-11-30,2026-12-01\n20180101-2,Bo,London,{PLACES[1]},20,2026-11-30,2026-11-30\n"],
        stops("20180101-1 20180101-2", "Not used: 'Name', 'City'", "'Duration' is in minutes", window=[[0, 172800], [0, 86400]]),
    ),
    "Onfleet": (
        ["Recipient_Name,Latitude,Longitude,completeAfter,completeBefore,quantity,serviceTime\n"
         f"Ann,{PLACES[0]},2026-11-30 09:00,2026-11-30 12:00,1,3\nAnn,{PLACES[1]},,,2,3\n"],
        stops("1 2", "'serviceTime' is in minutes, 3 at most", window=[[32400, 43200], None], service=[180, 180]),
    ),
    "Track-POD": (
        ["Order No,Latitude,Longitude,Time from,Time to,Weight (kg),Pallets,Service time (min)\n"
         f"1,{PLACES[0]},08:00,10:00,10.5,1,5\n2,{PLACES[1]},08:00,12:00,3,1,5\n"],
        stops("1 2", demand=[[105, 10], [30, 10]], service=[300, 300], window=[[28800, 36000], [28800, 43200]]),
    ),
    "WorkWave": (
        ["Name,Latitude,Longitude,Load,Service Time,Time Window Start,Time Window End\n"
         f"Ann,{PLACES[0]},2,10,10:00pm,1:30am (+1)\nBo,{PLACES[1]},1,5,,\n"],
        stops("Ann Bo", demand=[[2], [1]], service=[600, 300], window=[[79200, 91800], None]),
    ),
    "Google My Maps": (
        ['WKT,name,description\n"POINT (24.941 60.171)",Ann,ring twice\n"POINT (24.952 60.169)",Ann,\n'],
        stops("Ann Ann_2", "Not used: 'description'", location=[[24.941, 60.171], [24.952, 60.169]]),
    ),
    "points in a heading": (
        [f"ref,point.lat,point.lon,service_duration_s,Point of contact\na,{PLACES[0]},150,Ann\nb,{PLACES[1]},150,Bo\n"],
        stops("a b", "Not used: 'Point of contact'", service=[150, 150]),
    ),
    "names of points": ([f"Point,Lat,Lon\nHarbour,{PLACES[0]}\nStation,{PLACES[1]}\n"], stops("Harbour Station")),
    "cities alone": ([f"City,Lat,Lon,Population\nEspoo,{PLACES[0]},300000\nVantaa,{PLACES[1]},250000\n"], stops("Espoo Vantaa")),
    "a city twice": (
        [f"City,Lat,Lon,Demand\nEspoo,{PLACES[0]},2\nEspoo,{PLACES[1]},1\n"],
        stops("1 2", "No column has names of stops", "Not used: 'City'", demand=[[2], [1]]),
    ),
    "cities of streets": (
        [f"Street,City,Lat,Lon\nMain St,Espoo,{PLACES[0]}\nSide St,Vantaa,{PLACES[1]}\n"],
        stops("1 2", "Not used: 'Street', 'City'"),
    ),
    "a customer without a name": (
        [f"Customer,Lat,Lon,Qty\n,{PLACES[0]},\nAnn,{PLACES[1]},2\n"],
        stops("1 Ann", "'Customer' has names that come twice, or none", demand=[None, [2]]),
    ),
    "an id twice": ([f"Order ID,Lat,Lon\n7,{PLACES[0]}\n7,{PLACES[1]}\n"], "must be an id that no other row has, got '7'"),
    "an order without a place whose demand is the sum": (
        [f"id,Lat,Lon,Qty\nA1,{PLACES[0]},2\nA2,{PLACES[1]},3\nA3,,,5\n"],
        "row 4, column 'Lat' must be a number, got ''",
    ),
    "an unnamed row without a place that is no sum": (
        [f"id,Lat,Lon,Qty\nA1,{PLACES[0]},2\nA2,{PLACES[1]},3\n,,,4\n"],
        "row 4, column 'id' must be an id, got none",
    ),
    "opening hours": (
        [f"id,Lat,Lon,Opening hours\ndepot,{PLACES[0]},\na,{PLACES[1]},8:00-12:30\n"],
        stops("depot a", window=[None, [28800, 45000]]),
    ),
    "loads of orders and of vans": (
        [f"id,Lat,Lon,Load #1,Load #2\ndepot,{PLACES[0]},,\na,{PLACES[1]},2,30\n", "vehicle,Max load #2,Max load #1\nvan,90,4\n"],
        stops("depot a", request={"vehicles": [{"id": "van", "capacity": [4, 90], "start": "depot", "end": "depot"}]}),
    ),
    "a driver with a plate": (
        [f"id,Lat,Lon,driver\ndepot,{PLACES[0]},\na,{PLACES[1]},Pekka\nb,{PLACES[1]},AB-2\nc,{PLACES[1]},\"Anna, AB-2\"\n", "plate,driver,capacity\nAB-1,Pekka,4\nAB-2,Anna,5\n"],
        stops("depot a b c", vehicle=[None, "Pekka, AB-1", "Anna, AB-2", "Anna, AB-2"],
              request={"vehicles": [{"id": "Pekka, AB-1", "start": "depot", "end": "depot"}, {"id": "Anna, AB-2", "start": "depot", "end": "depot"}]}),
    ),
    "a driver with an id": (
        [f"id,Lat,Lon,driver\ndepot,{PLACES[0]},\na,{PLACES[1]},Pekka\nb,{PLACES[1]},V2\n", "id,driver,capacity\nV1,Pekka,4\nV2,Anna,5\n"],
        stops("depot a b", vehicle=[None, "Pekka, V1", "Anna, V2"],
              request={"vehicles": [{"id": "Pekka, V1", "start": "depot", "end": "depot"}, {"id": "Anna, V2", "start": "depot", "end": "depot"}]}),
    ),
    "a plate is enough": (
        [f"id,Lat,Lon,demand\ndepot,{PLACES[0]},\na,{PLACES[1]},2\n", "Kennzeichen,Kapazität\nHH-A 1,4\n"],
        stops("depot a", request={"vehicles": [{"id": "HH-A 1", "capacity": [4], "start": "depot", "end": "depot"}]}),
    ),
    "vehicles alone": (
        ["plate,driver,capacity,start,shift start\nAB-1,Pekka,4,depot,8:00\n"],
        "has vehicles and no stops: open it with a table of stops, or after it",
    ),
    "items as text are no demand": (
        [f"id,Lat,Lon,Items\na,{PLACES[0]},soap\nb,{PLACES[1]},bread and milk\n"],
        stops("a b", "Not used: 'Items'"),
    ),
    "costs beside demands": (
        [f"id,Lat,Lon,demand,risk\ndepot,{PLACES[0]},,1\na,{PLACES[1]},2,3\n"],
        stops("depot a", "'risk' was not used", demand=[None, [2]]),
    ),
}  # fmt: skip
ALL = {**SIGNS, **PLANES, **DEPOTS, **DATES, **HEADINGS}
READ = {name: case for name, case in ALL.items() if isinstance(case[1], Becomes)}


def read(texts: list[str], **chosen: str) -> Reading:
    files = [NamedFile(f"{at}.csv", text.encode(), chosen) for at, text in enumerate(texts)]
    return read_files(files, Bounds(), wanted=None)


@pytest.mark.parametrize("name", READ)
def test_a_table_becomes_what_it_says(name: str) -> None:
    texts, expected = READ[name]
    assert isinstance(expected, Becomes)
    found = read(texts)
    got = found.request.get("stops", [])
    assert " ".join(stop["id"].replace(" ", "_") for stop in got) == expected.ids
    for member, values in expected.stops.items():
        assert [stop.get(member) for stop in got] == values, member
    assert {each: found.request[each] for each in expected.members} == expected.members
    text = "\n".join(note.text for note in found.notes)
    for sentence in expected.notes:
        assert sentence in text


@pytest.mark.parametrize("name", READ)
def test_what_a_table_becomes_can_be_planned(name: str) -> None:
    found = read(READ[name][0])
    if "road_time" not in str(found.request):
        parse_task(TaskSource(found.kind, to_json(found.request)), LIMITS, ACTORS)


@pytest.mark.parametrize("name", sorted(ALL.keys() - READ.keys()))
def test_what_a_table_leaves_open_is_asked(name: str) -> None:
    texts, sentence = ALL[name]
    with pytest.raises(UnreadableFile) as refused:
        read(texts)
    assert str(sentence) in str(refused.value)
    if "which may be anything" in str(sentence):
        assert refused.value.columns
        assert {"id", "latitude", "demand", "x", "second y"} <= {*refused.value.choices["0.csv"]}


def test_a_question_is_answered_by_the_columns_that_it_lists() -> None:
    texts, _ = PLANES["a place, a demand and a service"]
    with pytest.raises(UnreadableFile) as refused:
        read(texts)
    columns = {each.name: each.taken_for for each in refused.value.columns}
    assert columns == {"1": "latitude", "2": "longitude", "3": "detail", "4": "detail"}
    found = read(texts, **{**columns, "3": "demand", "4": "service"})
    assert [stop.get("demand") for stop in found.request["stops"]] == [None, [2], [3]]
    assert {each.name: each.taken_for for each in found.columns}["4"] == "service"
    again = read(
        ["1,40,50,3\n2,45,68,5\n"], **{"1": "x", "2": "y", "3": "second x", "4": "second y"}
    )
    assert again.request == {"coordinates": [[1, 40, 50, 3], [2, 45, 68, 5]]}
    assert {each.taken_for for each in again.columns} == {"x", "y", "second x", "second y"}
