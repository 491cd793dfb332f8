// A conflict described in sentences. Ids enter the page only as text, never as markup.

const kmh = (speed) => `${number(speed, 1)} m/s (${number(speed * 3.6)} km/h)`;

/** The ego's collision with the foe, by kind. */
const DEED = ["run into the rear of", "meet head-on", "run into the side of"];

function typed(id, type) {
  const word = conflicts.types[type];
  return word ? `${id} (${word})` : id;
}

function spotWords(row) {
  const spot = conflicts.spots[spotOf(row)];
  return spot ? `on ${spot} (lane ${laneId(row)})` : `at x ${number(column.x[row], 1)}, y ${number(column.y[row], 1)}`;
}

/** The log's row of a conflict as sentences. */
function describe(row) {
  const value = (name) => column[name][row];
  const ego = typed(egoId(row), column.ego_type[row]);
  const foe = typed(foeId(row), column.foe_type[row]);
  const foe_speed = value("foe_speed") > 0.05 ? `driving ${kmh(value("foe_speed"))}` : "standing";
  const angle = Math.round((value("angle") * 180) / Math.PI);
  const across = value("kind") === 2 ? `, at an angle of ${angle}°` : "";
  const sentences = [`At ${number(value("time"), 1)} s ${spotWords(row)}, ${ego} at ${kmh(value("ego_speed"))} was about to `
    + `${DEED[value("kind")]} ${foe}, ${foe_speed}${across}.`];
  sentences.push(`The gap was ${number(value("gap"), 2)} m, and μ = ${number(value("mu"), 2)} m were needed: a margin of `
    + `${number(value("margin"), 2)} m.`);
  if (value("collision")) {
    sentences.push("Their rectangles overlapped: a collision.");
  } else if (value("ttc") !== null) {
    const hard = value("drac") !== null ? `, and the ego had to brake at ${number(value("drac"), 1)} m/s² to avoid it (DRAC)` : "";
    sentences.push(`At the worst moment they would have touched after ${number(value("ttc"), 2)} s (TTC)${hard}.`);
  } else {
    sentences.push("At constant speed they would not have touched.");
  }
  if (value("pet") !== null) sentences.push(`The second entered the conflict area ${number(value("pet"), 2)} s after the first had left it (PET).`);
  sentences.push(`A collision ${value("collision") ? "changes" : "would have changed"} the ego’s speed by ${number(value("delta_v"), 1)} m/s.`);
  const lasted = value("end") - value("begin");
  if (lasted > 0) sentences.push(`The conflict lasted ${number(lasted, 1)} s.`);
  return sentences.join(" ");
}

/** The tooltip of a conflict. */
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
