// A conflict in plain English. Ids are only ever put into the page as text.

const kmh = (speed) => `${number(speed, 1)} m/s (${number(speed * 3.6)} km/h)`;

/** What the ego was about to do to the foe. */
const DEED = ["run into the rear of", "meet head-on", "run into the side of"];

function typed(id, type) {
  const word = conflicts.types[type];
  return word ? `${id} (${word})` : id;
}

function spotWords(row) {
  const spot = conflicts.spots[spotOf(row)];
  return spot ? `on ${spot} (lane ${laneId(row)})` : `at x ${number(column.x[row], 1)}, y ${number(column.y[row], 1)}`;
}

/** All that the log says of a conflict, in sentences. */
function describe(row) {
  const value = (name) => column[name][row];
  const ego = typed(egoId(row), column.ego_type[row]);
  const foe = typed(foeId(row), column.foe_type[row]);
  const foe_speed = value("foe_speed") > 0.05 ? `driving ${kmh(value("foe_speed"))}` : "standing";
  const angle = Math.round((value("angle") * 180) / Math.PI);
  const across = value("kind") === 2 ? `, at an angle of ${angle}°` : "";
  const said = [`At ${number(value("time"), 1)} s ${spotWords(row)}, ${ego} at ${kmh(value("ego_speed"))} was about to `
    + `${DEED[value("kind")]} ${foe}, ${foe_speed}${across}.`];
  said.push(`${number(value("gap"), 2)} m of room were left where μ = ${number(value("mu"), 2)} m were needed: a margin of `
    + `${number(value("margin"), 2)} m.`);
  if (value("collision")) {
    said.push("Their rectangles overlapped: a collision.");
  } else if (value("ttc") !== null) {
    const hard = value("drac") !== null ? `, and the ego had to brake with ${number(value("drac"), 1)} m/s² to avoid it` : "";
    said.push(`At its closest they would have touched after ${number(value("ttc"), 2)} s (TTC)${hard}.`);
  } else {
    said.push("At constant speeds they would not have touched.");
  }
  if (value("pet") !== null) said.push(`One entered the place ${number(value("pet"), 2)} s after the other had left it (PET).`);
  said.push(`A collision ${value("collision") ? "changes" : "would have changed"} the ego’s speed by ${number(value("delta_v"), 1)} m/s.`);
  const lasted = value("end") - value("begin");
  if (lasted > 0) said.push(`The conflict lasted ${number(lasted, 1)} s.`);
  return said.join(" ");
}

/** A conflict in a few lines, for a tooltip. */
function tipOf(row) {
  const value = (name) => column[name][row];
  const maybe = (name, decimals, unit) => (value(name) === null ? "–" : `${number(value(name), decimals)} ${unit}`);
  const lines = [
    `${egoId(row)} → ${foeId(row)}`,
    `${KINDS[value("kind")]}, ${SEVERITIES[value("severity")]}${value("collision") ? ", collision" : ""}`,
    `${number(value("time"), 1)} s, ${conflicts.spots[spotOf(row)] || "no lane"}`,
    `gap ${maybe("gap", 2, "m")}, μ ${maybe("mu", 2, "m")}, margin ${maybe("margin", 2, "m")}`,
    `TTC ${maybe("ttc", 2, "s")}, DRAC ${maybe("drac", 1, "m/s²")}, PET ${maybe("pet", 2, "s")}`,
    `speeds ${number(value("ego_speed"), 1)} and ${number(value("foe_speed"), 1)} m/s, ΔV ${maybe("delta_v", 1, "m/s")}`,
  ];
  const [heading, ...rest] = lines;
  return make("div", { className: "tip" }, make("b", { textContent: heading }),
    ...rest.map((textContent) => make("div", { textContent })));
}
