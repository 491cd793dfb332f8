// The background map: squares of a server, only if the report was asked for them.

/** A tile has this many pixels on a side. */
const TILE = 256;
/** The greatest zoom that servers have, and the most tiles of a view. */
const MOST_ZOOM = 19;
const MOST_TILES = 80;
/** Roads and signs stand out from it. */
const PALE = 0.55;

const tiles = {
  /** From the web mercator square to the net's metres. */
  place(u, v) {
    const [x, y, u0, v0, u_x, u_y, v_x, v_y] = data.tiles.square;
    const size = u_x * v_y - u_y * v_x;
    return [x + (v_y * (u - u0) - u_y * (v - v0)) / size, y + (u_x * (v - v0) - v_x * (u - u0)) / size];
  },

  /** From the net's metres to the square. */
  square([at_x, at_y]) {
    const [x, y, u0, v0, u_x, u_y, v_x, v_y] = data.tiles.square;
    return [u0 + u_x * (at_x - x) + u_y * (at_y - y), v0 + v_x * (at_x - x) + v_y * (at_y - y)];
  },

  /** The tiles in a view, as pictures. */
  children(view) {
    const { x, y, width, height, scale, left, bottom } = view;
    const [u_x, , v_x] = data.tiles.square.slice(4);
    const perPixel = Math.hypot(u_x, v_x) / scale;
    const zoom = Math.max(0, Math.min(MOST_ZOOM, Math.round(-Math.log2(perPixel * TILE))));
    const many = 2 ** zoom;
    const corners = [[left, bottom], [left + width / scale, bottom], [left, bottom + height / scale], [left + width / scale, bottom + height / scale]].map((point) => this.square(point));
    const [low, high] = [Math.min, Math.max].map((end) => [0, 1].map((axis) => Math.floor(end(...corners.map((corner) => corner[axis])) * many)));
    if ((high[0] - low[0] + 1) * (high[1] - low[1] + 1) > MOST_TILES) return [];
    const on = (u, v) => {
      const [to_x, to_y] = this.place(u, v);
      return [x + (to_x - left) * scale, y + height - (to_y - bottom) * scale];
    };
    const children = [];
    for (let column_of = low[0]; column_of <= high[0]; column_of++) {
      for (let line = low[1]; line <= high[1]; line++) {
        const [begin, right] = [on(column_of / many, line / many), on((column_of + 1) / many, line / many)];
        const url = data.tiles.url.replace("{z}", zoom).replace("{x}", column_of).replace("{y}", line);
        const side = Math.hypot(right[0] - begin[0], right[1] - begin[1]);
        children.push({ type: "image", silent: true, x: begin[0], y: begin[1], rotation: -Math.atan2(right[1] - begin[1], right[0] - begin[0]),
          // Half a pixel more, against seams.
          style: { image: url, x: 0, y: 0, width: side + 0.5, height: side + 0.5, opacity: PALE } });
      }
    }
    return children;
  },

  series() {
    return { id: "tiles", type: "custom", coordinateSystem: "cartesian2d", data: [[0, 0]], silent: true, z: -1, clip: true, tooltip: { show: false },
      renderItem: (params, api) => ({ type: "group", $mergeChildren: false, children: this.children(viewOf(params, api)) }) };
  },
};
