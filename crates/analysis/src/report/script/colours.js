// Colours come from the style sheet, which follows the reader's light or dark scheme. The shape of a sign shows the kind.

let colours = {};

function readColours() {
  const style = getComputedStyle(document.documentElement);
  const names = ["page", "card", "ink", "faint", "rule", "accent", "caution", "serious", "critical", "ground", "junction",
    "road", "foot", "crossing", "within", "yield", "signal", "meeting", "heat-1", "heat-2", "heat-3", "heat-4",
    "heat-5", "fewer-1", "fewer-2", "fewer-3", "more-1", "more-2", "more-3"];
  colours = Object.fromEntries(names.map((name) => [name, style.getPropertyValue(`--${name}`).trim()]));
}
readColours();

const severityColour = (severity) => colours[SEVERITIES[severity]];

/** The sign of each kind as an SVG path in a box of 10 by 10. */
const SIGN_PATHS = ["M5,0A5,5,0,1,1,5,10A5,5,0,1,1,5,0Z", "M5,0L10,5L5,10L0,5Z", "M5,0.5L10,9.5L0,9.5Z"];

/** The sign of a kind in a colour, as an SVG element. */
function sign(kind, colour) {
  const space = "http://www.w3.org/2000/svg";
  const svg = document.createElementNS(space, "svg");
  svg.setAttribute("class", "sign");
  svg.setAttribute("viewBox", "0 0 10 10");
  svg.setAttribute("aria-hidden", "true");
  const path = document.createElementNS(space, "path");
  path.setAttribute("d", SIGN_PATHS[kind]);
  path.style.fill = colour;
  svg.append(path);
  return svg;
}

const FONT = 'system-ui, "Segoe UI", "DejaVu Sans", sans-serif';

/** The options that all charts share. */
function basics() {
  return {
    animation: false,
    textStyle: { color: colours.ink, fontFamily: FONT },
    tooltip: { confine: true, backgroundColor: colours.card, borderColor: colours.rule, textStyle: { color: colours.ink } },
  };
}

/** An axis in the page's colours. */
function axis(more) {
  return {
    axisLine: { lineStyle: { color: colours.faint } },
    axisTick: { lineStyle: { color: colours.faint } },
    axisLabel: { color: colours.faint, hideOverlap: true },
    nameTextStyle: { color: colours.faint },
    splitLine: { lineStyle: { color: colours.rule } },
    ...more,
  };
}

/** A chart in an element, resized with it. */
function chartIn(element, resized) {
  const chart = echarts.init(element, null, { renderer: "canvas" });
  new ResizeObserver(() => {
    const same = element.clientWidth === chart.getWidth() && element.clientHeight === chart.getHeight();
    if (element.clientWidth === 0 || same) return;
    chart.resize();
    if (resized) resized();
  }).observe(element);
  return chart;
}
