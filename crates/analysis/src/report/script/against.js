// Before and after: the difference in a sentence, and a forest plot of rate ratios with their intervals.

/** Both ends of the plot's axis, as ratios; what is beyond ends in an arrow. */
const RATIOS = [1 / 8, 8];
const RATIO_TICKS = [0.125, 0.25, 0.5, 1, 2, 4, 8];
const PLOT = { width: 260, height: 22 };

const ratioText = (ratio) => number(ratio, ratio < 9.95 ? 2 : 0);

/** Where a ratio is in the plot, in its pixels. */
function ratioPlace(ratio) {
  const [low, high] = RATIOS.map(Math.log);
  const share = (Math.log(Math.min(Math.max(ratio, RATIOS[0] / 1.3), RATIOS[1] * 1.3)) - low) / (high - low);
  return 12 + share * (PLOT.width - 24);
}

/** The interval as a line, the ratio as a square; fewer and more have the colours of the map of the difference. */
function forestCell({ value, low, high }) {
  const isSure = low > 1 || (high !== null && high < 1);
  const colour = !isSure ? "var(--faint)" : low > 1 ? "var(--more-3)" : "var(--fewer-3)";
  const middle = PLOT.height / 2;
  const [left, right] = [ratioPlace(low), ratioPlace(high === null ? Infinity : high)];
  const lines = RATIO_TICKS.map((tick) => drawing("line", { x1: ratioPlace(tick), x2: ratioPlace(tick), y1: 0, y2: PLOT.height,
    style: `stroke: var(--${tick === 1 ? "ink" : "rule"}); stroke-width: 1` }));
  const interval = drawing("line", { x1: left, x2: right, y1: middle, y2: middle, style: `stroke: ${colour}; stroke-width: 2` });
  const arrow = (x, to) => drawing("path", { d: `M${x},${middle}l${-6 * to},-4v8z`, style: `fill: ${colour}` });
  const ends = [low < RATIOS[0] ? [arrow(left, -1)] : [], high === null || high > RATIOS[1] ? [arrow(right, 1)] : []].flat();
  const square = value === null ? [] : [drawing("rect", { x: ratioPlace(value) - 4, y: middle - 4, width: 8, height: 8, style: `fill: ${colour}` })];
  return drawing("svg", { width: PLOT.width, height: PLOT.height, viewBox: `0 0 ${PLOT.width} ${PLOT.height}`, "aria-hidden": "true" },
    ...lines, interval, ...ends, ...square);
}

/** A place of either set, by its streets where this page knows them. */
function nameOfPlace(name) {
  const place = conflicts.spots.indexOf(name);
  return place < 0 ? name : nameOfSpot(place);
}

function showAgainst() {
  byId("change").hidden = !data.before;
  if (!data.before) return;
  const { effects } = data.before;
  byId("sentence").textContent = [effects.sentence, effects.none_of].filter(Boolean).join(" ");
  const unit = inWords(effects.rates_per).replace("vehicle kilometre", "vehicle-kilometre");
  byId("compared").textContent = `Rates per ${unit}, after / before, with 95 % intervals (${number(effects.runs[0])} and `
    + `${number(effects.runs[1])} runs). Left of 1: fewer. Grey: the interval includes 1, so that chance alone may explain the difference.`;
  const ticks = drawing("svg", { width: PLOT.width, height: 14, viewBox: `0 0 ${PLOT.width} 14`, "aria-hidden": "true" },
    ...RATIO_TICKS.map((tick) => drawing("text", { x: ratioPlace(tick), y: 11, "text-anchor": "middle", style: "fill: var(--faint); font-size: 11px" },
      tick < 1 ? `1/${1 / tick}` : String(tick))));
  const head = make("tr", {}, ...["What", "After", "Before", "Ratio", "95 % interval"].map((textContent, place) =>
    make("th", { textContent, scope: "col", className: place ? "number" : "" })), make("th", { scope: "col" }, make("span", { className: "unseen", textContent: "Ratio and interval, drawn" }), ticks));
  const lines = [];
  let by = "";
  for (const row of effects.rows) {
    const ofWhat = ["manoeuvre", "place"].includes(row.by) ? effects.what : "conflicts";
    if (row.by !== by && row.by !== "all") lines.push(make("tr", {}, make("th", { textContent: `${ofWhat} by ${row.by}`, colSpan: 6, scope: "colgroup" })));
    by = row.by;
    const { value, low, high } = row.ratio || {};
    const numbers = row.ratio ? [value === null ? "–" : ratioText(value), `${ratioText(low)} to ${high === null ? "∞" : ratioText(high)}`] : ["–", "–"];
    const name = row.by === "place" ? nameOfPlace(row.group) : inWords(row.group || NOT_KNOWN);
    const written = row.counts.map((many) => number(many, Number.isInteger(many) ? 0 : 2));
    lines.push(make("tr", {}, make("td", { textContent: name }), ...[...written, ...numbers].map(numberCell),
      make("td", {}, ...(row.ratio ? [forestCell(row.ratio)] : []))));
  }
  byId("forest").replaceChildren(make("thead", {}, head), make("tbody", {}, ...lines));
}
