// Where the risk is: hexagons on the map, coloured by the sum of the crash probabilities in each; with runs
// to compare with, by the difference per unit of traffic.

/** The wanted radius of a hexagon on a wide map and on a narrow one, in pixels; in metres it is a power of 2, so that it stays while one pans. */
const HEXAGON = [12, 8];
/** A map is wide from this width on, in pixels. */
const WIDE = 600;
const HEATS = 5;

/** Sums of a value over the hexagons of this radius, in m: hexagon → [x, y, sum]. */
function hexagons(radius, points) {
  const found = new Map();
  const [wide, high] = [Math.sqrt(3) * radius, 1.5 * radius];
  for (const { rows, x, y, value } of points) {
    for (const row of rows) {
      // The nearest centre of the row of hexagons below and above.
      const line = y[row] / high;
      let best = null;
      let least = Infinity;
      for (const up of [Math.floor(line), Math.floor(line) + 1]) {
        const aside = (up & 1) / 2;
        const along = Math.round(x[row] / wide - aside);
        const [centre_x, centre_y] = [(along + aside) * wide, up * high];
        const distance = (x[row] - centre_x) ** 2 + (y[row] - centre_y) ** 2;
        if (distance < least) {
          least = distance;
          best = [centre_x, centre_y, up * 1048576 + along];
        }
      }
      const known = found.get(best[2]);
      if (known) known[2] += value(row);
      else found.set(best[2], [best[0], best[1], value(row)]);
    }
  }
  return found;
}

/** The upper ends of the colours' classes: the round numbers 1, 2, 5, 10, 20, … up to the first above the greatest value. */
function classes(values) {
  const most = values.reduce((a, b) => Math.max(a, Math.abs(b)), 0) || 1e-3;
  const round = (place) => [1, 2, 5][((place % 3) + 3) % 3] * 10 ** Math.floor(place / 3);
  let last = Math.floor(3 * Math.log10(most)) - 1;
  while (round(last) < most * 0.9999) last++;
  return Array.from({ length: HEATS }, (_, heat) => round(last - HEATS + 1 + heat));
}

/** The colour of a value among the classes: a heat, or for a difference more or fewer. */
function heatOf(value, ends) {
  const place = Math.min(ends.findIndex((end) => Math.abs(value) <= end * 1.0001), HEATS - 1);
  return place < 0 ? HEATS - 1 : place;
}

const Hexagons = echarts.graphic.extendShape({
  shape: { cells: null, view: null, radius: 1 },
  buildPath(context, { cells, view, radius }) {
    if (!cells) return;
    const { x, y, height, scale, left, bottom } = view;
    for (const [centre_x, centre_y] of cells) {
      const at = [x + (centre_x - left) * scale, y + height - (centre_y - bottom) * scale];
      for (let corner = 0; corner < 6; corner++) {
        const angle = Math.PI / 6 + (corner * Math.PI) / 3;
        const to = [at[0] + radius * scale * 0.96 * Math.cos(angle), at[1] + radius * scale * 0.96 * Math.sin(angle)];
        if (corner) context.lineTo(...to);
        else context.moveTo(...to);
      }
      context.closePath();
    }
  },
});
echarts.graphic.registerShape("hexagons", Hexagons);

const density = {
  /** The radius in m at this scale, in pixels per m. */
  radius: (scale) => 2 ** Math.round(Math.log2(HEXAGON[map.chart.getWidth() < WIDE ? 1 : 0] / scale)),

  /** What is summed: the shown conflicts; for a difference those of the shown severities, after and before, per traffic. */
  points(rows, isDifference) {
    if (!isDifference) return [{ rows, x: column.x, y: column.y, value: (row) => risk[row] }];
    const { before } = data;
    const [after_traffic, before_traffic] = before.effects.traffic;
    const places = (severity) => severity.map((_, row) => row).filter((row) => filter.severities[severity[row]]);
    return [
      { rows: places(column.severity), x: column.x, y: column.y, value: (row) => risk[row] },
      { rows: places(before.severity), x: before.x, y: before.y,
        value: (row) => (-before.crash_probability[row] * after_traffic) / before_traffic },
    ];
  },

  /** The hexagons of a view, by class. */
  children(view, rows, isDifference) {
    const radius = this.radius(view.scale);
    const key = `${radius} ${isDifference}`;
    if (this.key !== key || this.rows !== rows) {
      this.cells = [...hexagons(radius, this.points(rows, isDifference)).values()];
      this.ends = classes(this.cells.map((cell) => cell[2]));
      Object.assign(this, { key, rows });
      map.showLegend();
    }
    const [right, top] = [view.left + view.width / view.scale, view.bottom + view.height / view.scale];
    const of_class = new Map();
    for (const cell of this.cells) {
      const [x, y, value] = cell;
      if (x < view.left - radius || x > right + radius || y < view.bottom - radius || y > top + radius) continue;
      if (Math.abs(value) < this.ends[0] / 50) continue;
      const colour = this.colour(heatOf(value, this.ends), value, isDifference);
      if (!of_class.has(colour)) of_class.set(colour, []);
      of_class.get(colour).push(cell);
    }
    return [...of_class].map(([fill, cells]) => ({ type: "hexagons", shape: { cells, view, radius },
      style: { fill, opacity: 0.92, stroke: colours.faint, lineWidth: 0.5 } }));
  },

  colour(heat, value, isDifference) {
    if (!isDifference) return colours[`heat-${heat + 1}`];
    return colours[`${value < 0 ? "fewer" : "more"}-${heat < 2 ? 1 : heat < 4 ? 2 : 3}`];
  },

  /** The centre of the hexagon with the largest risk index of a spot. */
  heaviest(spot, scale) {
    const radius = this.radius(scale);
    if (spot.heaviest?.radius !== radius) {
      const cells = [...hexagons(radius, [{ rows: spot.rows, x: column.x, y: column.y, value: (row) => risk[row] }]).values()];
      const [x, y] = cells.reduce((most, cell) => (cell[2] > most[2] ? cell : most));
      spot.heaviest = { radius, x, y };
    }
    return spot.heaviest;
  },

  /** The hexagon at a place. */
  at(x, y, scale) {
    const radius = this.radius(scale);
    const [[centre_x, centre_y]] = hexagons(radius, [{ rows: [0], x: [x], y: [y], value: () => 0 }]).values();
    return { x: centre_x, y: centre_y, radius };
  },
};
