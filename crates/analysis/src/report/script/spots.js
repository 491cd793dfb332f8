// Where and why: tables of places, manoeuvres and causes by the risk index. A click filters by a row.

const MOST_SPOTS = 15;

/** Sums over the rows of a group: counts by severity, the risk index. */
function sums(rows) {
  const counts = SEVERITIES.map(() => 0);
  let all = 0;
  for (const row of rows) {
    // What is not traffic is shown if it is asked for, and counted nowhere.
    if (isTraffic(row)) counts[column.severity[row]]++;
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

/** The spots of some rows, the largest risk index first; those of one variant know it. */
function spotsOf(rows, variant = filter.variant) {
  const spots = [...grouped(rows, (row) => [spotOf(row)])].map(([place, of_place]) => {
    const spot = { place, variant, ...sums(of_place) };
    const weight = (row) => risk[row] + 1e-9;
    const all = of_place.reduce((sum, row) => sum + weight(row), 0);
    [spot.x, spot.y] = [column.x, column.y].map((axis) => of_place.reduce((sum, row) => sum + weight(row) * axis[row], 0) / all);
    return spot;
  });
  const entered = enteringByPlace();
  for (const spot of spots) {
    spot.entered = entered.get(conflicts.spots[spot.place]) || null;
    spot.rate = spot.entered && (PER_ENTERING * spot.risk) / spot.entered;
  }
  spots.sort((a, b) => b.risk - a.risk || b.counts[2] - a.counts[2] || b.rows.length - a.rows.length || a.place - b.place);
  spots.forEach((spot, rank) => { spot.rank = rank + 1; });
  return spots;
}

/** The same, kept until the rows change. */
function spotRows(rows) {
  if (spotRows.rows !== rows) Object.assign(spotRows, { rows, spots: spotsOf(rows) });
  return spotRows.spots;
}

/** The runs that the filter lets through. */
const shownRuns = () => data.runs.filter((_, run) => (filter.run === null || filter.run === run) && (filter.variant === null || filter.variant === variantOf[run]));

/** The vehicles that entered each junction in the runs that are shown, by the junction's name; empty where that is not known. */
function enteringByPlace() {
  const entered = new Map();
  // Of a period only the conflicts are known, not the traffic; and plans are not one traffic.
  if (isOfPeriod() || plansShown().length) return entered;
  const runs = shownRuns();
  // A run of an earlier version, or a killed run, has no such counts.
  if (!runs.every((run) => run.summary?.steps > 0 && run.summary.entered)) return entered;
  for (const run of runs) {
    for (const [junction, vehicles] of Object.entries(run.summary.entered)) {
      entered.set(`junction ${junction}`, (entered.get(`junction ${junction}`) || 0) + vehicles);
    }
  }
  return entered;
}

/** The risk index is given per this many entering vehicles. */
const PER_ENTERING = 1000;

/** The risk index per entering vehicles with its interval. */
function rateWords({ rate, entered, ...spot }) {
  if (rate === null) return "–";
  const junction = conflicts.spots[spot.place].replace(/^junction /, "");
  const ends = riskInterval(spot.rows, (run) => data.runs[run].summary.entered[junction] || 0).map((end) => (PER_ENTERING * end) / entered);
  const [middle, low, high] = [rate, ...ends].map((value) => number(value, value < 10 ? 1 : 0));
  return `${middle} (${low} to ${high})`;
}

/** A place as people know it: by its streets where the net names them, and by its id. */
function nameOfSpot(place) {
  const street = conflicts.streets[place];
  return street ? `${street} (${conflicts.spots[place]})` : conflicts.spots[place] || "no lane";
}
const spotName = (spot) => nameOfSpot(spot.place);

/** What is said of a spot behind its name: how dangerous it is, what happens there, and why. */
function spotWords(spot) {
  const manoeuvre = usual(spot.rows, manoeuvreOf);
  const cause = usual(spot.rows, strongestCause);
  const why = [manoeuvre && `mostly ${OFTEN[manoeuvre] || inWords(manoeuvre)}`, cause && (WHY[cause] || inWords(cause))].filter(Boolean).join("; ");
  const counts = [[2, "critical"], [1, "serious"]].filter(([severity]) => spot.counts[severity]).map(([severity, name]) => `${number(spot.counts[severity])} ${name}`);
  return `: risk index ${number(spot.risk, 1)}${bracketsOf(spot)}${counts.length ? `, ${counts.join(", ")}` : ""}${why ? `, ${why}` : ""}.`;
}

/** The interval of a spot in brackets; empty where both of its ends are written alike, as it would say nothing. */
function bracketsOf(spot) {
  const [low, high] = intervalOf(spot).map((end) => number(end, 1));
  return low === high ? "" : ` (${low} to ${high})`;
}

/** A bar as long as the risk index, in the shares of the severities. */
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
    const plans = plansShown();
    const columns = this.columns.filter(({ severity, entering, plan, single }) => (severity === undefined || filter.severities[severity])
      && (!entering || hasEntering) && (plan === undefined || (plan < plans.length && plans.length <= MOST_PLANS)) && !(single && plans.length));
    const head = make("tr", {}, ...columns.map((column_of, place) => {
      const cell = make("th", { className: column_of === BAR ? "share" : column_of.text ? "" : "number", scope: "col" });
      cell.setAttribute("aria-sort", column_of === this.columns[by] ? (down ? "descending" : "ascending") : "none");
      if (!column_of.value) {
        cell.append(column_of.heading);
        if (!column_of.heading || column_of === BAR) cell.setAttribute("aria-hidden", "true");
        return cell;
      }
      const title = headingOf(column_of);
      const button = make("button", { type: "button", textContent: `${title}${column_of === this.columns[by] ? (down ? "\u00a0▾" : "\u00a0▴") : ""}` });
      button.onclick = () => {
        this.down = column_of === this.columns[by] ? !down : !column_of.text;
        this.by = this.columns.indexOf(column_of);
        this.draw();
        this.element.querySelectorAll("th")[place].querySelector("button").focus();
      };
      cell.append(button);
      // Paper repeats the heading on each page, but no buttons.
      cell.dataset.heading = title;
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

/** The heading of a column; those of plans have the plans' names. */
const headingOf = ({ heading, plan }) => (plan === undefined ? heading : `${heading}, ${planNames()[plan]}`);

const textCell = (text) => make("td", { textContent: text });
const numberCell = (text) => make("td", { className: "number", textContent: text });

/** The columns that all tables have: the risk index with its interval, counts, and a bar. */
const COMMON = [
  { heading: "Risk index", value: (group) => group.risk, cell: (group) => numberCell(number(group.risk, 2)) },
  { heading: "95 % interval", single: true, cell: (group) => numberCell(intervalOf(group).map((end) => number(end, 2)).join(" to ")) },
  ...[2, 1, 0].map((severity) => ({ heading: SEVERITIES[severity], severity, value: (group) => group.counts[severity],
    cell: (group) => numberCell(number(group.counts[severity])) })),
];
const BAR = { heading: "by severity", cell: shareBar };

/** The risk index of a place in each of several plans. */
const BY_PLAN = Array.from({ length: MOST_PLANS }, (_, plan) => {
  const riskOf = (group) => group.rows.reduce((sum, row) => sum + (variantOf[column.run[row]] === plan ? risk[row] : 0), 0);
  return { heading: "Risk index", plan, value: riskOf, cell: (group) => numberCell(number(riskOf(group), 2)) };
});

/** A first column whose names are buttons. */
function nameColumn(heading, name, press, isPressed) {
  return { heading, text: true, value: name, cell: (group) => {
    if (group.name === "") return make("td", { textContent: heading === "Named place" ? "elsewhere" : NOT_KNOWN });
    const button = make("button", { type: "button", textContent: name(group) });
    button.setAttribute("aria-pressed", isPressed(group));
    button.onclick = () => press(group);
    return make("td", {}, button);
  } };
}

const hotSpots = new SortedTable(byId("spots"), [
  { heading: "", text: true, cell: (group) => make("td", { className: "rank" }, make("span", { textContent: plansShown().length ? "" : group.rank }), ...unfoldButton(group)) },
  nameColumn("Place", spotName, (group) => {
    choosePlace(filter.spot === group.place ? null : group.place, null);
    map.go(group.x, group.y, 120);
  }, (group) => filter.spot === group.place),
  { ...COMMON[0], single: true },
  COMMON[1],
  ...BY_PLAN,
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
  { ...COMMON[0], single: true }, ...COMMON.slice(1), ...BY_PLAN, BAR], 1);
const byManoeuvre = choiceTable("manoeuvres", "Manoeuvre", "manoeuvre", conflicts.manoeuvres);
const byArea = choiceTable("areas", "Named place", "area", conflicts.areas);
const byCause = choiceTable("causes", "Cause", "cause", CAUSES);

/** Shows the tables of the rows that pass the filter. */
function showSpots(rows) {
  const spots = spotRows(rows);
  byId("hot").hidden = plansShown().length > MOST_PLANS;
  hotSpots.show(spots);
  const listed = spots.slice(0, MOST_SPOTS);
  byId("per").hidden = !spots.some((spot) => spot.entered);
  const isRanked = hasRisk && !plansShown().length;
  byId("doubt").textContent = isRanked ? doubtWords(listed) : "";
  const ranked = (groupsOf) => [...grouped(rows, groupsOf)].map(([name, of_name]) => ({ name, ...sums(of_name) }))
    .sort((a, b) => (a.name === "") - (b.name === "") || b.risk - a.risk || b.rows.length - a.rows.length).map((group, place) => ({ ...group, rank: place + 1 }));
  byId("ofareas").hidden = !data.places;
  if (data.places) byArea.show(ranked((row) => [conflicts.areas[column.area[row]]]));
  byManoeuvre.show(ranked((row) => [manoeuvreOf(row)]));
  byCause.show(ranked((row) => (causeNames(row).length ? causeNames(row) : [""])));
}
