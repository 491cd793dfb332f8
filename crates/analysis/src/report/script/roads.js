// The net, painted on a canvas in a view of the same scale on both axes.

/** The least width of a lane on the screen, in pixels. */
const THINNEST = 0.8;
/** From this many pixels per metre on, lanes within junctions, stripes of crossings and stop lines are drawn too. */
const CLOSE = 2;
/** The stripes of a crossing and the gaps between them, and the width of a stop line, in m. */
const STRIPE = 0.5;
const STOP = 0.5;

/** Lines from whole numbers (a count, then differences in cm): points in m, the index of each line's start, its box. */
function readLines(numbers) {
  const points = [];
  const starts = [];
  const boxes = [];
  let x = 0;
  let y = 0;
  for (let at = 0; at < numbers.length;) {
    const points_of_line = numbers[at++];
    const box = [Infinity, Infinity, -Infinity, -Infinity];
    starts.push(points.length);
    for (let point = 0; point < points_of_line; point++) {
      x += numbers[at++];
      y += numbers[at++];
      points.push(x / 100, y / 100);
      box[0] = Math.min(box[0], x / 100);
      box[1] = Math.min(box[1], y / 100);
      box[2] = Math.max(box[2], x / 100);
      box[3] = Math.max(box[3], y / 100);
    }
    boxes.push(box);
  }
  starts.push(points.length);
  return { points: Float64Array.from(points), starts, boxes };
}

const net = data.net && {
  lanes: data.net.lanes.map((group) => ({ look: group.look, width: group.width, lines: readLines(group.lines) })),
  junctions: readLines(data.net.junctions),
  stops: data.net.stops.map(({ rule, lines }) => ({ rule, lines: readLines(lines) })),
};

/** Traces the lines of a group that are in view: thousands of lanes take a few strokes. */
function trace(context, { lines, view, closed }) {
  const { points, starts, boxes } = lines;
  const { x, y, width, height, scale, left, bottom } = view;
  const right = left + width / scale;
  const top = bottom + height / scale;
  for (let line = 0; line < boxes.length; line++) {
    const box = boxes[line];
    if (box[0] > right || box[2] < left || box[1] > top || box[3] < bottom) continue;
    for (let at = starts[line]; at < starts[line + 1]; at += 2) {
      const to_x = x + (points[at] - left) * scale;
      const to_y = y + height - (points[at + 1] - bottom) * scale;
      if (at === starts[line]) context.moveTo(to_x, to_y);
      else context.lineTo(to_x, to_y);
    }
    if (closed) context.closePath();
  }
}

/** The net from the ground up: groups of lines, each with its style at this many pixels per metre. */
function roadLayers(scale) {
  const layers = [{ lines: net.junctions, closed: true, style: { fill: colours.junction, stroke: null } }];
  const draw = (lines, stroke, lineWidth, more) => layers.push({ lines, closed: false,
    style: { fill: null, stroke, lineWidth, lineCap: "butt", lineJoin: "round", ...more } });
  const isClose = scale >= CLOSE;
  for (const { look, width: lane, lines } of net.lanes) {
    if (look === "within" && isClose) draw(lines, colours.within, 1, { lineDash: [4, 4] });
    // Drawn slightly narrower than it is, so that adjacent lanes remain distinct.
    if (look === "road") draw(lines, colours.road, Math.max((lane - 0.25) * scale, THINNEST));
    if (look === "foot" && isClose) draw(lines, colours.foot, Math.max((lane - 0.25) * scale, THINNEST));
    if (look === "crossing" && isClose) draw(lines, colours.crossing, lane * scale, { lineDash: [STRIPE * scale, STRIPE * scale], opacity: 0.9 });
  }
  if (isClose) for (const { rule, lines } of net.stops) draw(lines, colours[rule], STOP * scale);
  return layers;
}

/** Paints the net on a canvas. */
function paintRoads(context, view) {
  for (const { lines, closed, style } of net ? roadLayers(view.scale) : []) {
    const { fill, stroke, lineWidth, lineJoin, lineDash = [], opacity = 1 } = style;
    context.beginPath();
    trace(context, { lines, view, closed });
    Object.assign(context, { globalAlpha: opacity, fillStyle: fill, strokeStyle: stroke, lineWidth: lineWidth || 1, lineJoin: lineJoin || "miter" });
    context.setLineDash(lineDash);
    if (fill) context.fill();
    if (stroke) context.stroke();
  }
  context.globalAlpha = 1;
  context.setLineDash([]);
}

/** The bounding box of the net and all conflicts, in m. */
const extent = (() => {
  const box = [Infinity, Infinity, -Infinity, -Infinity];
  const hold = (left, bottom, right, top) => {
    box[0] = Math.min(box[0], left);
    box[1] = Math.min(box[1], bottom);
    box[2] = Math.max(box[2], right);
    box[3] = Math.max(box[3], top);
  };
  if (net) for (const { lines } of net.lanes) lines.boxes.forEach((of_line) => hold(...of_line));
  for (let row = 0; row < count; row++) hold(column.x[row], column.y[row], column.x[row], column.y[row]);
  return box[0] <= box[2] ? box : [0, 0, 100, 100];
})();

/** Two axes with the same scale that show a box as large as it fits. */
function equalAxes(box, width, height, margin) {
  const metres = Math.max((box[2] - box[0]) / width, (box[3] - box[1]) / height, 0.02) * margin;
  const [x, y] = [(box[0] + box[2]) / 2, (box[1] + box[3]) / 2];
  const one = (centre, pixels) => ({ type: "value", show: false, min: centre - (metres * pixels) / 2, max: centre + (metres * pixels) / 2 });
  return { xAxis: one(x, width), yAxis: one(y, height), metresPerPixel: metres };
}

/** A bar of a round length with a label. */
function scaleBar(metresPerPixel, height) {
  const wanted = metresPerPixel * 110;
  const power = 10 ** Math.floor(Math.log10(wanted));
  const length = [5, 2, 1].find((digit) => digit * power <= wanted) * power;
  const text = length >= 1000 ? `${number(length / 1000)} km` : `${number(length, length < 1 ? 1 : 0)} m`;
  const pixels = length / metresPerPixel;
  const line = { points: [[10, height - 18], [10, height - 12], [10 + pixels, height - 12], [10 + pixels, height - 18]] };
  return [
    { type: "polyline", silent: true, z2: 30, shape: line, style: { stroke: colours.ink, fill: null, lineWidth: 1.5 } },
    { type: "text", silent: true, z2: 30, x: 16 + pixels, y: height - 22,
      style: { text, fill: colours.ink, stroke: colours.ground, lineWidth: 3, font: `12px ${FONT}` } },
  ];
}

