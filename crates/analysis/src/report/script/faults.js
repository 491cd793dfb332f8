// The faults of the net: a table, and a layer of the map. They are those of the whole logs, whatever the filter is.

/** This many faults are in the table. */
const MOST_FAULTS = 20;
/** The side of a fault's mark on the map, in pixels. */
const FAULT_SIDE = 9;
const FAULT_WORDS = { on_foot: "persons are driven over", waits_inside: "waits inside the junction", not_foes: "no foes, but drawn over each other",
  narrow_lane: "lanes are too narrow", no_junction: "cross without a junction", too_near: "edges too near" };

const faults = {
  worst: data.net_faults.worst,
  isOnMap: false,

  /** Shows the section, if there are faults; `isDrawn` says whether there is a map. */
  start(changed, isDrawn) {
    if (!this.worst.length) return;
    byId("faults").hidden = false;
    const { count } = data.net_faults;
    const listed = count > MOST_FAULTS ? ` The worst ${MOST_FAULTS} of ${number(count)} pairs of lanes:` : "";
    byId("faulty").textContent = `Pairs of lanes at which SUMO drives road users through each other, because its drivers do not know how lanes are drawn. These conflicts count nowhere else on this page. One that stands counts once, however many pass it.${listed}`;
    const head = ["Lanes", "Times", "Conflicts", "Road users", "Deepest, m", "What", "How to mend it"];
    const heading = (text, place) => make("th", { textContent: text, scope: "col", className: place > 0 && place < 5 ? "number" : "" });
    const lines = this.worst.slice(0, MOST_FAULTS).map((fault) => make("tr", {}, this.name(fault, isDrawn),
      ...[fault.times, fault.conflicts, fault.road_users].map((value) => numberCell(number(value))), numberCell(number(fault.overlap, 2)),
      textCell(FAULT_WORDS[fault.fault] || inWords(fault.fault)), textCell(fault.remedy)));
    byId("faultlist").replaceChildren(make("thead", {}, make("tr", {}, ...head.map(heading))), make("tbody", {}, ...lines));
    if (!isDrawn) return;
    const box = make("input", { type: "checkbox", id: "faultlayer" });
    box.onchange = () => {
      this.isOnMap = box.checked;
      changed();
    };
    byId("modes").after(make("label", { className: "screen" }, box, ` faults of the net (${number(count)})`));
  },

  /** The two lanes; a click shows where they are. */
  name(fault, isDrawn) {
    const lanes = `${fault.lane} and ${fault.other_lane}`;
    if (!isDrawn) return textCell(lanes);
    const button = make("button", { type: "button", textContent: lanes });
    button.onclick = () => {
      if (!byId("faultlayer").checked) byId("faultlayer").click();
      map.go(fault.x, fault.y, 60);
    };
    return make("td", {}, button);
  },

  /** The marks on the map: a square for each pair of lanes. */
  marks(view) {
    if (!this.isOnMap) return [];
    return this.worst.map((fault) => {
      const x = view.x + (fault.x - view.left) * view.scale - FAULT_SIDE / 2;
      const y = view.y + view.height - (fault.y - view.bottom) * view.scale - FAULT_SIDE / 2;
      return { type: "rect", z2: 18, shape: { x, y, width: FAULT_SIDE, height: FAULT_SIDE }, style: { fill: colours.card, stroke: colours.ink, lineWidth: 2 } };
    });
  },
};
