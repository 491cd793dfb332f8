// The curves below a playback: the speeds of both, and the time that the ego has left to respond.

/** In the drawing's own units. */
const CURVES = { width: 360, height: 190, left: 26, right: 8, speed: [18, 74], time: [102, 158] };
/** The top of the axis of the time left, in s. */
const MOST_LEFT = 3;

/** The top of the axis of the speeds, in m/s: the same in all cards. */
const fastestOfClips = () => (fastestOfClips.known ||= [...clipData.keys()].reduce((most, row) => clipOf(row).users.slice(0, 2)
  .flatMap((user) => user.speed || []).reduce((a, b) => Math.max(a, Math.ceil(b / 5) * 5), most), 5));

/** The curves of a clip, with a line that `cursor` moves to a time. */
function drawCurves(row, clip) {
  const { width, height, left, right, speed, time } = CURVES;
  const [first, last, worst] = [clip.times[0], clip.times[clip.times.length - 1], clip.times[clip.worst]];
  const x = (at) => left + ((at - first) / Math.max(last - first, 1e-3)) * (width - left - right);
  const pair = clip.users.slice(0, 2);
  const speeds = pair.map((user) => (user.speed || []).filter((value) => value !== null));
  const fastest = fastestOfClips();
  const y_of = ([top, bottom], most) => (value) => bottom - (Math.min(value, most) / most) * (bottom - top);
  const [y_speed, y_left] = [y_of(speed, fastest), y_of(time, MOST_LEFT)];
  const needed = responseOf(row);

  const text = (words, at_x, at_y, more = {}) => drawing("text", { x: at_x, y: at_y, ...more }, words);
  const rule = (x1, x2, y1, y2, className) => drawing("line", { x1, x2, y1, y2, class: className });
  const axisOf = ([top, bottom], most, y) => [rule(left, width - right, bottom, bottom, "axis"),
    ...[0, most].map((value) => text(String(value), left - 4, y(value) + 4, { "text-anchor": "end" }))];
  const seconds = [];
  for (let second = Math.ceil(first - worst); second <= last - worst + 1e-6; second++) seconds.push(second);
  const ticks = seconds.flatMap((second) => [rule(x(worst + second), x(worst + second), time[1], time[1] + 3, "axis"),
    text(second ? signed(second) : "worst", x(worst + second), time[1] + 14, { "text-anchor": "middle" })]);
  const line = (list, y, className) => {
    let path = "";
    list.forEach((value, place) => {
      if (value !== null) path += `${path && list[place - 1] !== null ? "L" : "M"}${x(clip.times[place]).toFixed(1)} ${y(value).toFixed(1)}`;
    });
    return drawing("path", { d: path, class: className });
  };
  const bars = clip.left.flatMap((value, place) => {
    if (value === null || clip.severity[place] < 0) return [];
    const [from, to] = [x(clip.times[place]), x(clip.times[Math.min(place + 1, clip.times.length - 1)])];
    return [drawing("rect", { x: from, y: y_left(value) - 1, width: Math.max(to - from, 1), height: time[1] - y_left(value) + 1,
      style: `fill: var(--${SEVERITIES[clip.severity[place]]})` })];
  });
  const cursor = rule(0, 0, speed[0] - 4, time[1], "cursor");
  const svg = drawing("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", class: "curves" },
    text("Speed in m/s", left, 10), rule(left + 88, left + 106, 7, 7, "ego"), text("ego", left + 110, 10), rule(left + 142, left + 160, 7, 7, "foe"),
    text("foe", left + 164, 10),
    ...axisOf(speed, fastest, y_speed), line(pair[1].speed || [], y_speed, "foe"), line(pair[0].speed || [], y_speed, "ego"),
    text("Time left to respond, in s, by severity", left, 93),
    ...axisOf(time, MOST_LEFT, y_left), ...bars,
    rule(left, width - right, y_left(needed), y_left(needed), "needed"),
    text(`a driver needs ${number(needed, 2)} s`, left + 4, y_left(needed) - 3),
    ...ticks, text("s before and after the worst step", (left + width - right) / 2, height - 4, { "text-anchor": "middle" }), rule(x(worst), x(worst), speed[0] - 4, time[1], "worst"), cursor);
  const range = (list) => (list.length ? `${number(list[0], 1)} to ${number(list[list.length - 1], 1)} m/s, at most ${number(Math.max(...list), 1)}` : "not known");
  const lefts = clip.left.filter((value) => value !== null);
  describeChart(svg, `Speed of the ego: ${range(speeds[0])}. Speed of the foe: ${range(speeds[1])}. `
    + (lefts.length ? `Time left: least ${number(Math.min(...lefts), 2)} s; a driver needs ${number(needed, 2)} s.` : "No time left is known."));
  return {
    svg,
    cursor(at) {
      cursor.setAttribute("x1", x(at));
      cursor.setAttribute("x2", x(at));
    },
    /** The time at a place on the screen. */
    timeAt(event) {
      const box = svg.getBoundingClientRect();
      const along = ((event.clientX - box.left) / box.width) * width;
      return Math.min(Math.max(first + ((along - left) / (width - left - right)) * (last - first), first), last);
    },
  };
}

/** A number of seconds with its sign. */
const signed = (seconds, decimals = 0) => `${seconds > 0 ? "+" : ""}${number(seconds, decimals)}`;
