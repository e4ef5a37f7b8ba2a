/** Write a request as a Python program with the client. */

import { kindOf } from "../common/kinds.js";

const MIDDLE = 0.5; // the middle balance

/** The program that plans the same, and prints the tour, or the plan, of the same balance. */
export function python({ body }, balance) {
  const { call, movers } = kindOf(body);
  const service = new URL(".", document.baseURI).href.replace(/\/$/, "");
  return `from paretour import Client

request = ${literal(body)}

with Client(${literal(service)}) as client:
    front = client.${call}(**request)
${movers ? chosenPlan(movers, balance ?? MIDDLE) : chosenTour(balance)}`;
}

const chosenTour = (balance) => `    tour = front.choose(${balance === undefined ? "knee=True" : `balance=${balance}`})
print(tour.lengths, tour.stops or tour.tour)
`;

const chosenPlan = ({ printed }, balance) => `    plan = min(front.plans, key=lambda plan: abs(plan.balance - ${balance}))
print(plan.lengths, [${printed} for route in plan.routes])
`;

const NAMES = new Map([[null, "None"], [undefined, "None"], [true, "True"], [false, "False"]]);

/** A JSON value as a Python literal. */
function literal(value) {
  if (NAMES.has(value)) return NAMES.get(value);
  if (Array.isArray(value)) return `[${value.map(literal).join(", ")}]`;
  if (typeof value !== "object") return JSON.stringify(value);
  const members = Object.entries(value).filter(([, each]) => each !== undefined);
  return `{${members.map(([name, each]) => `${literal(name)}: ${literal(each)}`).join(", ")}}`;
}
