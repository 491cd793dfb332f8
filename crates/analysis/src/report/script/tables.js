// The worst conflicts with drawings, and the records of the runs.

const FIRST_WORST = 6;
const MOST_WORST = 60;

const worst = {
  rows: [],
  many: FIRST_WORST,

  show(rows) {
    this.rows = worstRows(rows, MOST_WORST);
    this.draw();
  },

  more() {
    this.many += FIRST_WORST;
    this.draw();
  },

  draw() {
    this.cards?.forEach((card) => card.dispose());
    this.cards = this.rows.slice(0, this.many).map((row) => new Card(row));
    byId("worst").replaceChildren(...this.cards.map((card) => make("li", {}, ...card.parts)));
    const rest = this.rows.length - this.cards.length;
    byId("more").hidden = rest <= 0;
    byId("more").textContent = `Show ${Math.min(FIRST_WORST, rest)} more of the ${this.rows.length} worst`;
    this.cards.forEach((card) => card.start());
  },
};

/** A conflict: its clip, or a drawing of its worst step, and what it was in words. */
class Card {
  constructor(row, hasLink = true) {
    this.row = row;
    const severity = column.severity[row];
    const run = data.runs.length > 1 ? `, run ${column.run[row] + 1}` : "";
    const title = `no. ${column.id[row]}${run}`;
    const heading = make("h3", {}, sign(column.kind[row], severityColour(severity)), `${SEVERITIES[severity]}, ${KINDS[column.kind[row]]}, `,
      hasLink ? make("a", { href: `#conflict=${opened.addressOf(row)}`, textContent: title, onclick: (event) => {
        event.preventDefault();
        opened.open(row);
      } }) : title);
    this.player = clipOf(row) ? new Player(row) : null;
    const go = make("button", { type: "button", textContent: "Show on the map" });
    go.onclick = () => map.go(column.x[row], column.y[row], 80);
    const figures = make("details", {}, make("summary", { textContent: this.player ? "Figures, and the command for sumo-gui" : "Figures" }), make("p", { textContent: figuresOf(row) }));
    // Paper unfolds nothing.
    figures.open = "print" in document.documentElement.dataset;
    this.text = make("div", { className: "text" }, heading, make("p", { textContent: storyOf(row) }), figures, go);
    if (this.player) {
      const words = ["closecall", "show", data.runs[column.run[row]].folder, String(column.id[row])];
      figures.append(make("p", { className: "screen" }, "Play it in sumo-gui: ", make("code", { textContent: words.map(quoted).join(" ") })));
      this.parts = [this.player.element, this.text];
      return;
    }
    figures.append(make("p", { className: "screen" }, ...whyNoClip(row)));
    if (drawn.has(row)) {
      this.picture = make("div", { className: "chart" });
      this.picture.setAttribute("role", "img");
      this.picture.setAttribute("aria-label", "Both road users at the worst step");
    }
    this.parts = this.picture ? [this.picture, this.text] : [this.text];
  }

  /** Draws once it is in the page. */
  start() {
    this.player?.start();
    if (this.picture) this.chart = drawScene(this.picture, this.row);
  }

  dispose() {
    this.player?.dispose();
    this.chart?.dispose();
  }
}

/** Why a conflict does not play, and the command that makes it. */
function whyNoClip(row) {
  const { folder, options: settings = {} } = data.runs[column.run[row]];
  const level = settings.log_clips || "critical";
  const isSetAside = !isTraffic(row) && !settings.artefacts;
  if (SEVERITIES.includes(level) && SEVERITIES.indexOf(level) <= column.severity[row] && !isSetAside) {
    const words = ["closecall", "clip", folder, String(column.id[row])];
    return [`Only the worst ${data.clips.length} play on this page. Its clip: `, make("code", { textContent: words.map(quoted).join(" ") })];
  }
  const wanted = `--log-clips ${SEVERITIES[column.severity[row]]}${isSetAside ? " --artefacts" : ""}`;
  return ["Its run kept no clip of it. Run it again with ", make("code", { textContent: wanted })];
}

