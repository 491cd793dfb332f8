// The conflict that is open below the map: its clip, what happened, and an address that opens it again.

const opened = {
  row: null,
  /** The address of a conflict that this page does not have. */
  missing: null,
  card: null,
  shownRow: null,
  changed: () => {},

  start(changed) {
    this.element = byId("opened");
    this.changed = changed;
    this.element.onkeydown = (event) => event.key === "Escape" && this.open(null);
  },

  /** What `#conflict=` says of a row: its number in the log, with its run where there are several. */
  addressOf: (row) => (data.runs.length > 1 ? `${column.run[row] + 1}:${column.id[row]}` : String(column.id[row])),

  /** The row that an address names; null where this page has none. A number without its run is that of the first run. */
  rowOf(address) {
    if (!address) return null;
    const [id, run] = address.split(":").reverse().map(Number);
    const row = everyRow.find((row) => column.id[row] === id && (run === undefined || column.run[row] + 1 === run));
    return row === undefined ? null : row;
  },

  /** Opens a conflict, or closes the open one. */
  open(row) {
    this.row = row;
    this.missing = null;
    this.changed();
    this.go();
  },

  /** Brings the open conflict into view. */
  go() {
    if (this.row === null) return;
    this.element.scrollIntoView({ block: "nearest" });
    this.element.focus({ preventScroll: true });
  },

  show() {
    this.element.hidden = this.row === null && this.missing === null;
    if (this.row === this.shownRow && !this.missing) return;
    this.shownRow = this.row;
    this.card?.dispose();
    this.card = null;
    if (this.row === null) {
      this.element.replaceChildren(this.missing === null ? "" : `The conflict ${this.missing} is not on this page.`);
      return;
    }
    const { row } = this;
    this.card = new Card(row, false);
    const button = (textContent, onclick) => make("button", { type: "button", textContent, onclick });
    this.card.text.append(button("Only this place", () => choosePlace(spotOf(row), null)), button("Close", () => this.open(null)));
    this.element.replaceChildren(make("div", { className: "picture" }, ...this.card.parts.slice(0, -1)), this.card.text);
    this.card.start();
  },

  /** A ring around it on the map. */
  marks(view) {
    if (this.row === null) return [];
    const cx = view.x + (column.x[this.row] - view.left) * view.scale;
    const cy = view.y + view.height - (column.y[this.row] - view.bottom) * view.scale;
    return [{ type: "circle", z2: 22, shape: { cx, cy, r: 11 }, style: { fill: null, stroke: colours.card, lineWidth: 5 } },
      { type: "circle", z2: 23, shape: { cx, cy, r: 11 }, style: { fill: null, stroke: colours.ink, lineWidth: 2.5 } }];
  },
};
