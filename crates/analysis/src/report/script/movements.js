// Movement diagrams: which ways through a junction meet in its conflicts, and the risk index of each pair.

/** In the drawing's own units: its size, and the circle on which the approaches lie. */
const DIAGRAM = { width: 380, height: 270, ring: 84 };
/** This many pairs are drawn; the table beside the diagram says how many more there are. */
const MOST_PAIRS = 6;
/** The least angle between two approaches in the drawing. */
const APART = 0.17;
/** Approaches within this angle are one road, with one label. */
const ONE_ROAD = 0.5;
const COMPASS = ["east", "north-east", "north", "north-west", "west", "south-west", "south", "south-east"];
const [INTO, OUT_OF, ON_FOOT] = [0, 1, 2];

const approachesOf = (place) => conflicts.movements.approaches[conflicts.spots[place]];
const compass = (angle) => COMPASS[((Math.round(angle / (Math.PI / 4)) % 8) + 8) % 8];

/** The pairs of movements of some rows, the largest risk index first. */
function movementPairs(rows) {
  const known = rows.filter((row) => column.ego_movement[row] !== null);
  const keys = (row) => [column.ego_movement[row], column.foe_movement[row]].sort((a, b) => a - b).join();
  return [...grouped(known, (row) => [keys(row)])]
    .map(([key, of_pair]) => ({ movements: key.split(",").map((place) => conflicts.movements.list[place]), ...sums(of_pair) }))
    .sort((a, b) => b.risk - a.risk || b.rows.length - a.rows.length);
}

/** A movement in words. */
function movementWords([from, to, turn], approaches) {
  const at = (place, before) => {
    const [name, angle] = approaches[place];
    return angle === null ? `${before} ${name}` : `${before} the ${compass(angle)} (${name})`;
  };
  if (from !== null && approaches[from][2] === ON_FOOT) return `on foot in the ${compass(approaches[from][1])}`;
  if (from !== null) return at(from, "from") + (turn ? `, ${turn}` : "");
  return to === null ? "way not known" : at(to, "towards");
}

function pairWords({ movements }, approaches) {
  const [one, other] = movements.map((movement) => movementWords(movement, approaches));
  return one === other ? `both ${one}` : `${one} – ${other}`;
}

/** Where the approaches lie on the circle: in their directions, but never on one another. */
function spread(approaches) {
  const angles = approaches.map(([, angle], place) => (angle === null ? (Math.PI / 2) - (2 * Math.PI * place) / approaches.length : angle));
  const order = [...angles.keys()].filter((place) => approaches[place][2] !== ON_FOOT).sort((a, b) => angles[a] - angles[b]);
  for (let round = 0; round < 20; round++) {
    order.forEach((place, at) => {
      const next = order[(at + 1) % order.length];
      const turn = at + 1 === order.length ? 2 * Math.PI : 0;
      const lacking = APART - (angles[next] + turn - angles[place]);
      if (next === place || lacking <= 0) return;
      angles[place] -= lacking / 2;
      angles[next] += lacking / 2;
    });
  }
  return angles;
}

const onCircle = (angle, radius) => [DIAGRAM.width / 2 + radius * Math.cos(angle), DIAGRAM.height / 2 - radius * Math.sin(angle)];

/** A movement as points of a curve; none where its way is not known. */
function curveOf([from, to], approaches, angles) {
  const { ring } = DIAGRAM;
  const between = (a, b, c) => Array.from({ length: 25 }, (_, step) => {
    const t = step / 24;
    return [0, 1].map((axis) => (1 - t) ** 2 * a[axis] + 2 * t * (1 - t) * b[axis] + t ** 2 * c[axis]);
  });
  const straight = (a, b) => between(a, [0, 1].map((axis) => (a[axis] + b[axis]) / 2), b);
  if (from === null && to === null) return [];
  if (from !== null && approaches[from][2] === ON_FOOT) return straight(onCircle(angles[from] - 0.3, ring * 0.85), onCircle(angles[from] + 0.3, ring * 0.85));
  if (to === null) return straight(onCircle(angles[from], ring), onCircle(angles[from], ring * 0.15));
  if (from === null) return straight(onCircle(angles[to], ring * 0.15), onCircle(angles[to], ring));
  return between(onCircle(angles[from], ring), onCircle(0, 0), onCircle(angles[to], ring));
}

/** Where two curves meet first. */
function meetingOf([one, other]) {
  if (!one.length || !other.length) return (one.length ? one : other)[12] || onCircle(0, 0);
  if (String(one) === String(other)) return one[8];
  const apart = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1]);
  const all = one.flatMap((a, i) => other.map((b, j) => ({ at: [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2], apart: apart(a, b), when: i + j })));
  const least = Math.min(...all.map((meeting) => meeting.apart));
  return all.filter((meeting) => meeting.apart < least + 3).reduce((first, meeting) => (meeting.when < first.when ? meeting : first)).at;
}

