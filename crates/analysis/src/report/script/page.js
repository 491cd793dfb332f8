// The page from top to bottom: the parts that are drawn once, and those that follow the filter.

/** The most variants whose rates are shown. */
const MOST_VARIANTS = 12;

/** What the page is about; drawn once. */
function showHeader() {
  const records = data.runs.filter((run) => run.summary);
  const scenarios = [...new Set(records.map((run) => run.scenario))];
  const runs = data.runs.length === 1 ? "one run" : `${number(data.runs.length)} runs`;
  const more = scenarios.length > 3 ? ` and ${scenarios.length - 3} more` : "";
  const sum = (pick) => records.reduce((all, run) => all + pick(run.summary), 0);
  const simulated = sum(({ begin, end }) => end - begin);
  const duration = simulated < 3600 ? `${number(simulated)} s` : `${number(simulated / 3600, 1)} h`;
  const traffic = records.length ? `, ${duration} simulated, ${number(sum((summary) => summary.exposure.vehicles))} vehicles, `
    + `${number(sum((summary) => summary.exposure.vehicle_kilometres))} vehicle-km` : "";
  const title = scenarios.length > 1 ? `${scenarioName} and others` : scenarioName;
  document.title = `${title} – conflicts`;
  byId("name").textContent = title;
  byId("subject").textContent = `Traffic conflicts in ${scenarios.slice(0, 3).join(", ") || data.runs.map((run) => run.folder)[0]}${more}: ${runs}${traffic}`;
  byId("maker").textContent = `Made by closecall ${data.version}. Charts: Apache ECharts ${echarts.version} (Apache-2.0).`;
  const notes = [...data.notes];
  if (count < data.seen) notes.push(`This page contains the ${number(count)} worst of ${number(data.seen)} conflicts.`);
  byId("notes").textContent = notes.join(" ");
  byId("notes").hidden = !notes.length;
}

/** The tiles: what the shown conflicts come to. */
function showFigures(rows) {
  const { counts, risk: crashes } = sums(rows);
  const all = risk.reduce((sum, of_row) => sum + of_row, 0);
  const runs = data.runs.filter((_, run) => (filter.run === null || filter.run === run) && (filter.variant === null || filter.variant === variantOf[run]));
  const kilometres = runs.reduce((sum, run) => sum + (run.summary?.exposure.vehicle_kilometres || 0), 0);
  const of_all = all > crashes + 0.005 ? `of ${number(all, 1)} in all; ` : "";
  const figures = hasRisk ? [["risk index", number(crashes, crashes < 10 ? 2 : 1), `${of_all}the sum of the probabilities that a driver brakes too late: compares places and plans, not a number of crashes`]] : [];
  [2, 1, 0].forEach((severity) => {
    if (filter.severities[severity]) figures.push([SEVERITIES[severity], number(counts[severity]), "", SEVERITIES[severity]]);
  });
  figures.push(["collisions", number(rows.reduce((sum, row) => sum + column.collision[row], 0)), "counted: rectangles that overlapped in the simulation"]);
  // A run that was killed has conflicts but no record of its traffic; a period's traffic is not known.
  const isKnown = runs.every((run) => run.summary?.steps > 0) && !Number.isFinite(filter.from) && !Number.isFinite(filter.to);
  if (isKnown && kilometres > 0 && data.variants.length < 2) {
    figures.push(["conflicts per vehicle-km", number((rows.length * (data.seen / count)) / kilometres, 2)]);
  }
  // Runs that differ in their settings have no common rate.
  if (isKnown && data.variants.length > 1) data.variants.slice(0, MOST_VARIANTS).forEach((variant) => {
    const summaries = variant.runs.map((run) => data.runs[run].summary);
    const driven = summaries.reduce((sum, summary) => sum + summary.exposure.vehicle_kilometres, 0);
    const found = rows.reduce((sum, row) => sum + variant.runs.includes(column.run[row]), 0);
    if (driven > 0) figures.push([`conflicts per vehicle-km, ${variant.name}`, number(found / driven, 2)]);
  });
  byId("figures").replaceChildren(...figures.map(([name, value, note, look]) =>
    make("div", { className: look || "" }, make("dt", { textContent: name }), make("dd", { textContent: value }), ...(note ? [make("dd", { className: "note", textContent: note })] : []))));
}

