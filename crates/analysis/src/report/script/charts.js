// Conflicts over time, and the distributions of their measures.

/** The possible widths of the time line's bars, in s, and the greatest number of bars. */
const BINS = [1, 2, 5, 10, 20, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200, 14400, 86400];
const MOST_BINS = 80;
/** From this duration on, in s, the bars of the time line are at least a minute wide. */
const LONG = 1200;

/** The possible steps between the labels on the axis of a long run, in s, and the greatest number of labels. */
const TICKS = [60, 300, 600, 900, 1800, 3600, 7200, 14400, 21600, 43200, 86400];
const MOST_TICKS = 8;

/** The first and the last second of all runs. */
const period = (() => {
  const times = [];
  for (const run of data.runs) if (run.summary) times.push(run.summary.begin, run.summary.end);
  for (const time of column.time) times.push(time);
  return [times.reduce((a, b) => Math.min(a, b), Infinity), times.reduce((a, b) => Math.max(a, b), -Infinity)];
})();

/** The count of each severity in each of `bins` bars. */
function histogram(rows, place, bins) {
  const counts = SEVERITIES.map(() => new Array(bins).fill(0));
  for (const row of rows) {
    const at = place(row);
    if (at >= 0) counts[column.severity[row]][Math.min(at, bins - 1)]++;
  }
  return counts;
}

/** A time as hours and minutes. */
function clock(seconds) {
  const [hours, minutes, rest] = [Math.floor(seconds / 3600), Math.floor(seconds / 60) % 60, Math.round(seconds % 60)];
  return [hours, minutes, ...(rest ? [rest] : [])].map((part) => String(part).padStart(2, "0")).join(":");
}

/** The look of a bar of values beyond its axis. */
const BEYOND = { opacity: 0.5, borderColor: "#888", borderType: "dashed", borderWidth: 1 };

/** Stacked bars, one series per severity; `height` turns the count of a bar into its height. From `beyond` on they are pale. */
function bars(counts, centres, more, height = (many) => many, beyond = Infinity) {
  const totals = centres.map((_, bin) => counts.reduce((all, of_bin) => all + of_bin[bin], 0));
  return counts.map((of_bin, severity) => ({
    id: SEVERITIES[severity], name: SEVERITIES[severity], type: "bar", stack: "all", barCategoryGap: "8%", silent: false,
    itemStyle: { color: severityColour(severity) }, clip: true,
    data: of_bin.map((many, bin) => ({ value: [centres[bin], many ? (height(totals[bin]) * many) / totals[bin] : 0],
      ...(bin >= beyond && { itemStyle: BEYOND }) })),
    ...(more && more[severity]),
  }));
}

/** From this ratio of the highest bar to the median one on, a few bars hide the others: heights are logarithmic. */
const SPREAD = 40;
/** The height of a bar of one, in decades. */
const FIRST_DECADE = 0.3;

/** How high bars with these counts are, and what stands beside the axis. */
function heights(counts) {
  const totals = counts[0].map((_, bin) => counts.reduce((all, of_bin) => all + of_bin[bin], 0)).filter((total) => total > 0).sort((a, b) => a - b);
  const highest = totals[totals.length - 1] || 0;
  if (highest < SPREAD * (totals[Math.floor(totals.length / 2)] || 1)) return { height: (many) => many, isLogarithmic: false, axis: {} };
  return {
    height: (many) => (many ? Math.log10(many) + FIRST_DECADE : 0),
    isLogarithmic: true,
    axis: { min: 0, max: Math.ceil(Math.log10(highest)) + FIRST_DECADE, interval: 1, minInterval: undefined, splitNumber: undefined,
      axisLabel: { color: colours.faint, formatter: (value) => (value === 0 ? "0" : "") } },
  };
}

/** The lines and labels of a logarithmic axis: 1, 10, 100, … */
function decades({ isLogarithmic, axis: { max } }) {
  if (!isLogarithmic) return [];
  return Array.from({ length: Math.floor(max) + 1 }, (_, decade) => ({ yAxis: decade + FIRST_DECADE,
    label: { show: true, position: "start", formatter: number(10 ** decade), color: colours.faint, fontSize: 12 },
    lineStyle: { color: colours.rule, type: "solid", width: 1 } }));
}

/** The axis of the bars' heights. */
const counted = (more) => axis({ type: "value", minInterval: 1, axisLine: { show: false }, axisTick: { show: false }, name: "conflicts", nameGap: 9,
  nameTextStyle: { color: colours.faint, align: "left", padding: [0, 0, 0, -12] }, ...more });

