// 95 % intervals of the risk index of some conflicts, those of `closecall stats`.

/** Quantiles of Student's t for 95 % by degrees of freedom from 1 on. */
const T = [12.7062, 4.3027, 3.1824, 2.7764, 2.5706, 2.4469, 2.3646, 2.306, 2.2622];
const Z = 1.959964;

/** The same for any degrees of freedom: beyond the table by Cornish and Fisher's expansion, right to 1e-4. */
function studentsT(freedom) {
  const [z3, z5, z7] = [Z ** 3, Z ** 5, Z ** 7];
  return T[freedom - 1] || Z + (z3 + Z) / (4 * freedom) + (5 * z5 + 16 * z3 + 3 * Z) / (96 * freedom ** 2)
    + (3 * z7 + 19 * z5 + 17 * z3 - 15 * Z) / (384 * freedom ** 3);
}

/** ln Γ(x + 1) (Stirling's series, above 10). */
function logFactorial(x) {
  let [at, shift] = [x + 1, 0];
  while (at < 10) shift += Math.log(at++);
  return (at - 0.5) * Math.log(at) - at + 0.5 * Math.log(2 * Math.PI) + 1 / (12 * at) - 1 / (360 * at ** 3) - shift;
}

/** The share of a gamma distribution of this shape, and scale 1, below x. */
function gammaShare(shape, x) {
  let [term, sum] = [1, 1];
  for (let n = 1; term > 1e-12 * sum; n++) {
    term *= x / (shape + n);
    sum += term;
  }
  return sum * Math.exp(shape * Math.log(x) - x - logFactorial(shape));
}

/** The value below which this share, 0.025 or 0.975, of a gamma distribution of this shape and scale 1 is. */
function gammaQuantile(shape, share) {
  // Wilson and Hilferty's (1931) is right to 1e-5 there.
  if (shape > 200) return shape * (1 - 1 / (9 * shape) + Math.sign(share - 0.5) * Z * Math.sqrt(1 / (9 * shape))) ** 3;
  let [low, high] = [0, shape + 10 * Math.sqrt(shape) + 20];
  for (let halving = 0; halving < 60; halving++) {
    const middle = (low + high) / 2;
    if (gammaShare(shape, middle) < share) low = middle;
    else high = middle;
  }
  return low;
}

/** Sums of runs that spread by less than this, relatively, are equal. */
const EQUAL = 1e-9;

/**
 * The 95 % interval of the risk index of some conflicts, that of `closecall stats`: over the runs by the ratio estimator,
 * where there are several of one variant that differ; otherwise that of a sum of independent rare events, each with its
 * weight (Fay and Feuer 1997). `traffic` of each run: equal, or the vehicles that entered.
 */
function riskInterval(rows, traffic = () => 1, variant = filter.variant) {
  const runs = filter.run === null && (data.variants.length < 2 || variant !== null)
    ? data.runs.map((_, run) => run).filter((run) => variant === null || variantOf[run] === variant) : [];
  const sum = rows.reduce((all, row) => all + risk[row], 0);
  if (sum <= 0) return [0, 0];
  if (runs.length > 1) {
    const ofRun = new Map(runs.map((run) => [run, 0]));
    for (const row of rows) ofRun.set(column.run[row], (ofRun.get(column.run[row]) || 0) + risk[row]);
    const many = ofRun.size;
    const all = [...ofRun.keys()].reduce((total, run) => total + traffic(run), 0);
    const squares = [...ofRun].reduce((total, [run, value]) => total + (value - (sum / all) * traffic(run)) ** 2, 0);
    const error = Math.sqrt((squares * many) / (many - 1));
    const reach = studentsT(many - 1) * error;
    const differ = [...ofRun.values()].some((value) => Math.abs(value * many - sum) > EQUAL * sum);
    if (differ && error > EQUAL * sum) return [Math.max(0, sum - reach), sum + reach];
  }
  let [squares, greatest] = [0, 0];
  for (const row of rows) {
    squares += risk[row] ** 2;
    greatest = Math.max(greatest, risk[row]);
  }
  const low = (squares / sum) * gammaQuantile(sum ** 2 / squares, 0.025);
  const [more_squares, more] = [squares + greatest ** 2, sum + greatest];
  return [low, (more_squares / more) * gammaQuantile(more ** 2 / more_squares, 0.975)];
}

/** The interval of a group, computed once. */
const intervalOf = (group) => (group.interval ||= riskInterval(group.rows, undefined, group.variant));
/** Whether chance may have put a spot behind another: their intervals overlap. */
const mayOutrank = (spot, other) => intervalOf(spot)[1] >= intervalOf(other)[0];
