// What the page is about, and what to know before believing it; drawn once.

/** The scenarios as a title. */
const titleWords = () => (scenarioNames.length > MOST_PLANS ? `${scenarioNames.length} scenarios` : scenarioNames.join(" and "));

/** What was simulated, in a line; with the scenarios' files, or their names. */
function subjectWords(hasFiles) {
  const records = data.runs.filter((run) => run.summary);
  const scenarios = hasFiles ? [...new Set(records.map((run) => run.scenario))] : scenarioNames;
  const runs = data.runs.length === 1 ? "one run" : `${number(data.runs.length)} runs`;
  const more = scenarios.length > 3 ? ` and ${scenarios.length - 3} more` : "";
  const sum = (pick) => records.reduce((all, run) => all + pick(run.summary), 0);
  const simulated = sum(({ begin, end }) => end - begin);
  const duration = simulated < 3600 ? `${number(simulated)} s` : `${number(simulated / 3600, 1)} h`;
  const traffic = records.length ? `, ${duration} simulated, ${number(sum((summary) => summary.exposure.vehicles))} vehicles, `
    + `${number(sum((summary) => summary.exposure.vehicle_kilometres))} vehicle-km` : "";
  return `Traffic conflicts in ${scenarios.slice(0, 3).join(", ") || data.runs.map((run) => run.folder)[0]}${more}: ${runs}${traffic}`;
}

function showHeader(hasFiles = true) {
  document.title = `${titleWords()} – conflicts`;
  byId("name").textContent = titleWords();
  byId("subject").textContent = subjectWords(hasFiles);
  const charts = typeof echarts === "undefined" ? "" : ` Charts: Apache ECharts ${echarts.version} (Apache-2.0).`;
  byId("maker").textContent = `Made by closecall ${data.version}.${charts}`;
}

/** What closecall says of the logs. */
function notes() {
  const all = [...data.notes];
  if (count < data.seen) all.push(`This page contains the ${number(count)} worst of ${number(data.seen)} conflicts.`);
  if (data.scope.artefacts) all.push("Conflicts that are not traffic’s are shown, too (--artefacts); they count in no figure.");
  const cut = data.runs.filter((run) => run.summary?.steps > 0 && run.complete === false).length;
  if (cut) all.push(data.runs.length === 1 ? "The run did not reach its end." : `${number(cut)} of ${number(data.runs.length)} runs did not reach their end.`);
  return all;
}

/** The box of remarks: those of the runs, then what closecall says of the logs. */
function showRemarks() {
  const [said, noted] = [data.remarks.map(({ text }) => text), notes()];
  for (const [id, texts] of [["said", said], ["notes", noted]]) {
    byId(id).replaceChildren(...texts.map((textContent) => make("li", { textContent })));
    byId(id).hidden = !texts.length;
  }
  byId("remarks").hidden = !said.length && !noted.length;
}

/** A text whose words between asterisks are bold. */
const emphasised = (text) => text.split("*").map((part, place) => (place % 2 ? make("b", { textContent: part }) : part));

/** The sentences that name thresholds. */
function showReading() {
  const paragraphs = (texts) => texts.map((text) => make("p", {}, ...emphasised(text)));
  byId("severityrule").replaceChildren(...paragraphs(data.reading.severity));
  byId("kindrule").replaceChildren(...paragraphs(data.reading.kind));
  if (data.reading.severity.length > 1) byId("severityrule").prepend(make("p", { textContent: "The runs used several rules of severity:" }));
}
