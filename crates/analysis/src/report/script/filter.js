// The filter of the page: what it shows, its form, and its text in the address, so that a view can be sent. The names are
// those of the command's options.

/** Whether the log has more than cautions: then those are folded away at first. */
const hasSevere = column.severity.some((severity) => severity > 0);

/** Which conflicts the page shows. A choice is null for all; a place is a spot, or a circle in m. */
const filter = {};
const NO_FILTER = { kinds: [true, true, true], severities: [true, true, true], from: -Infinity, to: Infinity,
  manoeuvre: null, cause: null, type: null, area: null, variant: null, run: null, spot: null, circle: null };
const FIRST_FILTER = { ...NO_FILTER, severities: [!hasSevere, true, true] };
const resetFilter = (to) => Object.assign(filter, to, { kinds: [...to.kinds], severities: [...to.severities] });
resetFilter(FIRST_FILTER);

/** The rows that pass the filter; with a part of it left out: "period", "kinds" or "severities". */
function shownRows(without) {
  const rows = [];
  const { manoeuvre, cause, type, area, variant, run, spot, circle } = filter;
  const [kinds, severities] = ["kinds", "severities"].map((part) => (without === part ? NO_FILTER : filter)[part]);
  const { from, to } = without === "period" ? NO_FILTER : filter;
  for (let row = 0; row < count; row++) {
    if (kinds[column.kind[row]] && severities[column.severity[row]]
      && column.time[row] >= from && column.time[row] <= to
      && (manoeuvre === null || column.manoeuvre[row] === manoeuvre)
      && (cause === null || causesOf[column.cause[row]][cause])
      && (type === null || column.ego_type[row] === type || column.foe_type[row] === type)
      && (area === null || column.area[row] === area)
      && (variant === null || variantOf[column.run[row]] === variant)
      && (run === null || column.run[row] === run)
      && (spot === null || spotOf(row) === spot)
      && (circle === null || Math.hypot(column.x[row] - circle[0], column.y[row] - circle[1]) <= circle[2])) {
      rows.push(row);
    }
  }
  return rows;
}

/** The choices of one of many: the list of their names. */
const CHOICES = { manoeuvre: conflicts.manoeuvres, cause: CAUSES, type: conflicts.types, area: conflicts.areas,
  variant: data.variants.map((variant) => variant.name), run: data.runs.map((run, place) => String(place + 1)) };

/** What was chosen, by the names of the command's options; nothing where it is as at first. */
function filterWords() {
  const words = [];
  const chosen = (name, names, boxes, at_first) => {
    if (String(boxes) !== String(at_first)) words.push([name, names.filter((_, place) => boxes[place]).join(",")]);
  };
  chosen("kind", data.kinds, filter.kinds, FIRST_FILTER.kinds);
  chosen("severity", data.severities, filter.severities, FIRST_FILTER.severities);
  for (const [name, names] of Object.entries(CHOICES)) if (filter[name] !== null) words.push([name, names[filter[name]]]);
  if (Number.isFinite(filter.from)) words.push(["from", String(filter.from)]);
  if (Number.isFinite(filter.to)) words.push(["to", String(filter.to)]);
  if (filter.spot !== null) words.push(["where", conflicts.spots[filter.spot].replace(" ", ":")]);
  if (filter.circle) words.push(["where", filter.circle.join(",")]);
  return words;
}

/** Reads the filter in the address; what does not fit this page is passed over. */
function readAddress() {
  resetFilter(FIRST_FILTER);
  const words = new URLSearchParams(location.hash.slice(1));
  const boxes = (name, names, field) => {
    if (words.has(name)) filter[field] = names.map((known) => words.get(name).split(",").includes(known));
  };
  boxes("kind", data.kinds, "kinds");
  boxes("severity", data.severities, "severities");
  for (const [name, names] of Object.entries(CHOICES)) {
    const place = names.indexOf(words.get(name));
    if (place >= 0) filter[name] = place;
  }
  for (const name of ["from", "to"]) {
    const time = Number.parseFloat(words.get(name));
    if (Number.isFinite(time)) filter[name] = time;
  }
  const where = words.get("where") || "";
  const spot = conflicts.spots.indexOf(where.replace(":", " "));
  const circle = where.split(",").map(Number);
  if (where && spot >= 0) filter.spot = spot;
  else if (circle.length === 3 && circle.every(Number.isFinite)) filter.circle = circle;
  opened.row = opened.rowOf(words.get("conflict"));
  opened.missing = words.has("conflict") && opened.row === null ? words.get("conflict") : null;
  map.mode = map.modes().includes(words.get("map")) ? words.get("map") : map.first();
}

