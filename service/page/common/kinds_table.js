/** The kinds of plans by name, written by `python -m tests.guide`: see service/kinds/kind.py. */
export const KINDS = {
  front: {"path": "front", "item": "tour", "mover": null, "visits": "tour", "stops": "stops", "onGrid": false},
  coverage: {"path": "coverage", "item": "tour", "mover": null, "visits": "tour", "stops": "places", "onGrid": true},
  fleet: {"path": "fleet", "item": "plan", "mover": "vehicle", "visits": "stops", "stops": "stops", "onGrid": false},
  robots: {"path": "coverage", "item": "plan", "mover": "robot", "visits": "tour", "stops": "places", "onGrid": true},
};
