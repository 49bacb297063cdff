// Finds bumps that resemble a curve of opacity; with these the change from points to bumps begins.

const PEAK_STEPS = 256; // of the range of values
const MOST_PEAKS = 4;
const FAINTEST_PEAK = 0.01; // opacity below which the curve has no peak
const PEAK_HEIGHT = { y: 0.5, sy: 1 }; // of their bumps, which are nearly the same for all gradients

/** Return how many steps a curve needs from a peak, one `way`, to fall to 1/e or to rise again. */
function measureSlope(curve, peak, way) {
  let k = peak;
  while (k + way in curve && curve[k] > curve[peak] / Math.E && curve[k + way] <= curve[k]) k += way;
  return Math.abs(k - peak);
}

/** Return the peaks of a curve, its numbers from the left: the middle of each and its half width. */
function findPeaks(curve) {
  const peaks = [];
  for (let start = 0, end; start < curve.length; start = end + 1) {
    for (end = start; curve[end + 1] === curve[start]; ) end += 1; // a plateau is one peak
    const higher = (k) => curve[k] > curve[start];
    if (curve[start] < FAINTEST_PEAK || higher(start - 1) || higher(end + 1)) continue;
    const middle = Math.round((start + end) / 2);
    const slopes = [-1, 1].map((way) => measureSlope(curve, middle, way)).filter(Boolean);
    const width = slopes.reduce((sum, steps) => sum + steps / slopes.length, 0);
    peaks.push({ middle, width: Math.max(width, 1) });
  }
  return peaks;
}

/** Return bumps at the highest peaks of a transfer function, which `kind` evaluates. */
function resembleByBumps(kind, items) {
  const samples = Array.from({ length: PEAK_STEPS + 1 }, (_, k) => kind.evaluate(items, k / PEAK_STEPS));
  const curve = samples.map(([, a]) => a);
  const chosen = [];
  for (const peak of findPeaks(curve).sort((one, other) => curve[other.middle] - curve[one.middle])) {
    const covered = chosen.some(({ middle, width }) => Math.abs(middle - peak.middle) < width);
    if (!covered && chosen.length < MOST_PEAKS) chosen.push(peak);
  }
  return chosen.sort((one, other) => one.middle - other.middle).map(({ middle, width }) => ({
    x: roundNumber(middle / PEAK_STEPS), sx: roundNumber(width / PEAK_STEPS), ...PEAK_HEIGHT,
    colour: samples[middle][0], a: roundNumber(curve[middle]),
  }));
}

/** Make the menu of modes; bumps that nobody has drawn yet begin as those that resemble the curve. */
function makeModeMenu(session, control) {
  const first = session.state["transfer.bumps"];

  /** Return the bumps with which another mode begins; none if it goes on with those of the state. */
  function begin(mode) {
    const { "transfer.mode": before, "transfer.bumps": bumps, "transfer.points": points } = session.state;
    const drawn = before.startsWith("bumps") || bumps.length !== 1 || !equal(bumps, first);
    if (drawn || !mode.startsWith("bumps")) return [];
    return resembleByBumps(makePointKind(session.description.volume), points);
  }
  function change({ [control.name]: mode }) {
    const begun = begin(mode);
    session.change({ [control.name]: mode, ...(begun.length ? { "transfer.bumps": begun } : {}) });
  }
  return makeChoice({ change }, control);
}