/** A road user's drawing: rectangle, path, and a nose that shows its heading. */
function figure([x, y, heading, length, width, ...path]) {
  const [along_x, along_y] = [Math.cos(heading), Math.sin(heading)];
  const corner = (along, across) => [x + along * along_x - across * along_y, y + along * along_y + across * along_x];
  const [half, size] = [width / 2, length || 1];
  // The log has no size for an obstacle: a small square marks its corner.
  const corners = length ? [corner(0, half), corner(-size, half), corner(-size, -half), corner(0, -half)]
    : [corner(0.5, 0.5), corner(-0.5, 0.5), corner(-0.5, -0.5), corner(0.5, -0.5)];
  const line = [[x, y]];
  for (let at = 0; at + 1 < path.length; at += 2) line.push([path[at], path[at + 1]]);
  return { corners, line, width: width || 1, nose: length ? [corner(0, 0), corner(-Math.min(1.2, length / 3), half * 0.7), corner(-Math.min(1.2, length / 3), -half * 0.7)] : [] };
}

/** Longer ids are shortened in a drawing; the text below it has the whole id. */
const LONGEST_LABEL = 24;

/** A ring around a road user: solid around the ego, dashed around the foe, as in clips and sumo-gui. */
function ringOf(points, isEgo) {
  const middle = [0, 1].map((axis) => points.reduce((sum, point) => sum + point[axis] / points.length, 0));
  const out = points.map((point) => {
    const away = Math.hypot(point[0] - middle[0], point[1] - middle[1]) || 1;
    return [0, 1].map((axis) => point[axis] + ((point[axis] - middle[axis]) * 5) / away);
  });
  return { points: out, lineWidth: isEgo ? 3 : 2, lineDash: isEgo ? [] : [6, 4] };
}

/** The ids: above the upper rectangle and below the lower one. */
function labels(figures, width) {
  const ends = figures.map(({ corners }) => [Math.min(...corners.map((at) => at[1])), Math.max(...corners.map((at) => at[1]))]);
  const upper = ends[0][0] + ends[0][1] <= ends[1][0] + ends[1][1] ? 0 : 1;
  return figures.map(({ corners, id }, place) => {
    const text = id.length > LONGEST_LABEL ? `${id.slice(0, LONGEST_LABEL - 1)}…` : id;
    const centre = corners.reduce((sum, at) => sum + at[0] / corners.length, 0);
    const above = place === upper;
    return { type: "text", x: Math.min(Math.max(centre, 40), width - 40), y: above ? ends[place][0] - 4 : ends[place][1] + 4,
      style: { text, fill: colours.ink, stroke: colours.ground, lineWidth: 3, font: `600 12px ${FONT}`, align: "center",
        verticalAlign: above ? "bottom" : "top" } };
  });
}

/** Draws both road users at the worst step. */
function drawScene(element, row) {
  const [, ego, foe] = drawn.get(row);
  const colour = severityColour(column.severity[row]);
  const figures = [{ ...figure(foe), id: foeId(row), isEgo: false }, { ...figure(ego), id: egoId(row), isEgo: true }];
  // The smaller road user is drawn on top.
  if (foe[3] * foe[4] < ego[3] * ego[4]) figures.reverse();
  const meeting = [column.x[row], column.y[row]];
  const points = [...figures.flatMap(({ corners }) => corners), meeting];
  const box = [0, 1].map((axis) => Math.min(...points.map((point) => point[axis])))
    .concat([0, 1].map((axis) => Math.max(...points.map((point) => point[axis]))));
  const chart = echarts.init(element, null, { renderer: "canvas" });
  const axes = equalAxes([box[0] - 4, box[1] - 4, box[2] + 4, box[3] + 4], chart.getWidth(), chart.getHeight(), 1.1);
  const render = (params, api) => {
    const pixels = 1 / axes.metresPerPixel;
    const on = (list) => list.map((point) => api.coord(point));
    const children = [];
    for (const { line, width, isEgo } of figures) {
      if (line.length < 2) continue;
      children.push({ type: "polyline", shape: { points: on(line) },
        style: { fill: null, stroke: colour, opacity: 0.2, lineWidth: width * pixels, lineJoin: "round" } });
      children.push({ type: "polyline", shape: { points: on(line) },
        style: { fill: null, stroke: colours.ink, lineWidth: 1.5, lineDash: isEgo ? [] : [5, 4] } });
    }
    for (const { corners, nose, isEgo } of figures) {
      children.push({ type: "polygon", shape: { points: on(corners) }, style: { fill: colour, stroke: colours.ink, lineWidth: 1 } });
      const { points, ...ring } = ringOf(on(corners), isEgo);
      children.push({ type: "polygon", shape: { points }, style: { fill: null, stroke: colours.ink, ...ring } });
      if (nose.length) children.push({ type: "polygon", shape: { points: on(nose) }, style: { fill: colours.card, opacity: 0.85 } });
    }
    children.push(...labels(figures.map(({ corners, id }) => ({ corners: on(corners), id })), chart.getWidth()));
    const [x, y] = api.coord(meeting);
    children.push({ type: "circle", shape: { cx: x, cy: y, r: 6 }, style: { fill: null, stroke: colours.meeting, lineWidth: 2.5 } });
    children.push(...scaleBar(axes.metresPerPixel, chart.getHeight()));
    return { type: "group", children };
  };
  chart.setOption({
    ...basics(), tooltip: { show: false },
    grid: { left: 0, right: 0, top: 0, bottom: 0 }, xAxis: axes.xAxis, yAxis: axes.yAxis,
    series: [...(net ? [roadsSeries()] : []),
      { id: "scene", type: "custom", coordinateSystem: "cartesian2d", data: [[0, 0]], z: 5, silent: true, clip: true, renderItem: render }],
  });
  return chart;
}

