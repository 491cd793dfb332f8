// A conflict described in sentences. Ids enter the page only as text, never as markup.

const kmh = (speed) => `${number(speed, 1)} m/s (${number(speed * 3.6)} km/h)`;

/** The parts of a road user; the first is its front. */
const PARTS = ["front", "rear", "left side", "right side"];
/** A road user is said to move from this speed on, in m/s. */
const MOVES = 0.05;
/** Two road users touch up to this gap, in m: the page's numbers are rounded to 0.01 m. */
const TOUCHING = 0.005;
/** Whether the two have collided by the worst step: that of the smallest margin, which may be before the contact. */
function collidedByWorst(row) {
  if (!column.collision[row]) return false;
  const contact = contactOf(row);
  return column.gap[row] <= TOUCHING || (contact !== null && contact <= column.time[row]);
}

/** What the two did, or were about to do, by the parts that touch first and by who moves. */
function deed(row, ego, foe) {
  const value = (name) => column[name][row];
  const moving = (who, speed) => `${who} at ${kmh(speed)}`;
  const other = (who, speed) => `${who}, ${speed > MOVES ? `moving at ${kmh(speed)}` : "standing at that moment"}`;
  const names = [ego, foe];
  const parts = ["ego_part", "foe_part"].map(value);
  const speeds = ["ego_speed", "foe_speed"].map(value);
  const moves = speeds.map((speed) => speed > MOVES);
  if (parts[0] === null) {
    const near = value("kind") === 0 && manoeuvreOf(row) !== "side_by_side" ? "the rear of " : "";
    return `${moving(ego, speeds[0])} came too close to ${near}${other(foe, speeds[1])}`;
  }
  const did = (past, would) => (collidedByWorst(row) ? past : `was about to ${would}`);
  // Whose front hits the other; otherwise a moving one.
  const fronts = [0, 1].filter((who) => parts[who] === 0 && moves[who]);
  const by = fronts.length ? fronts[0] : moves[0] ? 0 : 1;
  const [mover, hit] = [moving(names[by], speeds[by]), other(names[1 - by], speeds[1 - by])];
  if (fronts.length === 2 && value("kind") === 1) return `${mover} ${did("met", "meet")} ${hit}, head-on`;
  const part = `the ${PARTS[parts[1 - by]]} of ${hit}`;
  return fronts.length ? `${mover} ${did("ran", "run")} into ${part}`
    : `${mover} ${did("touched", "touch")} with its ${PARTS[parts[by]]} ${part}`;
}

/** Tells a reader who does not see a chart what is in it. */
function describeChart(element, text) {
  element.setAttribute("aria-label", text);
}

function typed(id, type) {
  const word = conflicts.types[type];
  return word ? `${id} (${word})` : id;
}

/** The manoeuvre and the causes of a conflict, as far as they are known. */
function whyWords(row) {
  const manoeuvre = conflicts.manoeuvres[column.manoeuvre[row]];
  const causes = conflicts.causes[column.cause[row]].split(" ").join(", ");
  const parts = [manoeuvre && `Manoeuvre: ${manoeuvre}`, causes && `Cause: ${causes}`];
  return parts.filter(Boolean).map((part) => `${inWords(part)}.`).join(" ");
}

function placeWords(row) {
  const spot = conflicts.spots[spotOf(row)];
  if (!spot) return `at x ${number(column.x[row], 1)}, y ${number(column.y[row], 1)}`;
  const street = conflicts.streets[spotOf(row)];
  return street ? `${spot.startsWith("junction ") ? "at" : "on"} ${street} (${spot}, lane ${laneId(row)})` : `on ${spot} (lane ${laneId(row)})`;
}

