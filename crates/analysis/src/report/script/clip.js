// The clips of the worst conflicts: where the road users were in the seconds around the worst step.

/** Numbers from the differences between them; null where one is missing. */
function readDifferences(list, scale) {
  let last = 0;
  return list.map((step) => (step === null ? null : (last += step) / scale));
}

const clipData = new Map(data.clips);
const clipsRead = new Map();

/** The first time in a conflict at which its two rectangles overlap by more than the contact tolerance; null where its clip shows none. */
function contactOf(row) {
  const clip = clipOf(row);
  if (!clip || clip.users.slice(0, 2).some((user) => user.outlines)) return null;
  const corners = ({ x, y, heading, length, width }, place) => figure([x[place], y[place], heading[place], length, width]).corners;
  const touches = (time, place) => time >= column.begin[row] && time <= column.end[row]
    && clip.users.slice(0, 2).every(({ x }) => x[place] !== null)
    && depth(...clip.users.slice(0, 2).map((user) => corners(user, place))) > (options.contact_tolerance || 0);
  const place = clip.times.findIndex(touches);
  return place < 0 ? null : clip.times[place];
}

/** How deep two convex outlines overlap, in m: the shortest move across a side of either that parts them; negative if they are apart. */
function depth(one, other) {
  const across = (sides) => sides.map(([x, y], side) => {
    const [to_x, to_y] = sides[(side + 1) % sides.length];
    const [a, b] = [one, other].map((points) => points.map(([at_x, at_y]) => at_x * (to_y - y) - at_y * (to_x - x)));
    return Math.min(Math.max(...a) - Math.min(...b), Math.max(...b) - Math.min(...a)) / Math.hypot(to_x - x, to_y - y);
  });
  return Math.min(...across(one), ...across(other));
}

/** The clip of a conflict; nothing where the page has none. */
function clipOf(row) {
  if (!clipsRead.has(row) && clipData.has(row)) clipsRead.set(row, readClip(row, clipData.get(row)));
  return clipsRead.get(row);
}

function readClip(row, { time, severity, left, users, signals }) {
  const metres = (list) => readDifferences(list, 100);
  const times = readDifferences(time, 1000);
  const nearest = (at) => times.reduce((best, one, place) => (Math.abs(one - at) < Math.abs(times[best] - at) ? place : best), 0);
  const user = ({ outlines, category, length, width, x, y, heading, speed }) => (outlines ? { outlines: outlines.map(metres) }
    : { category, length, width, x: metres(x), y: metres(y), heading: metres(heading), speed: speed && metres(speed) });
  // The worst severity so far, as long as the two are in conflict.
  let worst = -1;
  return {
    times,
    severity: severity.map((one) => (worst = Math.max(worst, one), one < 0 ? -1 : worst)),
    left: readDifferences(left, 100),
    users: users.map(user),
    signals: signals.map(({ corners, colours: changes }) => ({ corners: metres(corners), changes })),
    worst: nearest(column.time[row]),
  };
}

/** The last place in a clip whose time is not after this one. */
function placeAt({ times }, time) {
  let place = times.length - 1;
  while (place > 0 && times[place] > time + 1e-6) place--;
  return place;
}

/** Where a road user is at a time, between two places of the clip too: x, y, heading; null where it is absent. */
function poseAt({ times }, user, place, time) {
  const { x, y, heading } = user;
  if (x[place] === null) return null;
  const next = Math.min(place + 1, times.length - 1);
  if (next === place || x[next] === null) return [x[place], y[place], heading[place]];
  const share = Math.min(Math.max((time - times[place]) / (times[next] - times[place]), 0), 1);
  const between = (list) => list[place] + share * (list[next] - list[place]);
  // The short way round.
  const turn = heading[next] - heading[place];
  return [between(x), between(y), heading[place] + share * (turn - 2 * Math.PI * Math.round(turn / (2 * Math.PI)))];
}

/** The response time that the run of a conflict assumed, brakes included, in s. */
function responseOf(row) {
  const { response_time, hydraulic_delay } = { ...data.defaults, ...data.runs[column.run[row]].options };
  return response_time + hydraulic_delay;
}