/** The tooltip of a bar: a heading, then a count per severity. */
function barTip(heading, counts, bin) {
  const tip = make("div", { className: "tip" }, make("b", { textContent: heading }));
  SEVERITIES.forEach((name, severity) => tip.append(make("div", { textContent: `${name} ${number(counts[severity][bin])}` })));
  return tip;
}

/** Room beside the chart of times, in pixels. */
const SIDES = 44;
const isPrinted = () => "print" in document.documentElement.dataset;

const times = {
  element: byId("times"),
  chart: null,

  start(changed) {
    const length = Math.max(period[1] - period[0], 1);
    const most = BINS.find((bin) => length / bin <= MOST_BINS) || BINS[BINS.length - 1];
    this.bin = length >= LONG ? Math.max(60, most) : most;
    this.first = Math.floor(period[0] / this.bin) * this.bin;
    this.bins = Math.max(1, Math.floor((period[1] - this.first) / this.bin) + 1);
    this.end = this.first + this.bins * this.bin;
    const width = this.bin % 60 ? `${this.bin} s` : this.bin === 60 ? "minute" : `${this.bin / 60} minutes`;
    const runs = data.runs.length > 1 ? `, all ${data.runs.length} runs together` : "";
    this.width = width;
    byId("bins").textContent = `Conflicts per ${width} by severity${runs}.`;
    this.chart = chartIn(this.element);
    this.chart.on("datazoom", () => {
      const { startValue, endValue } = this.chart.getOption().dataZoom[0];
      changed(startValue <= this.first ? -Infinity : startValue, endValue >= this.end ? Infinity : endValue);
    });
  },

  show(rows) {
    const counts = histogram(rows, (row) => Math.floor((column.time[row] - this.first) / this.bin), this.bins);
    const centres = Array.from({ length: this.bins }, (_, bin) => this.first + (bin + 0.5) * this.bin);
    const length = this.end - this.first;
    const is_long = length >= 2 * LONG;
    const label = (seconds) => (is_long ? clock(seconds) : `${number(seconds)} s`);
    const interval = is_long ? { interval: TICKS.find((tick) => length / tick <= MOST_TICKS) || 86400 } : {};
    this.chart.setOption({
      ...basics(),
      tooltip: { ...basics().tooltip, trigger: "axis", axisPointer: { type: "none" },
        formatter: ([item]) => (item ? this.tip(item, counts, label) : "") },
      // As wide as the slider; paper has none.
      grid: { left: SIDES, right: SIDES, top: 26, bottom: isPrinted() ? 24 : 62 },
      xAxis: axis({ type: "value", min: this.first, max: this.end, containShape: false, ...interval, splitLine: { show: false },
        axisLabel: { color: colours.faint, hideOverlap: true, formatter: label } }),
      yAxis: counted(),
      dataZoom: [{ id: "period", type: "slider", show: !isPrinted(), xAxisIndex: 0, filterMode: "none", height: 22, bottom: 8, left: SIDES, right: SIDES,
        showDetail: false, brushSelect: false, borderColor: colours.rule, fillerColor: `${colours.accent}33`,
        handleStyle: { color: colours.card, borderColor: colours.accent }, moveHandleStyle: { color: colours.accent },
        dataBackground: { lineStyle: { color: colours.faint }, areaStyle: { color: colours.rule } },
        selectedDataBackground: { lineStyle: { color: colours.accent }, areaStyle: { color: colours.accent } } }],
      series: bars(counts, centres),
    });
    const totals = centres.map((_, bin) => counts.reduce((all, of_bin) => all + of_bin[bin], 0));
    const most = totals.reduce((best, total, bin) => (total > totals[best] ? bin : best), 0);
    describeChart(this.element, `Conflicts over time: ${number(totals.reduce((a, b) => a + b, 0))} in all; the most per ${this.width}, ${number(totals[most])}, from ${label(this.first + most * this.bin)} on.`);
  },

  tip(item, counts, label) {
    const bin = item.dataIndex;
    return barTip(`${label(this.first + bin * this.bin)} to ${label(this.first + (bin + 1) * this.bin)}`, counts, bin);
  },

  /** Moves the slider to the filter's period. */
  follow() {
    const { from, to } = filter;
    this.chart.dispatchAction({ type: "dataZoom", dataZoomId: "period",
      startValue: Math.max(from, this.first), endValue: Math.min(to, this.end) });
  },
};

/** The threshold of a measure by which conflicts are serious; none where crash probabilities decide. */
function threshold(by_rule, text) {
  const at = { fhwa: by_rule[0], ssm: by_rule[1] }[options.severity_rule || options.severity];
  return at === undefined ? undefined : { at, text: text(at) };
}