/** What the two did, by its name in the log; other names are shown as they are. */
const MANOEUVRES = {
  following: "One followed the other.", cut_in: "The foe moved into the ego’s lane.", lane_change: "The ego moved into the foe’s lane.",
  side_by_side: "They drove side by side.", merge: "Their lanes became one.", crossing: "Their paths crossed.",
  left_turn_across: "One turned left across the other’s path.", right_turn_across: "One turned right across the other’s path.",
  turn_into: "One turned into the road that the other took.", overtaking_oncoming: "One drove against its lane, towards the other.",
  head_on: "They drove towards each other, each on its own path.", person_crossing: "A person was crossing the vehicle’s path.",
  person_along: "A person walked along the vehicle’s path.", person_standing: "A person stood in the vehicle’s way.", object: "An obstacle was in the way.",
};
/** The same where one of the two stands: it does not drive. */
const STANDING = {
  following: "One was behind the other.", side_by_side: "They were side by side.", head_on: "They faced each other, each on its own way.",
  overtaking_oncoming: "One was on the lane of the other, against its direction.",
  left_turn_across: "The way of one turned left across that of the other.", right_turn_across: "The way of one turned right across that of the other.",
  turn_into: "The way of one turned into the road of the other.", person_along: "A person was in the vehicle’s way, along it.",
};
/** What the two of a conflict did, in a sentence. */
function manoeuvreWords(row) {
  const manoeuvre = manoeuvreOf(row);
  const bothMove = ["ego_speed", "foe_speed"].every((name) => column[name][row] > MOVES);
  return (!bothMove && STANDING[manoeuvre]) || MANOEUVRES[manoeuvre] || `Manoeuvre: ${inWords(manoeuvre)}.`;
}

/** What happens often at a place, in the same way. */
const OFTEN = {
  following: "one behind the other", cut_in: "vehicles that cut in", lane_change: "vehicles that change lanes", side_by_side: "vehicles side by side",
  merge: "lanes that become one", crossing: "crossing paths", left_turn_across: "left turns across the path of others",
  right_turn_across: "right turns across the path of others", turn_into: "turns into the road of others", overtaking_oncoming: "overtaking against oncoming traffic",
  head_on: "oncoming traffic", person_crossing: "persons who cross in front of vehicles", person_along: "persons along the path of vehicles",
  person_standing: "persons in the way of vehicles", object: "obstacles in the way",
};
/** Why it came about, in the same way. */
const WHY = {
  ran_red: "one of them ran a red light", late_amber: "one of them passed its stop line late on amber",
  did_not_yield: "one of them had to yield and did not", changed_lane: "one of them changed lanes", overtook: "one of them overtook against the oncoming traffic",
  outside_crossing: "the person walked where no crossing is", stood: "one of them stood there",
  behind_curve: "a queue ended where the line of sight to it left the road", leader_braked: "the one in front braked hard",
  too_close: "the ego followed too closely", too_fast: "one of them drove faster than the limit", appeared: "one of them had only just entered the simulation",
};

/** A cause of a conflict; who had to yield is known where the net is. */
function whyOf(row, cause) {
  const who = cause === "did_not_yield" && column.yields ? column.yields[row] : null;
  return who === null ? WHY[cause] || inWords(cause) : `the ${["ego", "foe"][who]}, ${[egoId, foeId][who](row)}, had to yield and did not`;
}

const nearnessOf = (row) => conflicts.nearnesses[column.nearness[row]];
const consequenceOf = (row) => conflicts.consequences[column.consequence[row]];
/** Why a conflict is not traffic, by the log's name of it. */
const ARTEFACTS = {
  drawn_overlap: "the two overlap, or would, only as their lanes are drawn", appeared: "one of them had just been put there",
  stopped_at_once: "one of them had stopped faster than any brakes can", jumped: "one of them had jumped sideways, or turned, within one step",
  tracking: "the tracker erred",
};

/** How near to a crash it was, what that would have meant, and whether it is traffic; empty for a log of an earlier version. */
function labelWords(row) {
  const artefact = artefactOf(row);
  const [nearness, consequence] = [nearnessOf(row), consequenceOf(row)].map(inWords);
  const labels = column.collision[row] ? `The crash was ${consequence}.` : `A crash was ${nearness}, and would have been ${consequence}.`;
  const parts = [consequence && labels, artefact && `Not traffic: ${ARTEFACTS[artefact] || inWords(artefact)}.`];
  return parts.filter(Boolean).join(" ");
}