/** Where and why it is dangerous: the worst places, with the numbers that they have on the map. */
function showVerdict(rows) {
  const spots = spotRows(rows).filter((spot) => spot.risk > 0);
  const element = byId("verdict");
  if (!spots.length) {
    element.textContent = !rows.length ? "No conflict passes the filter."
      : hasRisk ? "The conflicts shown have no risk index." : "";
    return;
  }
  const all = rows.reduce((sum, row) => sum + risk[row], 0);
  const most = spots.slice(0, MOST_BADGES);
  const share = Math.round((100 * most.reduce((sum, spot) => sum + spot.risk, 0)) / all);
  const places = most.length === 1 ? "one place" : `these ${most.length} places`;
  const doubt = most.some((spot, rank) => rank && mayOutrank(spot, most[rank - 1])) ? " They overlap, so the order of these places may be chance." : "";
  element.replaceChildren(`Most dangerous: ${share} % of the risk index is at ${places}, numbered on the map.`,
    make("ol", {}, ...most.map((spot, rank) => make("li", {}, make("b", { textContent: rank + 1 }),
      make("span", {}, make("strong", { textContent: spotName(spot) }), spotWords(spot))))),
    make("p", { className: "note", textContent: `In brackets: 95 % intervals.${doubt}` }));
}

/** One conflict of this log, read aloud. */
function showExample() {
  const [row] = worstRows(everyRow, 1);
  byId("example").textContent = row === undefined ? "" : `For example, the worst conflict here, no. ${column.id[row]}: ${storyOf(row)} ${figuresOf(row)}`;
}

/** Draws the parts that follow the filter. */
function show() {
  const rows = shownRows();
  byId("shown").textContent = `${number(rows.length)} of ${number(count)} conflicts`;
  const words = filterWords().map(([name, value]) => `${name} ${inWords(value)}`);
  byId("printed").textContent = words.length || !filter.severities[0] ? `Shown: ${[!filter.severities[0] && "serious and critical conflicts", ...words].filter(Boolean).join("; ")}.` : "";
  showFilter();
  showFigures(rows);
  showVerdict(rows);
  map.show(rows);
  times.show(shownRows("period"));
  distributions.show(rows);
  showSpots(rows);
  worst.show(rows);
  writeAddress();
}

/** A function that calls `call` after a pause: a moving slider sends many events. */
function quietly(call, milliseconds) {
  let timer = 0;
  return () => {
    clearTimeout(timer);
    timer = setTimeout(call, milliseconds);
  };
}

function startPage() {
  showHeader();
  showRuns();
  if (count === 0) {
    byId("nothing").textContent = data.filter ? `No conflict passes the filter ${data.filter}.`
      : data.set_aside ? "No conflict is traffic’s."
      : "No conflicts were found: no pair came closer than its minimal collision distance μ.";
    byId("nothing").hidden = false;
    byId("filter").hidden = true;
    document.querySelectorAll("main > section, #reading, #figures").forEach((part) => { part.hidden = !part.querySelector("#runs"); });
    faults.start(null, false);
    return;
  }
  const showSoon = quietly(show, 150);
  choose = (name, value) => {
    filter[name] = value;
    show();
  };
  choosePlace = (spot, circle) => {
    Object.assign(filter, { spot, circle });
    show();
  };
  makeFilter(show);
  map.first();
  readAddress();
  showExample();
  showAgainst();
  startExport();
  map.start(show);
  faults.start(show, true);
  times.start((from, to) => {
    if (filter.from === from && filter.to === to) return;
    Object.assign(filter, { from, to });
    showSoon();
  });
  distributions.start();
  byId("more").onclick = () => worst.more();
  show();
  times.follow();
  window.addEventListener("hashchange", () => {
    readAddress();
    times.follow();
    show();
  });
  // Paper is white, and what is drawn follows.
  const redraw = () => {
    readColours();
    show();
    // At once: a page that is about to be printed waits for no frame.
    document.querySelectorAll(".chart").forEach((element) => echarts.getInstanceByDom(element)?.getZr().flush());
  };
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
  let wasOpen = false;
  window.addEventListener("beforeprint", () => {
    document.documentElement.dataset.print = "";
    [wasOpen, byId("reading").open] = [byId("reading").open, true];
    redraw();
    // What is drawn keeps its shape on paper, which is narrower.
    document.querySelectorAll(".chart").forEach((element) => element.style.setProperty("--ratio", element.clientWidth / element.clientHeight || 1));
  });
  window.addEventListener("afterprint", () => {
    delete document.documentElement.dataset.print;
    byId("reading").open = wasOpen;
    redraw();
  });
}

startPage();
document.documentElement.dataset.ready = Math.round(performance.now());
