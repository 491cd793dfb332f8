// A sign for each conflict, by kind and severity: 300,000 of them as one shape.

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
