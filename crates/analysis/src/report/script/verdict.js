// The verdict: the tiles, and where it is most dangerous and why. Each sentence is made where its condition holds.

/** This many of the most dangerous places are named, and have a number on the map. */
const MOST_BADGES = 3;
/** This many plans have a row or a column. */
const MOST_VARIANTS = 12;

/** The figures of some rows of these runs: name, value, what it means, and the look of its tile. */
function figuresIn(rows, runs, all) {
  const counted = rows.filter(isTraffic);
  const { counts, risk: crashes } = sums(counted);
  const of_all = all > crashes + 0.005 ? `of ${number(all, 1)} in all; ` : "";
  const figures = hasRisk ? [["risk index", number(crashes, crashes < 10 ? 2 : 1), `${of_all}the sum of the probabilities that a driver brakes too late: compares places and plans, no number of crashes`]] : [];
  [2, 1, 0].forEach((severity) => {
    if (filter.severities[severity]) figures.push([SEVERITIES[severity], number(counts[severity]), "", SEVERITIES[severity]]);
  });
  figures.push(["collisions", number(counted.reduce((sum, row) => sum + column.collision[row], 0)), "counted: rectangles that overlapped in the simulation"]);
  if (counted.length < rows.length) figures.push(["not traffic", number(rows.length - counted.length), "shown, and counted nowhere else"]);
  const rate = rateIn(counted, runs);
  if (rate) figures.push(rate);
  return figures;
}

/** Conflicts per vehicle-kilometre; none where the traffic of what is shown is not known. */
function rateIn(rows, runs) {
  // A run that was killed has conflicts but no record of its traffic.
  const isKnown = runs.length && runs.every((run) => run.summary?.steps > 0) && !isOfPeriod() && !isOfPlace();
  const kilometres = runs.reduce((sum, run) => sum + (run.summary?.exposure.vehicle_kilometres || 0), 0);
  if (!isKnown || kilometres <= 0) return null;
  return ["conflicts per vehicle-km", number((rows.length * (data.seen / count)) / kilometres, 2),
    isPart(rows) ? "those that are shown, per kilometre of all vehicles" : ""];
}

/** The tiles; of several plans a table with one column for each. */
function showFigures(rows) {
  const plans = plansShown();
  byId("plans").hidden = !plans.length;
  byId("figures").hidden = plans.length > 0;
  if (plans.length) {
    showPlans(rows, plans);
    return;
  }
  const all = risk.reduce((sum, of_row) => sum + of_row, 0);
  byId("figures").replaceChildren(...figuresIn(rows, shownRuns(), all).map(([name, value, note, look]) =>
    make("div", { className: look || "" }, make("dt", { textContent: name }), make("dd", { textContent: value }), ...(note ? [make("dd", { className: "note", textContent: note })] : []))));
}

/** The rows of one plan. */
const rowsOfPlan = (rows, plan) => rows.filter((row) => variantOf[column.run[row]] === plan);

function showPlans(rows, plans) {
  const shown = plans.slice(0, MOST_VARIANTS);
  const of_plan = shown.map((plan, place) => [["runs", number(plan.runs.length)],
    ...figuresIn(rowsOfPlan(rows, place), plan.runs.map((run) => data.runs[run]), 0)]);
  const names = [...new Map(of_plan.flat().map(([name, , , look]) => [name, look]))];
  const value = (place, name) => of_plan[place].find(([known]) => known === name)?.[1] ?? "–";
  const heading = (text, scope, look) => make("th", { scope, className: scope === "col" ? "number" : "" },
    ...(look ? [sign(0, `var(--${look})`), " "] : []), text);
  const corner = make("th", { scope: "col", textContent: "Plan" });
  // Side by side while they fit; beyond that, a line each.
  const [head, lines] = shown.length <= MOST_PLANS
    ? [shown.map((_, place) => heading(planNames()[place], "col")),
      names.map(([name, look]) => make("tr", {}, heading(name, "row", look), ...shown.map((_, place) => numberCell(value(place, name)))))]
    : [names.map(([name, look]) => heading(name, "col", look)),
      shown.map((_, place) => make("tr", {}, heading(planNames()[place], "row"), ...names.map(([name]) => numberCell(value(place, name)))))];
  byId("planlist").replaceChildren(make("thead", {}, make("tr", {}, corner, ...head)), make("tbody", {}, ...lines));
  const more = plans.length > shown.length ? `The first ${shown.length} of ${number(plans.length)} plans. ` : "";
  byId("planned").textContent = `${more}The plans differ in more than the seed: nothing here adds them up. The map, the charts and the lists below show all of them; choose one in the filter.`;
}

/** A share in words, never rounded to all or to nothing. */
function shareWords(share) {
  const percent = Math.round(100 * share);
  return percent >= 100 ? "more than 99 %" : percent <= 0 ? "less than 1 %" : `${percent} %`;
}

