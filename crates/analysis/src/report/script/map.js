// The map: on the net, a sign for each conflict by kind and severity, or hexagons coloured by the risk index; the
// most dangerous places are numbered as in the table. A click filters by the place.

/** From more conflicts than this on, the map shows the density at first. */
const FEW = 200;
const MODE_WORDS = { density: "risk index", points: "each conflict", difference: "after − before" };

/** The numbers of the most dangerous places, each above its heaviest hexagon or in the middle of its conflicts. */
function badgesOf(view, rows, mode) {
  const most = numbered(rows);
  const taken = [];
  return most.flatMap((spot, rank) => {
    const place = mode === "density" ? density.heaviest(spot, view.scale) : spot;
    const [x, y] = [view.x + (place.x - view.left) * view.scale, view.y + view.height - (place.y - view.bottom) * view.scale];
    let [cx, cy] = [x, y - 28];
    while (taken.some(([other_x, other_y]) => Math.hypot(cx - other_x, cy - other_y) < 20)) cx += 21;
    taken.push([cx, cy]);
    return [{ type: "line", z2: 19, shape: { x1: x, y1: y, x2: cx, y2: cy }, style: { stroke: colours.ink, lineWidth: 1.5 } },
      { type: "circle", z2: 19, shape: { cx: x, cy: y, r: 2.5 }, style: { fill: colours.card, stroke: colours.ink, lineWidth: 1 } },
      { type: "circle", z2: 20, shape: { cx, cy, r: 10 }, style: { fill: colours.card, stroke: colours.ink, lineWidth: 1.5 } },
      { type: "text", z2: 21, x: cx, y: cy, style: { text: String(rank + 1), fill: colours.ink, font: `700 12px ${FONT}`, align: "center", verticalAlign: "middle" } }];
  });
}

/** The outlines of the named places that are areas, with their names. */
function outlines(view) {
  const areas = (data.places || []).filter(({ polygon }) => polygon.length);
  return areas.flatMap(({ name, polygon }) => {
    const points = polygon.map(([x, y]) => [view.x + (x - view.left) * view.scale, view.y + view.height - (y - view.bottom) * view.scale]);
    const top = points.reduce((highest, point) => (point[1] < highest[1] ? point : highest));
    return [{ type: "polygon", z2: 15, silent: true, shape: { points }, style: { fill: null, stroke: colours.ink, lineWidth: 1.5, lineDash: [8, 5] } },
      { type: "text", z2: 16, silent: true, x: top[0], y: top[1] - 3, style: { text: name, fill: colours.ink, stroke: colours.ground, lineWidth: 3, font: `600 12px ${FONT}`, align: "center", verticalAlign: "bottom" } }];
  });
}