/** A word of a command line, quoted for a shell if necessary. */
const quoted = (word) => (/^[\w@%+=:,./-]+$/.test(word) ? word : `'${word.replace(/'/g, "'\\''")}'`);

const MOST_RUNS = 50;

function showRuns() {
  const facts = (entries) => make("dl", { className: "facts" }, ...entries.filter(([, value]) => value !== undefined && value !== null)
    .flatMap(([name, value]) => [make("dt", { textContent: name }), make("dd", {}, value)]));
  const code = (text) => make("code", { textContent: text });
  const closed = (title, ...children) => make("details", {}, make("summary", { textContent: title }), ...children);
  const setting = (value) => (typeof value === "object" ? JSON.stringify(value) : String(value));
  data.runs.slice(0, MOST_RUNS).forEach((run, place) => {
    const title = data.runs.length > 1 ? `Run ${place + 1}: ${run.folder}` : run.folder;
    if (!run.versions) {
      byId("runs").append(closed(title, make("p", { textContent: "This log does not contain a run.json." })));
      return;
    }
    const { begin, end, steps, exposure, left_out } = run.summary;
    const changed = Object.entries(run.options).filter(([name, value]) => setting(value) !== setting(data.defaults[name]));
    const details = closed(title,
      facts([
        ["scenario", run.scenario],
        ["versions", `closecall ${run.versions.closecall}${run.versions.sumo ? `, ${run.versions.sumo}` : ", a recording"}`],
        ["command", run.sumo_words.length ? code(["sumo", ...run.sumo_words].map(quoted).join(" ")) : null],
        ["seed", run.seed],
        ["time", `${number(begin, 1)} to ${number(end, 1)} s, ${number(steps)} steps${run.step_length ? ` of ${run.step_length} s` : ""}`],
        ["traffic", `${number(exposure.vehicles)} vehicles, ${number(exposure.persons)} persons, ${number(exposure.vehicle_kilometres, 1)} vehicle-km`],
        ["end", run.complete ? "complete" : `incomplete${run.error ? `: ${run.error}` : ""}`],
        ["options", changed.length ? changed.map(([name, value]) => `${name} ${setting(value)}`).join(", ") : "all at their defaults"],
      ]),
      closed("All options", facts(Object.entries(run.options).map(([name, value]) => [name, setting(value)]))),
      closed(`Input files (${run.inputs.length})`, facts(run.inputs.map(({ path, sha256 }) => [path, code(`SHA-256 ${sha256}`)]))),
      closed("Skipped work", facts(left_out.map(({ what, why, times }) =>
        [what, times === null ? why : `${why} (${number(times)} times)`]))));
    details.open = data.runs.length === 1;
    byId("runs").append(details);
  });
  if (data.runs.length > MOST_RUNS) byId("runs").append(make("p", { textContent: `and ${data.runs.length - MOST_RUNS} more runs` }));
}
