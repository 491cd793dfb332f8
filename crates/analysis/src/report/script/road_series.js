// The net in the background of a chart.

const Roads = echarts.graphic.extendShape({
  shape: { lines: null, view: null, closed: false },
  buildPath(context, shape) {
    if (shape.lines) trace(context, shape);
  },
});
echarts.graphic.registerShape("roads", Roads);

/** The chart's position on the screen, its pixels per metre, and the coordinates of its lower left corner. */
function viewOf(params, api) {
  const { x, y, width, height } = params.coordSys;
  const origin = api.coord([0, 0]);
  const scale = api.coord([1, 0])[0] - origin[0];
  return { x, y, width, height, scale, left: (x - origin[0]) / scale, bottom: (origin[1] - y - height) / scale };
}

/** The series that draws the net in the background. */
function roadsSeries() {
  return {
    id: "roads", type: "custom", coordinateSystem: "cartesian2d", data: [[0, 0]], silent: true, z: 0, clip: true,
    tooltip: { show: false },
    renderItem(params, api) {
      const view = viewOf(params, api);
      return { type: "group", children: roadLayers(view.scale).map(({ lines, closed, style }) => ({ type: "roads", shape: { lines, view, closed }, style })) };
    },
  };
}