/** The map of the conflicts that pass the filter. */
const map = {
  element: byId("map"),
  chart: null,
  rows: [],
  mode: "points",

  /** What the map can show. */
  modes: () => [...(hasRisk ? ["density"] : []), "points", ...(data.before && hasRisk ? ["difference"] : [])],

  /** What it shows at first: each conflict, as long as they do not cover each other. */
  first() {
    this.at_first ||= !hasRisk ? "points" : data.before ? "difference" : shownRows().length > FEW ? "density" : "points";
    return this.at_first;
  },

  start(changed) {
    this.chart = chartIn(this.element, () => this.show(this.rows));
    this.chart.on("datazoom", () => this.point(null));
    const surface = this.chart.getZr();
    surface.on("mousemove", (event) => this.point(event));
    surface.on("click", (event) => this.choose(event));
    surface.on("globalout", () => this.point(null));
    byId("closer").onclick = () => this.zoom(0.5);
    byId("further").onclick = () => this.zoom(2);
    byId("whole").onclick = () => this.window(0, 100, 0, 100);
    for (const mode of this.modes()) {
      const button = make("input", { type: "radio", name: "mode", value: mode });
      button.onchange = () => {
        this.mode = mode;
        changed();
      };
      byId("modes").append(make("label", {}, button, MODE_WORDS[mode]));
    }
    this.element.onkeydown = (event) => this.press(event);
  },

  show(rows) {
    this.rows = rows;
    const [width, height] = [this.chart.getWidth(), this.chart.getHeight()];
    this.axes = equalAxes(extent, width, height, 1.1);
    const zoom = { type: "inside", filterMode: "none", minSpan: 0.01, zoomOnMouseWheel: true, moveOnMouseMove: true };
    this.chart.setOption({
      ...basics(),
      tooltip: { show: false },
      grid: { left: 0, right: 0, top: 0, bottom: 0 },
      xAxis: this.axes.xAxis,
      yAxis: this.axes.yAxis,
      dataZoom: [{ id: "x", xAxisIndex: 0, ...zoom }, { id: "y", yAxisIndex: 0, ...zoom }],
      series: [...(data.tiles ? [tiles.series()] : []), ...(net ? [roadsSeries()] : []), this.series(rows)],
    });
    document.querySelectorAll("input[name=mode]").forEach((button) => { button.checked = button.value === this.mode; });
    this.point(null);
    this.showLegend();
    const most = numbered(rows).map((spot) => spotName(spot) + spotWords(spot));
    describeChart(this.element, `Map of ${number(rows.length)} conflicts. ${most.join(" ")} The table of hot spots has the same as numbers.`);
  },

  /** The series of all signs, the worst on top. */
  series(rows) {
    const ordered = SEVERITIES.flatMap((_, severity) => rows.filter((row) => column.severity[row] === severity));
    const of_look = stamps();
    return {
      id: "signs", type: "custom", coordinateSystem: "cartesian2d", data: [[0, 0]], silent: true, z: 3, clip: false,
      renderItem: (params, api) => {
        const wasClose = this.view?.scale >= CLOSE;
        this.view = viewOf(params, api);
        if (this.view.scale >= CLOSE !== wasClose) this.showLegend();
        // The table ranks the places by what happens after, not by the change.
        const badges = this.mode === "difference" ? [] : badgesOf(this.view, rows, this.mode);
        const over = [...outlines(this.view), ...badges, ...opened.marks(this.view), ...faults.marks(this.view), ...scaleBar(1 / this.view.scale, this.view.height)];
        if (this.mode !== "points") {
          return { type: "group", $mergeChildren: false, children: [...density.children(this.view, rows, this.mode === "difference"), ...over] };
        }
        return { type: "group", $mergeChildren: false, children: [{ type: "signs", shape: { rows: ordered, stamps: of_look, view: this.view }, style: { fill: colours.ink } }, ...over] };
      },
    };
  },

  /** The conflict whose sign is nearest to a pixel, the worst of equally near ones; null if none is near. */
  at(pixel_x, pixel_y) {
    const { x, y, height, scale, left, bottom } = this.view;
    let nearest = null;
    let least = NEAR * NEAR;
    for (const row of this.rows) {
      const aside = x + (column.x[row] - left) * scale - pixel_x;
      const above = y + height - (column.y[row] - bottom) * scale - pixel_y;
      const distance = aside * aside + above * above;
      if (distance < least || (distance === least && nearest !== null && worstFirst(row, nearest) < 0)) {
        least = distance;
        nearest = row;
      }
    }
    return nearest;
  },

  /** Shows the tooltip of the conflict under the pointer. */
  point(event) {
    const place = event && this.view ? this.place(event) : null;
    byId("at").textContent = place ? `x ${number(place[0], 1)} m, y ${number(place[1], 1)} m` : "";
    const tip = byId("tip");
    const shown = place && (this.mode === "points" ? this.at(event.offsetX, event.offsetY) : this.cell(place));
    tip.hidden = shown === null;
    if (shown === null) return;
    tip.replaceChildren(this.mode === "points" ? tipOf(shown) : this.cellTip(shown));
    const [width, height] = [this.element.clientWidth, this.element.clientHeight];
    const side = event.offsetX + 16 + tip.offsetWidth < width ? event.offsetX + 16 : event.offsetX - 16 - tip.offsetWidth;
    tip.style.left = `${Math.max(side, 4)}px`;
    tip.style.top = `${Math.min(event.offsetY + 12, height - tip.offsetHeight - 4)}px`;
  },

  /** The coordinates under the pointer, in m. */
  place({ offsetX, offsetY }) {
    const { x, y, height, scale, left, bottom } = this.view;
    return [left + (offsetX - x) / scale, bottom + (y + height - offsetY) / scale];
  },

  /** The hexagon at a place with its sum; null where it is empty. */
  cell([x, y]) {
    const { x: centre_x, y: centre_y, radius } = density.at(x, y, this.view.scale);
    const near = (cell) => Math.hypot(cell[0] - centre_x, cell[1] - centre_y) < radius / 2;
    return (density.cells || []).find(near) || null;
  },

  cellTip([x, y, value]) {
    const what = this.mode === "difference" ? "risk index, after − before" : "risk index";
    const text = `${value > 0 && this.mode === "difference" ? "+" : ""}${number(value, 3)} ${what}`;
    const many = this.rows.filter((row) => Math.hypot(column.x[row] - x, column.y[row] - y) <= density.radius(this.view.scale)).length;
    return make("div", { className: "tip" }, make("b", { textContent: text }),
      make("div", { textContent: `${number(many)} conflicts here and around` }));
  },

  /** Opens the conflict whose sign is clicked, or filters by the circle of the hexagon. */
  choose(event) {
    if (!this.view) return;
    if (this.mode === "points") {
      const row = this.at(event.offsetX, event.offsetY);
      if (row !== null) opened.open(row);
      return;
    }
    const cell = this.cell(this.place(event));
    if (cell) choosePlace(null, [Math.round(cell[0]), Math.round(cell[1]), Math.ceil(density.radius(this.view.scale))]);
  },

  /** Moves and zooms by the keyboard. */
  press(event) {
    const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    if (step) this.move(...step);
    else if (event.key === "+") this.zoom(0.5);
    else if (event.key === "-") this.zoom(2);
    else if (event.key === "0") this.window(0, 100, 0, 100);
    else return;
    event.preventDefault();
  },

  /** Moves by a fifth of what is shown. */
  move(along, up) {
    const [x_start, x_end, y_start, y_end] = this.spans();
    const span = x_end - x_start;
    const start = (from, by) => Math.min(Math.max(from + (by * span) / 5, 0), 100 - span);
    const [x, y] = [start(x_start, along), start(y_start, up)];
    this.window(x, x + span, y, y + span);
  },

  /** The part of each axis that is shown, in percent. */
  spans() {
    const [x, y] = this.chart.getOption().dataZoom;
    return [x.start, x.end, y.start, y.end];
  },

  window(x_start, x_end, y_start, y_end) {
    this.chart.dispatchAction({ type: "dataZoom", batch: [
      { dataZoomId: "x", start: x_start, end: x_end }, { dataZoomId: "y", start: y_start, end: y_end }] });
  },

  /** Scales the shown part of the map by a factor around its centre. */
  zoom(by) {
    const [x_start, x_end, y_start, y_end] = this.spans();
    const span = Math.min(Math.max((x_end - x_start) * by, 0.01), 100);
    const start = (from, to) => Math.min(Math.max((from + to - span) / 2, 0), 100 - span);
    const [x, y] = [start(x_start, x_end), start(y_start, y_end)];
    this.window(x, x + span, y, y + span);
  },

  /** Moves to a position and shows this many metres around it. */
  go(x, y, metres) {
    const { xAxis, yAxis } = this.axes;
    const [wide, high] = [xAxis.max - xAxis.min, yAxis.max - yAxis.min];
    const span = Math.min(100, (100 * metres) / Math.min(wide, high));
    const start = (at, axis, length) => Math.min(Math.max((100 * (at - axis.min)) / length - span / 2, 0), 100 - span);
    const [from_x, from_y] = [start(x, xAxis, wide), start(y, yAxis, high)];
    this.window(from_x, from_x + span, from_y, from_y + span);
    this.element.scrollIntoView({ block: "center" });
  },

  /** What the signs or the colours mean. */
  showLegend() {
    const entry = (picture, text) => make("span", { className: "key" }, picture, text);
    const patch = (colour) => {
      const box = make("i");
      box.style.background = colour;
      return box;
    };
    const entries = [];
    if (this.mode === "points") {
      KINDS.forEach((name, kind) => entries.push(entry(sign(kind, "var(--ink)"), name)));
      SEVERITIES.forEach((name, severity) => filter.severities[severity] && entries.push(entry(patch(`var(--${name})`), name)));
    } else if (density.ends) {
      const upTo = (end) => number(density.ends[end], Math.min(Math.max(Math.ceil(-Math.log10(density.ends[end]) - 1e-9), 0), 4));
      if (this.mode === "difference") {
        [[3, "fewer"], [2, "fewer"], [1, "fewer"], [1, "more"], [2, "more"], [3, "more"]].forEach(([step, what]) => {
          const text = { 1: `up to ${upTo(1)} ${what}`, 2: `${upTo(1)} to ${upTo(3)} ${what}`, 3: `more than ${upTo(3)} ${what}` }[step];
          entries.push(entry(patch(`var(--${what}-${step})`), text));
        });
      } else {
        density.ends.forEach((end, heat) => entries.push(entry(patch(`var(--heat-${heat + 1})`), heat ? `${upTo(heat - 1)} to ${upTo(heat)}` : `below ${upTo(0)}`)));
      }
    }
    const words = { points: "", density: `Risk index of each hexagon, ${number(2 * density.radius(this.view?.scale || 1), 0)} m across:`,
      difference: "Risk index after minus before, for as much traffic as after; only the choice of severities applies:" };
    if (net && this.view?.scale >= CLOSE) {
      entries.push(entry(patch("var(--signal)"), "stop line of a signal"), entry(patch("var(--yield)"), "has to yield"));
    }
    if (faults.isOnMap) {
      const box = patch("var(--card)");
      box.style.border = "2px solid var(--ink)";
      entries.push(entry(box, "fault of the net"));
    }
    const circled = { points: "Circled numbers: the first places of the table, whole junctions and edges",
      density: "Circled numbers: the first places of the table, whole junctions and edges, each at its hexagon with the most" }[this.mode];
    const background = data.tiles ? [make("span", { className: "said", textContent: data.tiles.by })] : [];
    byId("legend").replaceChildren(words[this.mode], ...entries, ...background, ...(circled && numbered(this.rows).length ? [make("span", { className: "said", textContent: circled })] : []));
  },
};
