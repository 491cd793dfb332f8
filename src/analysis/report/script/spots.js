// Where and why: tables of places, manoeuvres and causes by the crashes to be expected. A click filters by a row.

const MOST_SPOTS = 15;

/** Sums over the rows of a group: counts by severity, expected crashes, their interval. */
function sums(rows) {
  const counts = SEVERITIES.map(() => 0);
  let all = 0;
  for (const row of rows) {
    counts[column.severity[row]]++;
    all += risk[row];
  }
  return { rows, counts, risk: all };
}

/** The rows of each group, by the groups that a row is in. */
function grouped(rows, groupsOf) {
  const groups = new Map();
  for (const row of rows) {
    for (const group of groupsOf(row)) {
      if (!groups.has(group)) groups.set(group, []);
      groups.get(group).push(row);
    }
  }
  return groups;
}

/** What most of the rows have, weighed by their crash probabilities; empty where it is not known. */
function usual(rows, name) {
  const weights = new Map();
  for (const row of rows) if (name(row)) weights.set(name(row), (weights.get(name(row)) || 0) + risk[row] + 1e-9);
  return [...weights].reduce((most, one) => (one[1] > most[1] ? one : most), ["", 0])[0];
}

const manoeuvreOf = (row) => conflicts.manoeuvres[column.manoeuvre[row]];
const causeNames = (row) => CAUSES.filter((_, cause) => causesOf[column.cause[row]][cause]);

/** Quantiles of Student's t for 95 % by degrees of freedom from 1 on; then the normal distribution's. */
const T = [12.71, 4.3, 3.18, 2.78, 2.57, 2.45, 2.36, 2.31, 2.26, 2.23, 2.2, 2.18, 2.16, 2.14, 2.13, 2.12, 2.11, 2.1, 2.09, 2.09];
const Z = 1.96;

/** A quantile of χ² (Wilson and Hilferty 1931), z standard deviations from the middle. */
const chiSquared = (freedom, z) => freedom * Math.max(0, 1 - 2 / (9 * freedom) + z * Math.sqrt(2 / (9 * freedom))) ** 3;

/**
 * The 95 % interval of the expected crashes of some conflicts: over the runs, where there are several of one variant;
 * otherwise that of a sum of independent rare events, each with its weight (Fay and Feuer 1997).
 */
function crashInterval(rows) {
  const runs = filter.run === null && (data.variants.length < 2 || filter.variant !== null)
    ? data.runs.map((_, run) => run).filter((run) => filter.variant === null || variantOf[run] === filter.variant) : [];
  const sum = rows.reduce((all, row) => all + risk[row], 0);
  if (runs.length > 1) {
    const of_run = new Map(runs.map((run) => [run, 0]));
    for (const row of rows) of_run.set(column.run[row], (of_run.get(column.run[row]) || 0) + risk[row]);
    const many = of_run.size;
    const mean = sum / many;
    const variance = [...of_run.values()].reduce((all, of_one) => all + (of_one - mean) ** 2, 0) / (many - 1);
    const reach = (T[many - 2] || Z) * Math.sqrt(variance * many);
    return [Math.max(0, sum - reach), sum + reach];
  }
  let [squares, greatest] = [0, 0];
  for (const row of rows) {
    squares += risk[row] ** 2;
    greatest = Math.max(greatest, risk[row]);
  }
  if (sum <= 0) return [0, 0];
  const low = (squares / (2 * sum)) * chiSquared((2 * sum ** 2) / squares, -Z);
  const [more_squares, more] = [squares + greatest ** 2, sum + greatest];
  return [low, (more_squares / (2 * more)) * chiSquared((2 * more ** 2) / more_squares, Z)];
}

/** The interval of a group, computed once. */
const intervalOf = (group) => (group.interval ||= crashInterval(group.rows));
/** Whether chance may have put a spot behind another: their intervals overlap. */
const mayOutrank = (spot, other) => intervalOf(spot)[1] >= intervalOf(other)[0];

