"""The import templates of other route planners: their columns are known, so nobody is asked."""

import pytest

from service.files.reader import read_files
from service.files.reading import Bounds, NamedFile
from tests.helpers.serving import LIMITS

# By product its heading; a depot and two orders; and what its columns are taken for, but for those
# that only tell drivers something.
TEMPLATES = {
    "Routific": (
        "Name,Address,Latitude,Longitude,Phone Number,Delivery Window Start,Delivery Window End,"
        "Duration,Load,Priority",
        "Depot,,60.17,24.94,,,,,,|A,Main St 1,60.18,24.95,,08:00,12:00,10,3,1"
        "|B,High St 2,60.16,24.93,,09:00,17:00,5,2,",
        "id latitude longitude window_from window_to service demand",
    ),
    "OptimoRoute": (
        "Order ID,Order type,Date,Assigned to,Location name,Address,Latitude,Longitude,Duration,"
        "Time window from,Time window to,Load #1,Load #2,Skills,Notes",
        "0,D,2026-11-29,,Depot,,60.17,24.94,,,,,,,|1,D,2026-11-29,,A,Main 1,60.18,24.95,10,08:00,"
        "12:00,3,1,,|2,D,2026-11-29,,B,High 2,60.16,24.93,5,09:00,17:00,2,4,,",
        "id vehicle latitude longitude service window_from window_to demand demand skills",
    ),
    "Circuit and Spoke": (
        "Id,Address Line 1,City,Latitude,Longitude,Earliest Time,Latest Time,Time at Stop,Notes,"
        "Recipient Name,Package Count,Driver (email or phone number)",
        "d,Depot,Helsinki,60.17,24.94,,,,,,,|o1,Main 1,Helsinki,60.18,24.95,08:30,15:30,5,,Ann,3,"
        "|o2,High 2,Helsinki,60.16,24.93,10:30,,2,,Bob,2,",
        "id latitude longitude window_from window_to service demand vehicle",
    ),
    "Track-POD": (
        "Order Number,Order Date,Client,Address,Lat,Lon,Time Slot From,Time Slot To,Service Time,"
        "Weight,Volume,Pallets",
        "0,2026-11-29,Depot,,60.17,24.94,,,,,,|1,2026-11-29,A,Main 1,60.18,24.95,08:00,12:00,10,3,"
        "1,1|2,2026-11-29,B,High 2,60.16,24.93,09:00,17:00,5,2,1,1",
        "id latitude longitude window_from window_to service demand demand demand",
    ),
    "Onfleet": (
        "Task_Details,Destination_Address,Destination_Latitude,Destination_Longitude,"
        "Recipient_Name,completeAfter,completeBefore,Quantity,Service_Time,Driver",
        "Depot,,60.17,24.94,,,,,,|A,Main 1,60.18,24.95,Ann,2026-11-29 08:00,2026-11-29 12:00,3,10,"
        "|B,High 2,60.16,24.93,Bob,2026-11-29 09:00,2026-11-29 17:00,2,5,",
        "latitude longitude window_from window_to demand service vehicle",
    ),
    "Route4Me": (
        "Alias,Address,Lat,Lng,Time Window Start,Time Window End,Time Window Start 2,"
        "Time Window End 2,Service Time,Weight,Cube,Pieces,Revenue,Priority,Group",
        "Depot,,60.17,24.94,,,,,,,,,,,|A,M 1,60.18,24.95,08:00,12:00,14:00,16:00,10,3,1,2,100,1,x"
        "|B,High 2,60.16,24.93,09:00,17:00,,,5,2,1,1,80,2,x",
        "id latitude longitude window_from window_to window_2_from window_2_to service demand"
        " demand demand",
    ),
    "RoutingXL": (
        "address,lat,lng,servicetime,ready,due",
        "Depot,60.17,24.94,,,|A,60.18,24.95,10,08:00,12:00|B,60.16,24.93,5,09:00,17:00",
        "latitude longitude service window_from window_to",
    ),
    "Badger": (
        "Name,Address,City,State,Zip,Latitude,Longitude,Phone,Account Owner,Priority",
        "Office,,Helsinki,,,60.17,24.94,,Ann,A|Shop,Main 1,Helsinki,,,60.18,24.95,,Ann,B"
        "|Bar,High 2,Helsinki,,,60.16,24.93,,Bob,A",
        "id latitude longitude",
    ),
    "Detrack": (
        "D.O. No.,Date,Deliver to,Address,Latitude,Longitude,Instructions,Assign to,Quantity",
        "0,2026-11-29,Depot,,60.17,24.94,,,|1,2026-11-29,Ann,Main 1,60.18,24.95,,,3"
        "|2,2026-11-29,Bob,High 2,60.16,24.93,,,2",
        "id latitude longitude vehicle demand",
    ),
    "WorkWave": (
        "Name,Address,Latitude,Longitude,Service Time,Load,Notes,Time Window Start,"
        "Time Window End,Required Tags,Required Vehicle",
        "Depot,,60.17,24.94,,,,,,,|A,Main 1,60.18,24.95,10,3,,08:00,12:00,,"
        "|B,High 2,60.16,24.93,5,2,,09:00,17:00,,",
        "id latitude longitude service demand window_from window_to skills vehicle",
    ),
    "Cartrack": (
        "Job Reference Number,Stop Type,Driver Name,Scheduled Delivery Date and Allowed Start,"
        "Allowed End,Service Time (min),Customer Name,Lat,Lng,Address Line 1,Quantity",
        "0,,,,,,Depot,60.17,24.94,,|1,,,2026-11-29 08:00,2026-11-29 12:00,10,Ann,60.18,24.95,M 1,3"
        "|2,,,2026-11-29 09:00,2026-11-29 17:00,5,Bob,60.16,24.93,H 2,2",
        "id vehicle window_from window_to service latitude longitude demand",
    ),
    "Mapotempo": (
        "reference,name,street,lat,lng,duration,time_window_start_1,time_window_end_1,"
        "time_window_start_2,time_window_end_2,quantity,tags,vehicle",
        "0,Depot,,60.17,24.94,,,,,,,,|1,A,Main 1,60.18,24.95,00:10,08:00,12:00,,,3,,"
        "|2,B,High 2,60.16,24.93,00:05,09:00,17:00,,,2,,",
        "id latitude longitude service window_from window_to window_2_from window_2_to demand"
        " vehicle",
    ),
    "Droppath": (
        "tracking_id,title,address_line1,address_city,latitude,longitude,quantity,contact_name",
        "0,Depot,,,60.17,24.94,,|T1,A,Main 1,Espoo,60.18,24.95,3,Ann|T2,B,H 2,,60.16,24.93,2,Bob",
        "id latitude longitude demand",
    ),
    "NowGo": (
        "Job Reference,Address,Latitude,Longitude,Type,Date,Time Window Start,Time Window End,"
        "Service time",
        "0,Depot,60.17,24.94,,,,,|J1,Main 1,60.18,24.95,Delivery,2026-11-29,08:00,12:00,10"
        "|J2,High 2,60.16,24.93,Delivery,2026-11-29,09:00,17:00,5",
        "id latitude longitude window_from window_to service",
    ),
    "ElasticRoute": (
        "Name,Address,Latitude,Longitude,Weight Load,Volume Load,Vehicle Type,From,Till,"
        "Service Time",
        "Depot,,60.17,24.94,,,,,,|A,Main 1,60.18,24.95,3,1,,800,1200,10"
        "|B,High 2,60.16,24.93,2,1,,900,1700,5",
        "id latitude longitude demand demand window_from window_to service",
    ),
    "Locus": (
        "Task Id,Customer Name,Address,Latitude,Longitude,Slot Start,Slot End,"
        "Transaction Duration,Volume,Weight,Team,Skills",
        "0,Depot,,60.17,24.94,,,,,,,|T1,A,Main 1,60.18,24.95,08:00,12:00,10,1,3,x,"
        "|T2,B,High 2,60.16,24.93,09:00,17:00,5,2,4,x,",
        "id latitude longitude window_from window_to service demand demand skills",
    ),
    "Wialon": (
        "name,address,lat,lon,Delivery interval from,Delivery interval to,Unloading time,Weight",
        "Depot,,60.17,24.94,,,,|A,Main 1,60.18,24.95,08:00,12:00,10,3"
        "|B,High 2,60.16,24.93,09:00,17:00,5,2",
        "id latitude longitude window_from window_to service demand",
    ),
    "Zeo": (
        "Address,Latitude,Longitude,Stop Type,Delivery time slot start,Delivery time slot end,"
        "Stop Duration,Parcel Count,Customer Name,Customer Phone",
        "Depot,60.17,24.94,,,,,,,|Main 1,60.18,24.95,Delivery,08:00,12:00,10,3,Ann,"
        "|High 2,60.16,24.93,Delivery,09:00,17:00,5,2,Bob,",
        "latitude longitude window_from window_to service demand",
    ),
    "a booking system": (
        "appointment_start,appointment_end,street,zip_code,lat,lon,service_time,skills_needed",
        ",,Depot,,60.17,24.94,,|08:00,12:00,Main 1,00100,60.18,24.95,10,"
        "|09:00,17:00,High 2,00200,60.16,24.93,5,",
        "window_from window_to latitude longitude service skills",
    ),
}


@pytest.mark.parametrize("product", TEMPLATES)
def test_a_template_is_read_without_a_question(product: str) -> None:
    heading, rows, expected = TEMPLATES[product]
    table = "\n".join((heading, *rows.split("|"), ""))
    found = read_files([NamedFile("orders.csv", table.encode())], Bounds(roads=LIMITS.roads))
    taken = [each.taken_for for each in found.columns]
    assert [each for each in taken if each not in ("ignored", "detail")] == expected.split()
    assert not any(note.code == "no-depot" for note in found.notes)
    order = found.request["stops"][1]
    assert order["location"] == [24.95, 60.18]
    if "window_from" in taken:
        times = order.get("window") or order["windows"][0]
        assert times[0] in (8 * 3600, 8.5 * 3600)
    if "service" in taken:
        assert order["service"] in (300, 600)
