// The map: a sign on the net for each conflict, by kind and severity.

/** The size of a sign on the screen, in pixels, by kind. */
const SIGN_SIZES = [7, 9, 9];
/** The pointer selects a sign within this distance, in pixels. */
const NEAR = 12;

/** More signs than this are drawn dot by dot, without smooth edges, which is ten times as fast. */
const MANY = 10000;

/** One picture of each sign, its size, and the dots that it covers, relative to its centre. */
function stamps() {
  const sharp = window.devicePixelRatio || 1;
  return SEVERITIES.map((_, severity) => KINDS.map((_, kind) => {
    const size = SIGN_SIZES[kind] + severity;
    const dots = Math.ceil(size * sharp);
    const canvas = make("canvas", { width: dots, height: dots });
    const context = canvas.getContext("2d");
    context.scale(dots / 10, dots / 10);
    context.fillStyle = severityColour(severity);
    context.fill(new Path2D(SIGN_PATHS[kind]));
    const picture = new Uint32Array(context.getImageData(0, 0, dots, dots).data.buffer);
    const covered = [];
    let colour = 0;
    picture.forEach((dot, at) => {
      // The highest byte is the opacity.
      if (dot >>> 24 < 128) return;
      colour = Math.max(colour, dot);
      covered.push([(at % dots) - (dots >> 1), Math.floor(at / dots) - (dots >> 1)]);
    });
    return { canvas, size, covered, colour };
  }));
}

/** All signs as one shape, drawn as stamps; one path per sign would take seconds. */
const Signs = echarts.graphic.extendShape({
  shape: { rows: null, stamps: null, view: null },
  buildPath(path) {
    this.context = path.getContext ? path.getContext() : null;
  },
  afterBrush() {
    if (!this.context || !this.shape.rows) return;
    if (this.shape.rows.length > MANY) drawDots(this.context, this.shape);
    else drawStamps(this.context, this.shape);
  },
});

function drawStamps(context, { rows, stamps: of_look, view }) {
  const { x, y, width, height, scale, left, bottom } = view;
  context.globalAlpha = 0.85;
  for (const row of rows) {
    const at_x = (column.x[row] - left) * scale;
    const at_y = height - (column.y[row] - bottom) * scale;
    if (at_x < -NEAR || at_y < -NEAR || at_x > width + NEAR || at_y > height + NEAR) continue;
    const { canvas, size } = of_look[column.severity[row]][column.kind[row]];
    context.drawImage(canvas, x + at_x - size / 2, y + at_y - size / 2, size, size);
  }
  context.globalAlpha = 1;
}

function drawDots(context, { rows, stamps: of_look, view }) {
  const { x, y, scale, left, bottom } = view;
  const sharp = window.devicePixelRatio || 1;
  const [width, height] = [Math.ceil(view.width * sharp), Math.ceil(view.height * sharp)];
  const canvas = make("canvas", { width, height });
  const picture = new ImageData(width, height);
  const dots = new Uint32Array(picture.data.buffer);
  for (const row of rows) {
    const at_x = Math.round((column.x[row] - left) * scale * sharp);
    const at_y = Math.round((view.height - (column.y[row] - bottom) * scale) * sharp);
    if (!(at_x > -NEAR && at_y > -NEAR && at_x < width + NEAR && at_y < height + NEAR)) continue;
    const { covered, colour } = of_look[column.severity[row]][column.kind[row]];
    for (const [aside, down] of covered) {
      const [dot_x, dot_y] = [at_x + aside, at_y + down];
      if (dot_x >= 0 && dot_y >= 0 && dot_x < width && dot_y < height) dots[dot_y * width + dot_x] = colour;
    }
  }
  canvas.getContext("2d").putImageData(picture, 0, 0);
  context.drawImage(canvas, x, y, width / sharp, height / sharp);
}
echarts.graphic.registerShape("signs", Signs);

/** The map of the conflicts that pass the filter. */
const map = {
  element: byId("map"),
  chart: null,
  rows: [],
  start() {
    this.chart = chartIn(this.element, () => this.show(this.rows));
    this.chart.on("datazoom", () => {
      this.point(null);
      this.chart.setOption({ graphic: { elements: this.ruler() } });
    });
    const surface = this.chart.getZr();
    surface.on("mousemove", (event) => this.point(event));
    surface.on("click", (event) => this.point(event));
    surface.on("globalout", () => this.point(null));
    byId("closer").onclick = () => this.zoom(0.5);
    byId("further").onclick = () => this.zoom(2);
    byId("whole").onclick = () => this.window(0, 100, 0, 100);
  },

  show(rows) {
    this.rows = rows;
    const [width, height] = [this.chart.getWidth(), this.chart.getHeight()];
    this.axes = equalAxes(extent, width, height, 1.06);
    const zoom = { type: "inside", filterMode: "none", minSpan: 0.01, zoomOnMouseWheel: true, moveOnMouseMove: true };
    this.chart.setOption({
      ...basics(),
      tooltip: { show: false },
      grid: { left: 0, right: 0, top: 0, bottom: 0 },
      xAxis: this.axes.xAxis,
      yAxis: this.axes.yAxis,
      dataZoom: [{ id: "x", xAxisIndex: 0, ...zoom }, { id: "y", yAxisIndex: 0, ...zoom }],
      series: [...(net ? [roadsSeries()] : []), this.series(rows)],
      graphic: { elements: this.ruler() },
    });
    this.point(null);
  },

  /** The series of all signs, the worst on top. */
  series(rows) {
    const ordered = SEVERITIES.flatMap((_, severity) => rows.filter((row) => column.severity[row] === severity));
    const of_look = stamps();
    return {
      id: "signs", type: "custom", coordinateSystem: "cartesian2d", data: [[0, 0]], silent: true, z: 3, clip: false,
      renderItem: (params, api) => {
        this.view = viewOf(params, api);
        return { type: "signs", shape: { rows: ordered, stamps: of_look, view: this.view }, style: { fill: colours.ink } };
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
      if (distance < least || (distance === least && nearest !== null && byBadness(row, nearest) < 0)) {
        least = distance;
        nearest = row;
      }
    }
    return nearest;
  },

  /** Shows the tooltip of the conflict under the pointer. */
  point(event) {
    const row = event && this.view ? this.at(event.offsetX, event.offsetY) : null;
    const tip = byId("tip");
    tip.hidden = row === null;
    if (row === null) return;
    tip.replaceChildren(tipOf(row));
    const [width, height] = [this.element.clientWidth, this.element.clientHeight];
    const side = event.offsetX + 16 + tip.offsetWidth < width ? event.offsetX + 16 : event.offsetX - 16 - tip.offsetWidth;
    tip.style.left = `${Math.max(side, 4)}px`;
    tip.style.top = `${Math.min(event.offsetY + 12, height - tip.offsetHeight - 4)}px`;
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

  /** The scale bar at the present zoom. */
  ruler() {
    const [start, end] = this.chart.getOption() ? this.spans() : [0, 100];
    return scaleBar((this.axes.metresPerPixel * (end - start)) / 100, this.chart.getHeight());
  },
};
