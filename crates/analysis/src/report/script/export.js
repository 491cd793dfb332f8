// The conflicts that the page shows, as files: CSV, and GeoJSON in the net's metres.

/** The columns of a file: names as in the log, each with the text of a row. */
function exported() {
  const names = { ego: egoId, foe: foeId, kind: (row) => data.kinds[column.kind[row]], severity: (row) => data.severities[column.severity[row]],
    nearness: nearnessOf, consequence: consequenceOf, artefact: artefactOf,
    manoeuvre: manoeuvreOf, cause: (row) => conflicts.causes[column.cause[row]], lane: laneId, area: (row) => conflicts.areas[column.area[row]],
    ego_type: (row) => conflicts.types[column.ego_type[row]], foe_type: (row) => conflicts.types[column.foe_type[row]],
    run: (row) => data.runs[column.run[row]].folder, collision: (row) => Boolean(column.collision[row]), unavoidable: (row) => Boolean(column.unavoidable[row]) };
  const first = ["run", "id", "ego", "foe", "ego_type", "foe_type", "kind", "severity", "nearness", "consequence", "artefact",
    "manoeuvre", "cause", "lane", "collision"];
  const rest = Object.keys(column).filter((name) => !first.includes(name) && !["ego_part", "foe_part", "delta_v", ...(data.places ? [] : ["area"])].includes(name));
  return [...first, ...rest].map((name) => [name, names[name] || ((row) => column[name][row])]);
}

/** A cell of CSV. One that a spreadsheet would run as a formula begins with an apostrophe. */
function csvCell(value) {
  if (typeof value !== "string") return value === null || value === undefined ? "" : String(value);
  const safe = /^[=+\-@\t\r]/.test(value) ? `'${value}` : value;
  return /[",\n\r]/.test(safe) ? `"${safe.replaceAll('"', '""')}"` : safe;
}

function csvText(rows) {
  const columns = exported();
  const line = (values) => `${values.map(csvCell).join(",")}\n`;
  return line(columns.map(([name]) => name)) + rows.map((row) => line(columns.map(([, value]) => value(row)))).join("");
}

function geoText(rows) {
  const columns = exported().filter(([name]) => name !== "x" && name !== "y");
  const features = rows.map((row) => ({ type: "Feature", geometry: { type: "Point", coordinates: [column.x[row], column.y[row]] },
    properties: Object.fromEntries(columns.map(([name, value]) => [name, value(row)])) }));
  return JSON.stringify({ type: "FeatureCollection", name: scenarioName, coordinates: "metres of the SUMO net, not degrees", features });
}

function download(extension, type, text) {
  const link = make("a", { href: URL.createObjectURL(new Blob([text], { type })), download: `${scenarioName}.${extension}` });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

function startExport() {
  byId("csv").onclick = () => download("csv", "text/csv", csvText(shownRows(false)));
  byId("geojson").onclick = () => download("geojson", "application/geo+json", geoText(shownRows(false)));
  byId("print").onclick = () => print();
}