/** The names around the circle: a compass direction for each road, or without a net each edge's name. */
function roadLabels(approaches, angles) {
  const order = [...angles.keys()].filter((place) => approaches[place][2] !== ON_FOOT).sort((a, b) => angles[a] - angles[b]);
  const roads = [];
  for (const place of order) {
    const last = roads[roads.length - 1];
    if (approaches[place][1] !== null && last && angles[place] - last[last.length - 1] < ONE_ROAD) last.push(angles[place]);
    else roads.push(Object.assign([angles[place]], { place }));
  }
  return roads.map((road) => {
    const middle = road.reduce((sum, angle) => sum + angle, 0) / road.length;
    const [name, angle] = approaches[road.place];
    const [x, y] = onCircle(middle, DIAGRAM.ring + 28);
    const aside = Math.cos(middle);
    const text = angle === null ? name : compass(middle);
    return drawing("text", { x, y: y + 4, "text-anchor": aside > 0.35 ? "start" : aside < -0.35 ? "end" : "middle" },
      text.length > 16 ? `${text.slice(0, 15)}…` : text);
  });
}

/** The diagram of a junction, with a table that says the same. */
function movementDiagram(spot) {
  const approaches = approachesOf(spot.place);
  const angles = spread(approaches);
  const all = movementPairs(spot.rows);
  const shown = all.slice(0, MOST_PAIRS);
  const weight = (pair) => (hasRisk ? pair.risk : pair.rows.length);
  const most = Math.max(...shown.map(weight), 1e-9);
  const line = (points) => points.map(([x, y], place) => `${place ? "L" : "M"}${x.toFixed(1)} ${y.toFixed(1)}`).join("");
  const parts = [];
  approaches.forEach(([, , role], place) => {
    if (role === ON_FOOT) return;
    const ends = [DIAGRAM.ring, DIAGRAM.ring + 22].map((radius) => onCircle(angles[place], radius));
    parts.push(drawing("path", { d: line(ends), class: "road" }));
  });
  const dots = [];
  shown.forEach((pair, rank) => {
    const width = 2 + (7 * weight(pair)) / most;
    const severity = pair.counts.findLastIndex((many) => many > 0);
    const colour = `var(--${SEVERITIES[severity]})`;
    const curves = pair.movements.map((movement) => curveOf(movement, approaches, angles));
    curves.forEach((points, which) => {
      if (!points.length) return;
      const isOnFoot = approaches[pair.movements[which][0]]?.[2] === ON_FOOT;
      parts.push(drawing("path", { d: line(points), style: `stroke: var(--card); stroke-width: ${width + 2}` }),
        drawing("path", { d: line(points), style: `stroke: ${colour}; stroke-width: ${width}`, ...(isOnFoot ? { "stroke-dasharray": "5 3" } : {}) }));
      if (isOnFoot) return;
      const [[x0, y0], [x1, y1]] = points.slice(-2);
      const [along_x, along_y] = [x1 - x0, y1 - y0].map((way) => way / Math.hypot(x1 - x0, y1 - y0));
      const size = 5 + width / 2;
      const tip = [[x1 + along_x * size, y1 + along_y * size], [x1 - along_y * size, y1 + along_x * size], [x1 + along_y * size, y1 - along_x * size]];
      parts.push(drawing("path", { d: `${line(tip)}Z`, style: `fill: ${colour}` }));
    });
    let [x, y] = meetingOf(curves);
    while (dots.some((dot) => Math.hypot(dot.x - x, dot.y - y) < 17)) x += 18;
    dots.push({ x, y, rank });
  });
  for (const { x, y, rank } of dots) {
    parts.push(drawing("circle", { cx: x, cy: y, r: 8, class: "dot" }), drawing("text", { x, y: y + 4, "text-anchor": "middle", class: "rank" }, String(rank + 1)));
  }
  const svg = drawing("svg", { viewBox: `0 0 ${DIAGRAM.width} ${DIAGRAM.height}`, role: "img", class: "movements" }, ...parts, ...roadLabels(approaches, angles));
  const said = shown.map((pair, rank) => `${rank + 1}: ${pairWords(pair, approaches)}, risk index ${number(pair.risk, 2)}.`);
  describeChart(svg, `Movements at ${spotName(spot)} that meet in conflicts. ${said.join(" ")}`);
  const head = make("tr", {}, ...["", "Which with which", "Risk index", "critical", "serious"].map((textContent, place) =>
    Object.assign(make(textContent ? "th" : "td", { textContent, className: place > 1 ? "number" : "" }), textContent ? { scope: "col" } : {})));
  const lines = shown.map((pair, rank) => make("tr", {}, numberCell(String(rank + 1)), textCell(pairWords(pair, approaches)),
    ...[number(pair.risk, 2), number(pair.counts[2]), number(pair.counts[1])].map(numberCell)));
  const unknown = spot.rows.length - all.reduce((sum, pair) => sum + pair.rows.length, 0);
  const notes = [all.length > shown.length && `${all.length - shown.length} more pairs, with ${number(all.slice(MOST_PAIRS).reduce((sum, pair) => sum + pair.risk, 0), 2)} together.`,
    unknown && `Of ${number(unknown)} conflicts the lanes are not known.`,
    "Width: risk index. Colour: the worst severity."];
  return make("div", { className: "diagram" }, svg, make("div", {}, make("table", {}, make("thead", {}, head), make("tbody", {}, ...lines)),
    make("p", { className: "note", textContent: notes.filter(Boolean).join(" ") })));
}
