// What is shown: the whole traffic or a part of it, one plan or several. Sentences depend on it, since a share, a rank or a rate of
// a part is not that of the whole.

/** Up to this many plans stand side by side. */
const MOST_PLANS = 4;

/** Whether only conflicts at chosen places are shown. */
const isOfPlace = () => data.scope.place || filter.spot !== null || filter.circle !== null || filter.area !== null;
/** Whether only conflicts of a period are shown: of its traffic nothing is known. */
const isOfPeriod = () => data.scope.period || Number.isFinite(filter.from) || Number.isFinite(filter.to);
/** Whether these are not all conflicts: the filter of the page, or of the command, leaves some out. */
const isPart = (rows) => rows.length < count || Boolean(data.filter);

/** The plans that are shown together: runs that differ in more than the seed have no ranks and no rates in common. */
const plansShown = () => (data.variants.length > 1 && filter.variant === null && filter.run === null ? data.variants : []);

/** What the plans are called: by their scenarios where these tell them apart, or else by what differs. */
function planNames() {
  planNames.known ||= (() => {
    const scenarios = data.variants.map(({ runs }) => [...new Set(runs.map((run) => nameOfScenario(data.runs[run])))].join(" and "));
    return new Set(scenarios).size === scenarios.length ? scenarios : data.variants.map(({ name }) => name);
  })();
  return planNames.known;
}
