// The page from top to bottom: the parts that are drawn once, and those that follow the filter.

/** The most variants whose rates are shown. */
const MOST_VARIANTS = 12;

function showHeader() {
  const records = data.runs.filter((run) => run.summary);
  const scenarios = [...new Set(records.map((run) => run.scenario))];
  const runs = data.runs.length === 1 ? "one run" : `${number(data.runs.length)} runs`;
  const more = scenarios.length > 3 ? ` and ${scenarios.length - 3} more` : "";
  byId("subject").textContent = `${scenarios.slice(0, 3).join(", ") || data.runs.map((run) => run.folder)[0]}${more}: ${runs}`;
  byId("maker").textContent = `Made by closecall ${data.version}. Charts: Apache ECharts ${echarts.version} (Apache-2.0).`;
  const sum = (pick) => records.reduce((all, run) => all + pick(run.summary), 0);
  const of_severity = (severity) => column.severity.reduce((all, of_row) => all + (of_row === severity), 0);
  const kilometres = sum((summary) => summary.exposure.vehicle_kilometres);
  const figures = [["critical", number(of_severity(2))], ["serious", number(of_severity(1))]];
  figures.push(["conflicts", number(data.seen)]);
  figures.push(["collisions", number(column.collision.reduce((all, is) => all + is, 0))]);
  figures.push(["expected crashes (an index, not a forecast)", number(sum((summary) => summary.expected_crashes || 0), 2)]);
  if (records.length) {
    figures.push(["vehicles", number(sum((summary) => summary.exposure.vehicles))], ["vehicle-km", number(kilometres)]);
    // A run that was killed has conflicts but no record of its traffic.
    const isKnown = data.runs.every((run) => run.summary?.steps > 0);
    if (kilometres > 0 && isKnown && data.variants.length < 2) {
      figures.push(["conflicts per vehicle-km", number(data.seen / kilometres, 2)]);
    }
    // Runs that differ in their settings have no common rate.
    if (data.variants.length > 1) data.variants.slice(0, MOST_VARIANTS).forEach((variant) => {
      const summaries = variant.runs.map((run) => data.runs[run].summary);
      const driven = summaries.reduce((all, summary) => all + summary.exposure.vehicle_kilometres, 0);
      const found = summaries.reduce((all, summary) => all + summary.conflicts.reduce((sum, { count }) => sum + count, 0), 0);
      if (driven > 0) figures.push([`conflicts per vehicle-km, ${variant.name}`, number(found / driven, 2)]);
    });
  }
  byId("figures").append(...figures.map(([name, value]) =>
    make("div", {}, make("dt", { textContent: name }), make("dd", { textContent: value }))));
  const notes = [...data.notes];
  if (count < data.seen) notes.push(`This page contains the ${number(count)} worst of ${number(data.seen)} conflicts.`);
  byId("notes").textContent = notes.join(" ");
  byId("notes").hidden = !notes.length;
}

/** The filter's fields; each change calls `changed`. */
function makeFilter(changed) {
  const boxes = (id, names, chosen, picture) => names.forEach((name, place) => {
    const box = make("input", { type: "checkbox", checked: true, name: `${id}-${name}` });
    box.onchange = () => {
      filter[chosen][place] = box.checked;
      changed();
    };
    byId(id).append(make("label", {}, box, picture(place), name));
  });
  boxes("kinds", KINDS, "kinds", (kind) => sign(kind, "var(--ink)"));
  boxes("severities", SEVERITIES, "severities", (severity) => sign(0, `var(--${SEVERITIES[severity]})`));
  const choice = (id, field, words) => {
    byId(field).hidden = words.length < 2;
    byId(id).append(make("option", { value: "", textContent: "all" }), ...words.map(([value, textContent]) => make("option", { value, textContent })));
    byId(id).onchange = () => {
      filter[id] = byId(id).value === "" ? null : Number(byId(id).value);
      changed();
    };
  };
  const types = conflicts.types.map((type, place) => [place, type]).filter(([, type]) => type !== "");
  choice("type", "who", types.sort((a, b) => (a[1] < b[1] ? -1 : 1)));
  choice("variant", "how", data.variants.map((variant, place) => [place, variant.name]));
  choice("run", "which", data.runs.map((run, place) => [place, `${place + 1}: ${run.folder}`]));
  const limit = (id, otherwise) => {
    byId(id).onchange = () => {
      filter[id] = byId(id).value === "" ? otherwise : Number(byId(id).value);
      times.follow();
      changed();
    };
  };
  limit("from", -Infinity);
  limit("to", Infinity);
  byId("filter").onsubmit = (event) => event.preventDefault();
  byId("filter").onreset = () => {
    resetFilter();
    times.follow();
    changed();
  };
}

function showPeriod() {
  byId("from").value = Number.isFinite(filter.from) ? Math.round(filter.from * 10) / 10 : "";
  byId("to").value = Number.isFinite(filter.to) ? Math.round(filter.to * 10) / 10 : "";
  byId("from").placeholder = Math.floor(period[0]);
  byId("to").placeholder = Math.ceil(period[1]);
}

/** Draws the parts that follow the filter. */
function show() {
  const rows = shownRows(false);
  byId("shown").textContent = `${number(rows.length)} of ${number(count)} conflicts`;
  showPeriod();
  map.show(rows);
  times.show(shownRows(true));
  distributions.show(rows);
  showSpots(rows);
  worst.show(rows);
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
    byId("nothing").textContent = "No conflicts were found: no pair came closer than its minimal collision distance μ.";
    byId("nothing").hidden = false;
    byId("filter").hidden = true;
    document.querySelectorAll("main > section").forEach((section) => { section.hidden = !section.querySelector("#runs"); });
    return;
  }
  const showSoon = quietly(show, 150);
  makeFilter(show);
  map.start();
  times.start((from, to) => {
    if (filter.from === from && filter.to === to) return;
    Object.assign(filter, { from, to });
    showSoon();
  });
  distributions.start();
  byId("more").onclick = () => worst.more();
  show();
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    readColours();
    show();
  });
}

startPage();
document.documentElement.dataset.ready = Math.round(performance.now());
