"use strict";
// The data as it stands in the page: columns, one entry per conflict; words are places in lists.

const data = JSON.parse(document.getElementById("data").textContent);
const conflicts = data.conflicts;
const count = conflicts.count;
/** A column that has one value in every row stands in the page as that value. */
const column = Object.fromEntries(Object.entries(conflicts.columns).map(([name, values]) =>
  [name, Array.isArray(values) ? values : new Array(count).fill(values)]));
const KINDS = ["rear-end", "frontal", "side"];
const SEVERITIES = ["caution", "serious", "critical"];
const options = (data.runs.find((run) => run.options) || {}).options || data.defaults;

/** Which conflicts have a drawing: row → [row, ego, foe]. */
const drawn = new Map(conflicts.drawn.map((entry) => [entry[0], entry]));

/** What is shown: by kind, by severity, a period in s, a type (of either), a run; null is all. */
const filter = {};

function resetFilter() {
  Object.assign(filter, { kinds: [true, true, true], severities: [true, true, true], from: -Infinity, to: Infinity,
    type: null, run: null });
}
resetFilter();

/** The rows that the filter lets through; `always` leaves the period out of it. */
function shownRows(always) {
  const rows = [];
  const { kinds, severities, type, run } = filter;
  const from = always ? -Infinity : filter.from;
  const to = always ? Infinity : filter.to;
  for (let row = 0; row < count; row++) {
    if (kinds[column.kind[row]] && severities[column.severity[row]]
      && column.time[row] >= from && column.time[row] <= to
      && (type === null || column.ego_type[row] === type || column.foe_type[row] === type)
      && (run === null || column.run[row] === run)) {
      rows.push(row);
    }
  }
  return rows;
}

/** Worst first, as the log's reader sorts them: severity, collision, TTC, margin. */
function byBadness(a, b) {
  const { severity, collision, ttc, margin } = column;
  const or = (value) => (value === null ? Infinity : value);
  const less = (x, y) => (x < y ? -1 : x > y ? 1 : 0);
  return severity[b] - severity[a] || collision[b] - collision[a] || less(or(ttc[a]), or(ttc[b]))
    || less(or(margin[a]), or(margin[b])) || a - b;
}

/** The first `most` of the rows, worst first, without sorting all of them. */
function worstRows(rows, most) {
  const worst = [];
  for (const row of rows) {
    if (worst.length === most && byBadness(row, worst[most - 1]) >= 0) continue;
    let place = worst.length;
    while (place > 0 && byBadness(row, worst[place - 1]) < 0) place--;
    worst.splice(place, 0, row);
    if (worst.length > most) worst.pop();
  }
  return worst;
}

const egoId = (row) => conflicts.ids[column.ego[row]];
const foeId = (row) => conflicts.ids[column.foe[row]];
const laneId = (row) => conflicts.lanes[column.lane[row]];
const spotOf = (row) => conflicts.spot_of_lane[column.lane[row]];

/** A number with so many decimals, thousands apart; a true minus sign. */
function number(value, decimals = 0) {
  const text = value.toLocaleString("en-GB", { minimumFractionDigits: decimals, maximumFractionDigits: decimals });
  return text.replace("-", "−");
}

/** An element with text (never markup) or children in it. */
function make(name, properties = {}, ...children) {
  const element = Object.assign(document.createElement(name), properties);
  element.append(...children);
  return element;
}

const byId = (id) => document.getElementById(id);
