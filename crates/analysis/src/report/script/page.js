// The page from top to bottom: the parts that are drawn once, and those that follow the filter.

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
  showRemarks();
  showReading();
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
    opened.shownRow = undefined;
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
