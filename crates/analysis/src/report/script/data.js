"use strict";
// The data in the page: columns with one entry per conflict; ids and names are indices into lists.

const data = JSON.parse(document.getElementById("data").textContent);
const conflicts = data.conflicts;
const count = conflicts.count;
/** A column with the same value in every row is stored as that one value. */
const column = Object.fromEntries(Object.entries(conflicts.columns).map(([name, values]) =>
  [name, Array.isArray(values) ? values : new Array(count).fill(values)]));
/** ΔV of the one whose speed changes most; a log of an earlier version has the ego's only. */
column.delta_v = column.ego_delta_v.map((ego, row) => Math.max(ego, column.foe_delta_v[row]));
/** The numbers of all rows. */
const everyRow = Array.from({ length: count }, (_, row) => row);
const KINDS = ["rear-end", "frontal", "side"];
const SEVERITIES = ["caution", "serious", "critical"];
const options = (data.runs.find((run) => run.options) || {}).options || data.defaults;

/** The variant of each run: runs of one variant were made alike but for the seed. */
const variantOf = [];
data.variants.forEach((variant, place) => variant.runs.forEach((run) => { variantOf[run] = place; }));

/** What a conflict is that is none of traffic's; empty for the rest. */
const artefactOf = (row) => conflicts.artefacts[column.artefact[row]];
const isTraffic = (row) => !artefactOf(row);

/** The probability of a crash in each conflict; their sum is the risk index. Logs of early versions have none, and what is not
 * traffic is no danger. */
const risk = Float64Array.from(column.crash_probability, (value, row) => (isTraffic(row) && value) || 0);

/** Whether the log has crash probabilities: then places are ranked, and the map is coloured, by their sum. */
const hasRisk = risk.some((of_row) => of_row > 0);

/** The name of a run's scenario: that of its file, without what follows the first dot. */
const nameOfScenario = (run) => (run.scenario || "").split(/[/\\]/).pop().split(".").find((part) => part) || "closecall";
/** Those of all runs, each once. */
const scenarioNames = (() => {
  const known = data.runs.filter((run) => run.scenario);
  return known.length ? [...new Set(known.map(nameOfScenario))] : ["closecall"];
})();
const [scenarioName] = scenarioNames;

/** The causes, each once, and for each combination of causes in the log whether it has each of them. */
const CAUSES = [...new Set(conflicts.causes.flatMap((causes) => causes.split(" ")))].filter(Boolean).sort();
const causesOf = conflicts.causes.map((causes) => {
  const words = causes.split(" ");
  return CAUSES.map((cause) => words.includes(cause));
});
/** The strongest cause of a conflict; empty where none is known. */
const strongestCause = (row) => conflicts.causes[column.cause[row]].split(" ")[0];

/** The conflicts that have a drawing: row → [row, ego, foe]. */
const drawn = new Map(conflicts.drawn.map((entry) => [entry[0], entry]));

/** Order of rows, worst first: collision, severity, ΔV of collisions, crash probability, TTC, margin; last what is not traffic. */
function worstFirst(a, b) {
  const { severity, collision, delta_v, crash_probability, ttc, margin } = column;
  const or = (value) => (value === null ? Infinity : value);
  const less = (x, y) => (x < y ? -1 : x > y ? 1 : 0);
  return Boolean(artefactOf(a)) - Boolean(artefactOf(b)) || collision[b] - collision[a] || severity[b] - severity[a]
    || collision[a] * (delta_v[b] - delta_v[a]) || crash_probability[b] - crash_probability[a] || less(or(ttc[a]), or(ttc[b]))
    || less(or(margin[a]), or(margin[b])) || a - b;
}

/** The `most` worst of the rows, worst first, without sorting all of them. */
function worstRows(rows, most) {
  const worst = [];
  for (const row of rows) {
    if (worst.length === most && worstFirst(row, worst[most - 1]) >= 0) continue;
    let place = worst.length;
    while (place > 0 && worstFirst(row, worst[place - 1]) < 0) place--;
    worst.splice(place, 0, row);
    if (worst.length > most) worst.pop();
  }
  return worst;
}

const egoId = (row) => conflicts.ids[column.ego[row]];
const foeId = (row) => conflicts.ids[column.foe[row]];
const laneId = (row) => conflicts.lanes[column.lane[row]];
const spotOf = (row) => conflicts.spot_of_lane[column.lane[row]];

/** Number formats by decimals: making one takes as long as using it a hundred times. */
const formats = [0, 1, 2, 3, 4].map((decimals) =>
  new Intl.NumberFormat("en-GB", { minimumFractionDigits: decimals, maximumFractionDigits: decimals }));

/** A number with this many decimals, separated thousands and a true minus sign. */
const number = (value, decimals = 0) => formats[decimals].format(value).replace("-", "−");

/** An element with properties and children; text is never read as markup. */
function make(name, properties = {}, ...children) {
  const element = Object.assign(document.createElement(name), properties);
  element.append(...children);
  return element;
}

/** An SVG element with attributes. */
function drawing(name, attributes, ...children) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.append(...children);
  return element;
}

/** A name of the log in words. */
const inWords = (name) => name.replaceAll("_", " ");

const byId = (id) => document.getElementById(id);