/** The spots of some rows, the most expected crashes first; kept until the rows change. */
function spotRows(rows) {
  if (spotRows.rows !== rows) {
    const spots = [...grouped(rows, (row) => [spotOf(row)])].map(([place, of_place]) => {
      const spot = { place, ...sums(of_place) };
      const weight = (row) => risk[row] + 1e-9;
      const all = of_place.reduce((sum, row) => sum + weight(row), 0);
      [spot.x, spot.y] = [column.x, column.y].map((axis) => of_place.reduce((sum, row) => sum + weight(row) * axis[row], 0) / all);
      return spot;
    });
    const entered = enteringByPlace();
    for (const spot of spots) {
      spot.entered = entered.get(spotName(spot)) || null;
      spot.rate = spot.entered && (PER_ENTERING * spot.risk) / spot.entered;
    }
    spots.sort((a, b) => b.risk - a.risk || b.counts[2] - a.counts[2] || b.rows.length - a.rows.length || a.place - b.place);
    spots.forEach((spot, rank) => { spot.rank = rank + 1; });
    Object.assign(spotRows, { rows, spots });
  }
  return spotRows.spots;
}

/** The vehicles that entered each junction in the runs that are shown, by the junction's name; empty where that is not known. */
function enteringByPlace() {
  const entered = new Map();
  // Of a period only the conflicts are known, not the traffic.
  if (Number.isFinite(filter.from) || Number.isFinite(filter.to)) return entered;
  const runs = data.runs.filter((_, run) => (filter.run === null || filter.run === run) && (filter.variant === null || filter.variant === variantOf[run]));
  // A run of an earlier version, or one that was killed, has no such counts.
  if (!runs.every((run) => run.summary?.steps > 0 && run.summary.entered)) return entered;
  for (const run of runs) {
    for (const [junction, vehicles] of Object.entries(run.summary.entered)) {
      entered.set(`junction ${junction}`, (entered.get(`junction ${junction}`) || 0) + vehicles);
    }
  }
  return entered;
}

/** Expected crashes per this many entering vehicles. */
const PER_ENTERING = 1000;

/** The expected crashes per entering vehicles with their interval. */
function rateWords({ rate, entered, ...group }) {
  if (rate === null) return "–";
  const ends = intervalOf(group).map((end) => (PER_ENTERING * end) / entered);
  const [middle, low, high] = [rate, ...ends].map((value) => number(value, value < 10 ? 1 : 0));
  return `${middle} (${low} to ${high})`;
}

const spotName = (spot) => conflicts.spots[spot.place] || "no lane";

/** What is said of a spot behind its name: how dangerous it is, what happens there, and why. */
function spotWords(spot) {
  const manoeuvre = usual(spot.rows, manoeuvreOf);
  const cause = usual(spot.rows, strongestCause);
  const why = [manoeuvre && `mostly ${OFTEN[manoeuvre] || inWords(manoeuvre)}`, cause && (WHY[cause] || inWords(cause))].filter(Boolean).join("; ");
  const counts = [[2, "critical"], [1, "serious"]].filter(([severity]) => spot.counts[severity]).map(([severity, name]) => `${number(spot.counts[severity])} ${name}`);
  const [low, high] = intervalOf(spot).map((end) => number(end, 1));
  return `: ${number(spot.risk, 1)} (${low} to ${high}) expected crashes${counts.length ? `, ${counts.join(", ")}` : ""}${why ? `, ${why}` : ""}.`;
}