function writeAddress() {
  const words = filterWords();
  if (map.mode !== map.first()) words.push(["map", map.mode]);
  if (opened.row !== null) words.push(["conflict", opened.addressOf(opened.row)]);
  const text = words.map(([name, value]) => `${name}=${encodeURIComponent(value).replaceAll("%2C", ",").replaceAll("%3A", ":")}`).join("&");
  if (text !== location.hash.slice(1)) history.replaceState(null, "", text ? `#${text}` : location.pathname + location.search);
}

/** Makes the fields; each change calls `changed`. */
function makeFilter(changed) {
  const boxes = (id, names, chosen, picture) => names.forEach((name, place) => {
    const box = make("input", { type: "checkbox", name: `${id}-${name}` });
    box.onchange = () => {
      filter[chosen][place] = box.checked;
      changed();
    };
    byId(id).append(make("label", {}, box, picture(place), `${name} `, make("small")));
  });
  boxes("kinds", KINDS, "kinds", (kind) => sign(kind, "var(--ink)"));
  boxes("severities", SEVERITIES, "severities", (severity) => sign(0, `var(--${SEVERITIES[severity]})`));
  for (const [name, names] of Object.entries(CHOICES)) {
    const shown = names.map((text, place) => [place, name === "run" ? `${text}: ${data.runs[place].folder}` : inWords(text)]);
    const known = shown.filter(([, text]) => text !== "");
    if (name !== "run" && name !== "variant") known.sort((a, b) => (a[1] < b[1] ? -1 : 1));
    byId(name).parentElement.hidden = known.length < 2;
    byId(name).append(make("option", { value: "", textContent: "all" }), ...known.map(([value, textContent]) => make("option", { value, textContent })));
    byId(name).onchange = () => choose(name, byId(name).value === "" ? null : Number(byId(name).value));
  }
  for (const [name, otherwise] of [["from", -Infinity], ["to", Infinity]]) {
    byId(name).onchange = () => {
      filter[name] = byId(name).value === "" ? otherwise : Number(byId(name).value);
      times.follow();
      changed();
    };
  }
  byId("unfold").onclick = () => byId("unfold").setAttribute("aria-expanded", byId("filter").classList.toggle("open"));
  byId("anywhere").onclick = () => choosePlace(null, null);
  byId("filter").onsubmit = (event) => event.preventDefault();
  byId("filter").onreset = (event) => {
    event.preventDefault();
    resetFilter(NO_FILTER);
    times.follow();
    changed();
  };
}

/** Puts the fields where the filter is. */
function showFilter() {
  for (const [id, names, values] of [["kinds", KINDS, column.kind], ["severities", SEVERITIES, column.severity]]) {
    // How many there are with the rest of the filter.
    const counts = names.map(() => 0);
    for (const row of shownRows(id)) counts[values[row]]++;
    names.forEach((name, place) => {
      const box = document.querySelector(`input[name="${id}-${name}"]`);
      box.checked = filter[id][place];
      box.parentElement.querySelector("small").textContent = number(counts[place]);
    });
  }
  for (const name of Object.keys(CHOICES)) byId(name).value = filter[name] === null ? "" : String(filter[name]);
  const rounded = (time) => (Number.isFinite(time) ? Math.round(time * 10) / 10 : "");
  byId("from").value = rounded(filter.from);
  byId("to").value = rounded(filter.to);
  byId("from").placeholder = Math.floor(period[0]);
  byId("to").placeholder = Math.ceil(period[1]);
  const { spot, circle } = filter;
  byId("here").hidden = spot === null && !circle;
  byId("there").textContent = spot !== null ? nameOfSpot(spot)
    : circle ? `${number(circle[2])} m around ${number(circle[0])}, ${number(circle[1])}` : "";
}

/** Chooses one of many; the same again chooses all. Set by the page. */
let choose = () => {};
let choosePlace = () => {};