/** The measures: column, heading, unit, the end of the axis that is usually 0, and a threshold with its label. */
const MEASURES = [
  { name: "ttc", title: "Time to collision (TTC)", unit: "s", low: 0,
    threshold: threshold([options.serious_ttc, 3], (at) => `serious below ${at} s`) },
  { name: "drac", title: "Deceleration to avoid it (DRAC)", unit: "m/s²", low: 0,
    threshold: threshold([options.serious_drac, 3], (at) => `serious above ${at} m/s²`) },
  { name: "pet", title: "Post-encroachment time (PET)", unit: "s", low: 0 },
  { name: "margin", title: "Margin: gap − μ", unit: "m", high: 0 },
  { name: "delta_v", title: "Largest speed change (ΔV)", unit: "m/s", low: 0 },
];
const DISTRIBUTION_BINS = 30;
/** Fewer values than this get bars that are this many times as wide. */
const FEW_VALUES = 30;
const WIDER = 3;
/** The share of the values that the axis covers; values beyond it count in a labelled bar of their own. */
const COVERED = 0.99;

/** A quantile of values in ascending order, defined as in `closecall stats`. */
function quantile(sorted, share) {
  const place = share * (sorted.length - 1);
  const [low, high] = [sorted[Math.floor(place)], sorted[Math.ceil(place)]];
  return low + (high - low) * (place % 1);
}

/** The least round number that is not below this. */
function roundUp(value) {
  const power = 10 ** Math.floor(Math.log10(Math.max(value, 1e-3)));
  return [1, 1.5, 2, 3, 4, 5, 6, 8, 10].find((digit) => digit * power >= value * 0.999) * power;
}

/** The known values of a column in these rows, in ascending order. */
function ascending(values, rows, size = (value) => value) {
  const known = new Float64Array(rows.length);
  let many = 0;
  for (const row of rows) if (values[row] !== null) known[many++] = size(values[row]);
  return known.subarray(0, many).sort();
}

/** Both ends of a measure's axis and the width of a bar, the same under every filter; a threshold lies between two bars. */
function range(measure) {
  const sizes = ascending(column[measure.name], everyRow, Math.abs);
  const reach = sizes.length ? quantile(sizes, COVERED) : 1;
  const furthest = roundUp(Math.max(reach, measure.threshold ? measure.threshold.at * 1.3 : 0));
  const wanted = furthest / DISTRIBUTION_BINS;
  const width = measure.threshold ? measure.threshold.at / Math.max(1, Math.round(measure.threshold.at / wanted)) : wanted;
  const length = Math.ceil(furthest / width - 1e-9) * width;
  if (measure.high !== 0) return [0, length, width];
  // Only a log of a wider condition has margins above 0.
  return [-length, column[measure.name].some((value) => value > 0) ? length : 0, width];
}