/** A bar as long as the expected crashes, in the shares of the severities. */
function shareBar(group, most) {
  const cell = make("td", { className: "share" });
  cell.setAttribute("aria-hidden", "true");
  const of_severity = SEVERITIES.map((_, severity) => group.rows.reduce((sum, row) => sum + (column.severity[row] === severity ? risk[row] : 0), 0));
  [2, 1, 0].forEach((severity) => {
    if (of_severity[severity] <= 0) return;
    const bar = make("span");
    bar.style.width = `${(100 * of_severity[severity]) / most}%`;
    bar.style.background = `var(--${SEVERITIES[severity]})`;
    cell.append(bar);
  });
  return cell;
}

/** A table whose headings sort it. Columns: heading, the value to sort by, what the cell shows. Rows may unfold. */
class SortedTable {
  constructor(element, columns, by, unfolded) {
    Object.assign(this, { element, columns, by, unfolded, down: true, open: new Set() });
  }

  show(groups) {
    this.groups = groups;
    this.draw();
  }

  draw() {
    const { by, down } = this;
    // A severity that the filter leaves out has no column.
    const hasEntering = this.groups.some((group) => group.entered);
    const columns = this.columns.filter(({ severity, entering }) => (severity === undefined || filter.severities[severity]) && (!entering || hasEntering));
    const head = make("tr", {}, ...columns.map((column_of, place) => {
      const cell = make("th", { className: column_of === BAR ? "share" : column_of.text ? "" : "number", scope: "col" });
      cell.setAttribute("aria-sort", column_of === this.columns[by] ? (down ? "descending" : "ascending") : "none");
      if (!column_of.value) {
        cell.append(column_of.heading);
        if (!column_of.heading || column_of === BAR) cell.setAttribute("aria-hidden", "true");
        return cell;
      }
      const button = make("button", { type: "button", textContent: `${column_of.heading}${column_of === this.columns[by] ? (down ? "\u00a0▾" : "\u00a0▴") : ""}` });
      button.onclick = () => {
        this.down = column_of === this.columns[by] ? !down : !column_of.text;
        this.by = this.columns.indexOf(column_of);
        this.draw();
        this.element.querySelectorAll("th")[place].querySelector("button").focus();
      };
      cell.append(button);
      // Paper repeats the heading on each page, but no buttons.
      cell.dataset.heading = column_of.heading;
      return cell;
    }));
    const value = this.columns[by].value;
    const less = (a, b) => (value(a) < value(b) ? -1 : value(a) > value(b) ? 1 : 0);
    // What is not known comes last, whatever is sorted by.
    const sorted = [...this.groups].sort((a, b) => (a.name === "") - (b.name === "") || (down ? less(b, a) : less(a, b)) || a.rank - b.rank).slice(0, MOST_SPOTS);
    const most = this.groups.reduce((all, group) => Math.max(all, group.risk), 0) || 1;
    const lines = sorted.flatMap((group) => {
      const line = make("tr", {}, ...columns.map((column_of) => column_of.cell(group, most)));
      return this.open.has(group.place) ? [line, make("tr", {}, make("td", { colSpan: columns.length }, this.unfolded(group)))] : [line];
    });
    if (!lines.length) lines.push(make("tr", {}, make("td", { textContent: "none", colSpan: columns.length })));
    this.element.replaceChildren(make("thead", {}, head), make("tbody", {}, ...lines));
  }
}

const textCell = (text) => make("td", { textContent: text });
const numberCell = (text) => make("td", { className: "number", textContent: text });

/** The columns that all tables have: expected crashes with their interval, counts, and a bar. */
const COMMON = [
  { heading: "Expected crashes", value: (group) => group.risk, cell: (group) => numberCell(number(group.risk, 2)) },
  { heading: "95 % interval", cell: (group) => numberCell(intervalOf(group).map((end) => number(end, 2)).join(" to ")) },
  ...[2, 1, 0].map((severity) => ({ heading: SEVERITIES[severity], severity, value: (group) => group.counts[severity],
    cell: (group) => numberCell(number(group.counts[severity])) })),
];
const BAR = { heading: "by severity", cell: shareBar };

