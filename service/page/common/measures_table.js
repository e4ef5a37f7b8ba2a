/** The measures of plans by name, written by `python -m tests.guide`: see service/fleet/measures/table.py. */
export const MEASURES = {
  vehicles: {"title": "Vehicles used", "unit": "vehicles"},
  driving: {"title": "Driving in all", "unit": "clock"},
  service: {"title": "At stops in all", "unit": "clock"},
  waiting: {"title": "Waiting in all", "unit": "clock"},
  lateness: {"title": "Late in all", "unit": "clock"},
  earliness: {"title": "Early in all", "unit": "clock"},
  weighted_arrival: {"title": "Customer wait", "unit": "clock", "note": "how long each stop waits for its visit, times its urgency, added up"},
  overtime: {"title": "Overtime in all", "unit": "clock"},
  longest: {"title": "Longest route", "unit": "routes"},
  shortest: {"title": "Shortest route", "unit": "routes"},
  imbalance: {"title": "Longest minus shortest", "unit": "routes"},
  unassigned: {"title": "Prizes left out", "unit": "prizes"},
  load_distance: {"title": "Load carried", "unit": "load", "note": "each load times how far it is carried, added up"},
  overlap: {"title": "Overlap of routes", "unit": "%", "note": "how many neighbours ride with different vehicles, the nearest counting most"},
  changes: {"title": "Stops changed", "unit": "stops", "note": "visited by another vehicle, or later, than in the plan before"},
  on_time: {"title": "Visits on time", "unit": "visits", "ofPlan": "%", "note": "begun after their window or after they are due, on an average day", "column": "share of visits on time"},
  duration: {"title": "Time in all, on average", "unit": "clock", "column": "mean time in all"},
  duration_p90: {"title": "Nine days of ten within", "unit": "clock", "column": "p90 time in all"},
};

/** The measures that the page offers as objectives, with the columns that they need. */
export const CHOICES = {
  vehicles: {"title": "Vehicles used", "name": "vehicles"},
  unassigned: {"title": "Orders left out", "name": "orders left out", "stops": "prize"},
  overtime: {"title": "Overtime", "name": "overtime", "vehicles": "max_overtime"},
  lateness: {"title": "Lateness", "name": "lateness", "stops": "due"},
  earliness: {"title": "Earliness", "name": "earliness", "stops": "due"},
  weighted_arrival: {"title": "Customer wait, by urgency", "name": "customer wait", "stops": "urgency"},
  imbalance: {"title": "Longest minus shortest route", "name": "imbalance"},
  load_distance: {"title": "Load carried", "name": "load carried", "vehicles": "capacity"},
  overlap: {"title": "Overlap of routes", "name": "overlap of routes"},
  on_time: {"title": "Late visits", "name": "late visits", "stops": "window"},
};