const distributions = {
  panels: [],

  start() {
    const panel = (title) => {
      const note = make("p", { className: "note" });
      const element = make("div", { className: "chart" });
      element.setAttribute("role", "img");
      element.setAttribute("aria-label", title);
      byId("distributions").append(make("div", {}, make("h3", { textContent: title }), note, element));
      return { note, element, title, chart: chartIn(element) };
    };
    for (const measure of MEASURES) this.panels.push({ ...panel(`${measure.title}, ${measure.unit}`), measure, range: range(measure) });
    this.kinds = panel("Kinds");
  },

  show(rows) {
    for (const each of this.panels) this.showMeasure(each, rows);
    this.showKinds(rows);
  },

  showMeasure({ note, element, title, chart, measure, range: [low, high, narrow] }, rows) {
    const values = column[measure.name];
    const known = rows.filter((row) => values[row] !== null);
    const sorted = ascending(values, known);
    note.textContent = sorted.length
      ? `${number(sorted.length)} of ${number(rows.length)} have one, median ${number(quantile(sorted, 0.5), 2)} ${measure.unit}`
      : "no conflict has one";
    const width = sorted.length < FEW_VALUES && !measure.threshold ? narrow * WIDER : narrow;
    const bins = Math.round((high - low) / width);
    // The bars within the axis, then those of the values below and above it, which stand apart.
    const place = (row) => {
      const bin = values[row] === high ? bins - 1 : Math.floor((values[row] - low) / width);
      return bin < 0 ? bins : bin >= bins ? bins + 1 : bin;
    };
    const counts = histogram(known, place, bins + 2);
    const beyond = [bins, bins + 1].map((bin) => counts.reduce((all, of_bin) => all + of_bin[bin], 0));
    const centres = Array.from({ length: bins }, (_, bin) => low + (bin + 0.5) * width).concat(low - 1.5 * width, high + 1.5 * width);
    const edge = (value) => `${number(value, value % 1 ? 2 : 0)} ${measure.unit}`;
    const says = (bin) => {
      if (bin >= bins) return bin === bins ? `below ${edge(low)}` : `above ${edge(high)}`;
      const [from, to] = [low + bin * width, low + (bin + 1) * width].map((value) => number(value, 2));
      return `${from} to ${to} ${measure.unit}`;
    };
    const scale = heights(counts);
    if (scale.isLogarithmic) note.textContent += "; heights are logarithmic, colours divide each bar in proportion";
    const threshold_line = measure.threshold ? [{ xAxis: measure.threshold.at, lineStyle: { color: colours.ink, type: "dashed", width: 1.5 },
      label: { formatter: measure.threshold.text, color: colours.ink, position: "end", fontSize: 11,
        align: measure.threshold.at < (low + high) / 2 ? "left" : "right" } }] : [];
    const lines = { silent: true, symbol: "none", animation: false };
    const more = [{
      markLine: { ...lines, data: threshold_line },
      markPoint: { silent: true, symbol: "circle", symbolSize: 0.1, animation: false, data: [0, 1].filter((side) => beyond[side] > 0).map((side) => ({
        coord: [centres[bins + side], scale.height(beyond[side])], label: { show: true, position: "top", distance: 3, color: colours.ink, fontSize: 11,
          formatter: side ? `>${number(high, high % 1 ? 1 : 0)}: ${number(beyond[1])}` : `<${number(low, low % 1 ? 1 : 0)}: ${number(beyond[0])}`,
          align: side ? "right" : "left", offset: [side ? 12 : -12, 0] } })) },
    }, { markLine: { ...lines, z: 0, data: decades(scale) } }];
    chart.setOption({
      ...basics(),
      tooltip: { ...basics().tooltip, trigger: "axis", axisPointer: { type: "none" },
        formatter: ([item]) => (item ? barTip(says(item.dataIndex), counts, item.dataIndex) : "") },
      grid: { left: 4 + (scale.isLogarithmic ? 28 : 0), right: 14, top: 28, bottom: 4, containLabel: true },
      xAxis: axis({ type: "value", min: low - (beyond[0] ? 3 * width : 0), max: high + (beyond[1] ? 3 * width : 0), splitLine: { show: false },
        axisLabel: { color: colours.faint, hideOverlap: true, showMaxLabel: beyond[1] ? false : high === roundUp(high), showMinLabel: !beyond[0],
          formatter: (value) => (value < low || value > high ? "" : number(value, value % 1 ? 1 : 0)) } }),
      yAxis: counted({ splitNumber: 4, ...scale.axis, splitLine: { show: !scale.isLogarithmic, lineStyle: { color: colours.rule } } }),
      series: bars(counts, centres, more, scale.height, bins),
    }, { replaceMerge: ["series"] });
    const outside = beyond[1] ? ` ${number(beyond[1])} are above ${edge(high)}.` : beyond[0] ? ` ${number(beyond[0])} are below ${edge(low)}.` : "";
    const beyond_threshold = measure.threshold ? ` The threshold: ${measure.threshold.text}.` : "";
    describeChart(element, `${title}: ${note.textContent}.${outside}${beyond_threshold}`);
  },

  showKinds(rows) {
    const counts = SEVERITIES.map(() => KINDS.map(() => 0));
    for (const row of rows) counts[column.severity[row]][column.kind[row]]++;
    this.kinds.note.textContent = "conflicts by kind and severity";
    describeChart(this.kinds.element, `Kinds: ${KINDS.map((name, kind) => `${name} ${SEVERITIES.map((severity, place) => `${number(counts[place][kind])} ${severity}`).join(", ")}`).join("; ")}.`);
    this.kinds.chart.setOption({
      ...basics(),
      tooltip: { ...basics().tooltip, trigger: "axis", axisPointer: { type: "none" },
        formatter: ([item]) => (item ? barTip(KINDS[item.dataIndex], counts, item.dataIndex) : "") },
      grid: { left: 4, right: 20, top: 8, bottom: 4, containLabel: true },
      xAxis: axis({ type: "value", minInterval: 1, splitNumber: 3 }),
      yAxis: axis({ type: "category", inverse: true, data: KINDS, axisTick: { show: false },
        axisLabel: { color: colours.ink } }),
      series: SEVERITIES.map((name, severity) => ({ id: name, name, type: "bar", stack: "all", barMaxWidth: 26,
        itemStyle: { color: severityColour(severity) }, data: counts[severity] })),
    });
  },
};