/** A first column whose names are buttons. */
function nameColumn(heading, name, press, isPressed) {
  return { heading, text: true, value: name, cell: (group) => {
    if (group.name === "") return make("td", { textContent: NOT_KNOWN });
    const button = make("button", { type: "button", textContent: name(group) });
    button.setAttribute("aria-pressed", isPressed(group));
    button.onclick = () => press(group);
    return make("td", {}, button);
  } };
}

const hotSpots = new SortedTable(byId("spots"), [
  { heading: "", text: true, cell: (group) => make("td", { className: "rank" }, make("span", { textContent: group.rank }), ...unfoldButton(group)) },
  nameColumn("Place", spotName, (group) => {
    choosePlace(filter.spot === group.place ? null : group.place, null);
    map.go(group.x, group.y, 120);
  }, (group) => filter.spot === group.place),
  ...COMMON.slice(0, 2),
  { heading: "per 1,000 entering", entering: true, value: (group) => group.rate ?? -1, cell: (group) => numberCell(rateWords(group)) },
  ...COMMON.slice(2),
  { heading: "Mostly", text: true, value: (group) => usual(group.rows, manoeuvreOf), cell: (group) => textCell(inWords(usual(group.rows, manoeuvreOf)) || NOT_KNOWN) },
  { heading: "Why", text: true, value: (group) => usual(group.rows, strongestCause), cell: (group) => textCell(inWords(usual(group.rows, strongestCause)) || NOT_KNOWN) },
  BAR,
], 2, movementDiagram);

/** The button that shows the movement diagram of a place, where there is one. */
function unfoldButton(spot) {
  if (!approachesOf(spot.place)) return [];
  const { open } = hotSpots;
  const isOpen = open.has(spot.place);
  const button = make("button", { type: "button", className: "unfold", textContent: isOpen ? "▾" : "▸" });
  button.setAttribute("aria-label", `Movements at ${spotName(spot)}`);
  button.setAttribute("aria-expanded", isOpen);
  button.onclick = () => {
    if (isOpen) open.delete(spot.place);
    else open.add(spot.place);
    hotSpots.draw();
    hotSpots.element.querySelector(`button[aria-label=${CSS.escape(button.getAttribute("aria-label"))}]`).focus();
  };
  return [button];
}

const NOT_KNOWN = "not known";
const choiceTable = (id, heading, name, names) => new SortedTable(byId(id), [
  nameColumn(heading, (group) => inWords(group.name),
    (group) => choose(name, filter[name] === names.indexOf(group.name) ? null : names.indexOf(group.name)),
    (group) => filter[name] !== null && filter[name] === names.indexOf(group.name)),
  ...COMMON, BAR], 1);
const byManoeuvre = choiceTable("manoeuvres", "Manoeuvre", "manoeuvre", conflicts.manoeuvres);
const byCause = choiceTable("causes", "Cause", "cause", CAUSES);

/** Shows the tables of the rows that pass the filter. */
function showSpots(rows) {
  const spots = spotRows(rows);
  hotSpots.show(spots);
  const listed = spots.slice(0, MOST_SPOTS);
  byId("per").hidden = !spots.some((spot) => spot.entered);
  const others = listed.slice(1).filter((spot) => mayOutrank(spot, listed[0])).length;
  byId("doubt").textContent = others ? `The intervals of ${number(others)} of the ${number(listed.length - 1)} places after the first overlap its own: their ranks may be chance.` : "";
  const ranked = (groupsOf) => [...grouped(rows, groupsOf)].map(([name, of_name]) => ({ name, ...sums(of_name) }))
    .sort((a, b) => (a.name === "") - (b.name === "") || b.risk - a.risk || b.rows.length - a.rows.length).map((group, place) => ({ ...group, rank: place + 1 }));
  byManoeuvre.show(ranked((row) => [manoeuvreOf(row)]));
  byCause.show(ranked((row) => (causeNames(row).length ? causeNames(row) : [""])));
}