/** The log's row of a conflict as sentences: what happened, why, and how much time was left. */
function storyOf(row) {
  const value = (name) => column[name][row];
  const ego = typed(egoId(row), column.ego_type[row]);
  const foe = typed(foeId(row), column.foe_type[row]);
  const sentences = [`At ${number(value("time"), 1)} s ${placeWords(row)}, ${deed(row, ego, foe)}.`];
  // The kind is that of the angle, whichever parts touch.
  if (value("kind") > 0) sentences.push(`Their paths met at ${Math.round((value("angle") * 180) / Math.PI)}°: a ${KINDS[value("kind")]} conflict.`);
  if (manoeuvreOf(row)) sentences.push(manoeuvreWords(row));
  const causes = causeNames(row);
  if (causes.length) {
    const order = conflicts.causes[column.cause[row]].split(" ");
    sentences.push(`Why: ${order.map((cause) => whyOf(row, cause)).join("; ")}.`);
  }
  const left = column.response_left && value("response_left");
  if (value("collision")) {
    const at = collidedByWorst(row) ? null : contactOf(row);
    sentences.push(collidedByWorst(row) ? "Their rectangles overlapped: a collision."
      : at === null ? "At another moment of this conflict their rectangles overlapped: a collision."
        : `At ${number(at, 1)} s their rectangles overlapped: a collision.`);
  } else if (typeof left === "number") {
    sentences.push(`The ego had ${number(left, 1)} s left to respond, and a driver needs ${number(responseOf(row), 2)} s.`);
  }
  return [...sentences, labelWords(row)].filter(Boolean).join(" ");
}

/** The measures of a conflict as sentences. */
function figuresOf(row) {
  const value = (name) => column[name][row];
  const sentences = [`At the worst step the gap, the room left on their paths, was ${number(value("gap"), 2)} m, and μ = ${number(value("mu"), 2)} m was needed: a margin of `
    + `${number(value("margin"), 2)} m.`];
  if (!value("collision") && value("ttc") === null) sentences.push("At constant speed they would not have touched.");
  else if (!value("collision")) {
    let braking = "";
    if (value("unavoidable")) braking = ", and no braking would have avoided it";
    else if (value("drac") !== null) braking = `, and braking at ${number(value("drac"), 1)} m/s² would just have avoided it (DRAC)`;
    sentences.push(`At the worst moment they would have touched after ${number(value("ttc"), 2)} s (TTC)${braking}.`);
  }
  if (!value("collision") && value("ttb") !== null) {
    const wait = value("ttb") > 0 ? `Full braking had to begin within ${number(value("ttb"), 2)} s` : "Even full braking at once was too late";
    sentences.push(`${wait}; a driver brakes too late with a probability of ${number(100 * value("crash_probability"), 1)} %.`);
  }
  if (value("pet") !== null) sentences.push(`The second entered the conflict area ${number(value("pet"), 2)} s after the first had left it (PET).`);
  const of_foe = value("foe_delta_v") === null ? "" : ` and the foe’s by ${number(value("foe_delta_v"), 1)} m/s`;
  sentences.push(`A collision ${value("collision") ? "changes" : "would have changed"} the ego’s speed by ${number(value("ego_delta_v"), 1)} m/s${of_foe} (ΔV).`);
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
    labelWords(row),
    whyWords(row),
    `${number(value("time"), 1)} s, ${nameOfSpot(spotOf(row))}`,
    `gap ${maybe("gap", 2, "m")}, μ ${maybe("mu", 2, "m")}, margin ${maybe("margin", 2, "m")}`,
    `time to brake ${maybe("ttb", 2, "s")}, crash probability ${maybe("crash_probability", 2, "")}`,
    `TTC ${maybe("ttc", 2, "s")}, DRAC ${maybe("drac", 1, "m/s²")}, PET ${maybe("pet", 2, "s")}`,
    `speeds ${number(value("ego_speed"), 1)} and ${number(value("foe_speed"), 1)} m/s, ΔV ${maybe("delta_v", 1, "m/s")}`,
  ];
  const [heading, ...rest] = lines;
  return make("div", { className: "tip" }, make("b", { textContent: heading }),
    ...rest.map((textContent) => make("div", { textContent })));
}
