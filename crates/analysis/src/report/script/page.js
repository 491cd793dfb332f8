// The page from top to bottom: the parts that are drawn once, and those that follow the filter.

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
  const title = scenarioNames.length > MOST_PLANS ? `${scenarioNames.length} scenarios` : scenarioNames.join(" and ");
  document.title = `${title} – conflicts`;
  byId("name").textContent = title;
  byId("subject").textContent = `Traffic conflicts in ${scenarios.slice(0, 3).join(", ") || data.runs.map((run) => run.folder)[0]}${more}: ${runs}${traffic}`;
  byId("maker").textContent = `Made by closecall ${data.version}. Charts: Apache ECharts ${echarts.version} (Apache-2.0).`;
  showRemarks();
  showReading();
}

/** What to know before believing the page: the remarks of the runs, and what closecall says of the logs. */
function showRemarks() {
  const notes = [...data.notes];
  if (count < data.seen) notes.push(`This page contains the ${number(count)} worst of ${number(data.seen)} conflicts.`);
  if (data.scope.artefacts) notes.push("Conflicts that are not traffic’s are shown, too (--artefacts); they count in no figure.");
  const failed = data.runs.filter((run) => run.summary?.steps > 0 && run.complete === false).length;
  if (failed) notes.push(data.runs.length === 1 ? "The run did not reach its end." : `${number(failed)} of ${number(data.runs.length)} runs did not reach their end.`);
  const fill = (id, texts) => {
    byId(id).replaceChildren(...texts.map((textContent) => make("li", { textContent })));
    byId(id).hidden = !texts.length;
  };
  fill("said", data.remarks.map(({ text }) => text));
  fill("notes", notes);
  byId("remarks").hidden = !notes.length && !data.remarks.length;
}

/** A text whose words between asterisks are bold. */
const emphasised = (text) => text.split("*").map((part, place) => (place % 2 ? make("b", { textContent: part }) : part));

/** The sentences of "How to read this page" that name thresholds. */
function showReading() {
  byId("severityrule").replaceChildren(...data.reading.severity.map((text) => make("p", {}, ...emphasised(text))));
  byId("kindrule").replaceChildren(...data.reading.kind.map((text) => make("p", {}, ...emphasised(text))));
  if (data.reading.severity.length > 1) byId("severityrule").prepend(make("p", { textContent: "The runs used several rules of severity:" }));
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
  opened.show();
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
    document.querySelectorAll("main > section, #reading, #figures, #plans").forEach((part) => { part.hidden = !part.querySelector("#runs"); });
    faults.start(null, false);
    return;
  }
  const showSoon = quietly(show, 150);
  opened.start(show);
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
  opened.go();
  window.addEventListener("hashchange", () => {
    readAddress();
    times.follow();
    show();
    opened.go();
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