/** What is said above the places with the largest risk index. */
function verdictHead(rows, spots, most, isNumbered) {
  const shown = isPart(rows) ? " that is shown" : "";
  const onMap = isNumbered ? ", numbered on the map" : "";
  if (isOfPlace()) return "Only a part of the net is shown. By risk index:";
  if (spots.length === 1) return `All of the risk index${shown} is at one place:`;
  if (spots.length <= most.length) return `The risk index${shown} is at ${spots.length} places, the largest first${onMap}.`;
  const [of_most, all] = [most, spots].map((some) => some.reduce((sum, spot) => sum + spot.risk, 0));
  const share = of_most / all;
  return `Most dangerous: ${shareWords(share)} of the risk index${shown} is at these ${most.length} places${onMap}.`;
}

/** Which of these places may have another order by chance, in a sentence; empty where their intervals lie apart. */
function orderWords(most) {
  const pairs = most.flatMap((spot, rank) => most.slice(0, rank).map((before, place) => [place, rank, mayOutrank(spot, before)])).filter(([, , may]) => may);
  if (!pairs.length) return "";
  if (most.length === 2) return "The two intervals overlap, so the order of these places may be chance.";
  if (pairs.length === (most.length * (most.length - 1)) / 2) return "The intervals of all of these places overlap, so their order may be chance.";
  const named = pairs.map(([one, other]) => `${one + 1} and ${other + 1}`);
  return `The intervals of ${named.join(", and of ")} overlap, so their order may be chance.`;
}

/** The same of a list that is ranked after its first place. */
function doubtWords(listed) {
  const others = listed.slice(1).filter((spot) => mayOutrank(spot, listed[0])).length;
  const after = listed.length - 1;
  if (!others) return "";
  if (after === 1) return "The intervals of the two places overlap: their order may be chance.";
  if (others === after && after === 2) return "The intervals of both places after the first overlap its own: their ranks may be chance.";
  if (others === after) return `The intervals of all ${number(after)} places after the first overlap its own: their ranks may be chance.`;
  return others === 1 ? `The interval of one of the ${number(after)} places after the first overlaps its own: its rank may be chance.`
    : `The intervals of ${number(others)} of the ${number(after)} places after the first overlap its own: their ranks may be chance.`;
}

/** The places with the largest risk index that the verdict names; none where it rounds to nothing. */
function mostOf(spots) {
  const all = spots.reduce((sum, spot) => sum + spot.risk, 0);
  return all < 0.05 ? [] : spots.filter((spot) => spot.risk > 0).slice(0, MOST_BADGES);
}
/** Those that have a number on the map: the places of one plan. */
const numbered = (rows) => (plansShown().length ? [] : mostOf(spotRows(rows)));

/** The verdict on the spots of some rows, as elements. */
function verdictOn(rows, all_spots, isNumbered) {
  const spots = all_spots.filter((spot) => spot.risk > 0);
  const most = mostOf(spots);
  if (!rows.length) return ["No conflict passes the filter."];
  if (!hasRisk) return [];
  if (!spots.length) return ["The conflicts that are shown have no risk index."];
  if (!most.length) return ["The risk index of what is shown rounds to 0.0: no place stands out."];
  const hasBrackets = most.some((spot) => bracketsOf(spot));
  const notes = [hasBrackets && "In brackets: 95 % intervals.", orderWords(most)].filter(Boolean).join(" ");
  return [verdictHead(rows, spots, most, isNumbered),
    make("ol", {}, ...most.map((spot, rank) => make("li", {}, make("b", { textContent: rank + 1 }),
      make("span", {}, make("strong", { textContent: spotName(spot) }), spotWords(spot))))),
    ...(notes ? [make("p", { className: "note", textContent: notes })] : [])];
}

/** Where and why it is dangerous: the worst places, of one plan with the numbers that they have on the map. */
function showVerdict(rows) {
  const plans = plansShown();
  const element = byId("verdict");
  element.classList.toggle("side", plans.length > 0);
  if (plans.length > MOST_PLANS) {
    const how = byId("filter") ? "choose one in the filter to see its most dangerous places" : "the report shows the most dangerous places of each";
    element.replaceChildren(`Of ${number(plans.length)} plans: ${how}.`);
  } else if (plans.length) {
    element.replaceChildren(...plans.map((_, plan) => {
      const of_plan = rowsOfPlan(rows, plan);
      return make("div", {}, make("h3", { textContent: planNames()[plan] }), ...verdictOn(of_plan, spotsOf(of_plan, plan), false));
    }));
  } else {
    const said = verdictOn(rows, spotRows(rows), true);
    // With runs to compare with, the page shows those after the change.
    const after = data.before && said.length ? [make("p", { className: "note", textContent: "After the change:" })] : [];
    element.replaceChildren(...after, ...said);
  }
}
