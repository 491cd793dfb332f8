// One page for people who decide: where it is dangerous, why, and what to know before believing it. It has no controls.

/** The most lines of each list: more than a page holds would push the rest off it. */
const MOST_LINES = { manoeuvres: 4, remarks: 5 };
/** The height of A4 within its margins of 12 mm, less what printers round, in the screen's pixels; and how small it may become. */
const SHEET = 1020;
const LEAST_FIT = 0.5;
/** Room around what the map shows, as a part of it. */
const MARGIN = 1.08;
/** The dots of a sheet of paper for each of the screen's. */
const SHARP = 3;

/** A map with all conflicts, the worst on top, and the numbers of the verdict. */
function drawPicture(rows, places) {
  const canvas = byId("picture");
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  Object.assign(canvas, { width: width * SHARP, height: height * SHARP });
  const context = canvas.getContext("2d");
  context.scale(SHARP, SHARP);
  const { xAxis, yAxis, metresPerPixel } = equalAxes(extent, width, height, MARGIN);
  const view = { x: 0, y: 0, width, height, scale: 1 / metresPerPixel, left: xAxis.min, bottom: yAxis.min };
  paintRoads(context, view);
  const on = (x, y) => [(x - view.left) * view.scale, height - (y - view.bottom) * view.scale];
  const shown = [...rows].sort((a, b) => column.severity[a] - column.severity[b]);
  for (const row of shown) {
    const [x, y] = on(column.x[row], column.y[row]);
    const size = 0.5 + column.severity[row] * 0.1;
    context.save();
    context.translate(x - 5 * size, y - 5 * size);
    context.scale(size, size);
    context.fillStyle = severityColour(column.severity[row]);
    context.fill(new Path2D(SIGN_PATHS[column.kind[row]]));
    context.restore();
  }
  Object.assign(context, { font: `700 12px ${FONT}`, textAlign: "center", textBaseline: "middle", strokeStyle: colours.ink, lineWidth: 1.5 });
  const taken = [];
  places.forEach((place, rank) => {
    const [x, y] = on(place.x, place.y);
    let [to_x, to_y] = [x, Math.max(y - 26, 12)];
    while (taken.some(([other_x, other_y]) => Math.hypot(to_x - other_x, to_y - other_y) < 22)) to_x += 23;
    taken.push([to_x, to_y]);
    context.beginPath();
    context.moveTo(x, y);
    context.lineTo(to_x, to_y);
    context.stroke();
    context.beginPath();
    context.arc(to_x, to_y, 10, 0, 2 * Math.PI);
    context.fillStyle = colours.card;
    context.fill();
    context.stroke();
    context.fillStyle = colours.ink;
    context.fillText(String(rank + 1), to_x, to_y + 0.5);
  });
}

/** What the signs mean. */
function showKey() {
  const key = (picture, text) => make("span", { className: "key" }, picture, text);
  byId("pictured").replaceChildren(...SEVERITIES.flatMap((name, severity) => (filter.severities[severity] ? [key(sign(0, `var(--${name})`), name)] : [])),
    ...KINDS.map((name, kind) => key(sign(kind, "var(--ink)"), name)));
}

/** The manoeuvres with the most risk, or where there is none the most frequent, and their usual causes. */
function showHappens(rows) {
  const groups = [...grouped(rows.filter((row) => manoeuvreOf(row)), (row) => [manoeuvreOf(row)])].map(([name, of_name]) => ({ name, ...sums(of_name) }));
  groups.sort((a, b) => b.risk - a.risk || b.rows.length - a.rows.length);
  const shown = groups.slice(0, MOST_LINES.manoeuvres);
  const most = shown.reduce((all, group) => Math.max(all, group.risk), 0) || 1;
  const head = ["", "critical", "serious", ...(hasRisk ? ["risk index", ""] : []), "mostly because"];
  const line = (group) => {
    const cause = usual(group.rows, strongestCause);
    return make("tr", {}, textCell(OFTEN[group.name] || inWords(group.name)), ...[2, 1].map((severity) => numberCell(number(group.counts[severity]))),
      ...(hasRisk ? [numberCell(number(group.risk, 1)), shareBar(group, most)] : []), textCell(cause ? WHY[cause] || inWords(cause) : "not known"));
  };
  byId("happens").replaceChildren(make("thead", {}, make("tr", {}, ...head.map((textContent, place) => make("th", { textContent, scope: "col", className: [1, 2].includes(place) || textContent === "risk index" ? "number" : "" })))),
    make("tbody", {}, ...shown.map(line)));
  byId("happens").parentElement.hidden = !shown.length;
}

/** The remarks, as many as the page holds. */
function shortenRemarks() {
  const lines = [...document.querySelectorAll("#remarks li")];
  lines.slice(MOST_LINES.remarks).forEach((line) => line.remove());
  const more = lines.length - MOST_LINES.remarks;
  byId("further").textContent = more > 0 ? `${more === 1 ? "One more remark is" : `${more} more remarks are`} in the report.` : "";
}

/** Shrinks the page until it fits on its sheet. */
function fitSheet() {
  const page = document.documentElement;
  for (let fit = 1; page.getBoundingClientRect().height > SHEET && fit > LEAST_FIT; ) {
    fit -= 0.02;
    document.body.style.setProperty("--fit", fit.toFixed(2));
  }
}

function startSummary() {
  showHeader(false);
  showRemarks();
  shortenRemarks();
  showReading();
  const rows = shownRows();
  if (data.before) {
    byId("sentence").textContent = [data.before.effects.sentence, data.before.effects.none_of].filter(Boolean).join(" ");
    byId("sentence").hidden = false;
  }
  showFigures(rows);
  showVerdict(rows);
  byId("planned").hidden = true;
  showHappens(rows);
  const [worst_row] = worstRows(rows.filter(isTraffic), 1);
  byId("example").hidden = worst_row === undefined;
  if (worst_row !== undefined) byId("worstone").textContent = storyOf(worst_row);
  showKey();
  fitSheet();
  drawPicture(rows, numbered(rows));
}

startSummary();
document.documentElement.dataset.ready = Math.round(performance.now());
