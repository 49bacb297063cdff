// A transfer function of points over values: how the editor places, moves, adds and removes them.

const MOST_POINTS = 256;

/** Return the linear mixture of two colours "#rrggbb", as the picture of the curve shows it. */
function mixColours(first, second, share) {
  const parts = [1, 3, 5].map((at) => {
    const [a, b] = [first, second].map((colour) => parseInt(colour.slice(at, at + 2), 16));
    return Math.round(a + share * (b - a)).toString(16).padStart(2, "0");
  });
  return `#${parts.join("")}`;
}

/** Return [colour, opacity] of points at a value. */
function readPoints(points, value) {
  const above = points.findIndex(([own]) => own >= value);
  if (above < 0) return points[points.length - 1].slice(1);
  if (above === 0) return points[0].slice(1);
  const [[x0, colour0, a0], [x1, colour1, a1]] = [points[above - 1], points[above]];
  const share = x1 > x0 ? (value - x0) / (x1 - x0) : 1;
  return [mixColours(colour0, colour1, share), a0 + share * (a1 - a0)];
}

/**
 * Make the menu of presets. Choosing one makes Python fill the points.
 *
 * Where these are no longer shown, the menu says "edited": so the preset can be chosen again.
 */
function makePresetMenu(session, presets) {
  const filled = new Map(); // preset → the points with which Python filled it
  let chosen = session.state["transfer.preset"]; // whose points are still to come
  const select = make("select", {
    onchange: () => {
      chosen = presets[select.selectedIndex];
      session.change({ "transfer.preset": chosen });
    },
  }, ...presets.map((name) => make("option", {}, name.replace(/_/g, " "))));
  select.append(make("option", { hidden: true }, "edited"));

  function show(names) {
    const { "transfer.preset": name, "transfer.points": points, "transfer.mode": mode } = session.state;
    if (chosen && names.has("transfer.points")) {
      filled.set(chosen, points);
      chosen = "";
    }
    const moved = filled.has(name) && !chosen && !equal(filled.get(name), points);
    const edited = moved || mode.startsWith("bumps");
    select.selectedIndex = edited ? presets.length : presets.indexOf(name);
  }
  return { row: makeRow("choice", "Preset", select), show };
}

/**
 * Return what the editor needs to know of points.
 *
 * Places are shares of the range of values and of the plot's height, upwards. All functions that
 * change something return a new list and leave the old one as it is; `allows` says whether Python
 * accepts a list.
 */
function makePointKind({ range: [low, high], value_unit: unit = "" }) {
  const width = high - low || 1;
  const grain = chooseStep(0, width) / 100; // of values that are dragged: about the range / 10 000
  const round = (value) => Number((grain * Math.round(value / grain)).toPrecision(12));
  const replace = (points, k, point) => points.map((old, other) => (other === k ? point : old));
  const moved = (points, k, value, a) => {
    const lowest = k > 0 ? points[k - 1][0] : -Infinity;
    const highest = k < points.length - 1 ? points[k + 1][0] : Infinity;
    const kept = clamp(clamp(value, low, high), lowest, highest);
    return replace(points, k, [kept, points[k][1], roundNumber(clamp(a, 0, 1))]);
  };
  return {
    name: "transfer.points",
    noun: "point",
    allows: (points) =>
      points.length >= 2 && points.length <= MOST_POINTS && points[0][0] < points[points.length - 1][0],
    place: ([value, , a]) => [(value - low) / width, a],
    colour: ([, colour]) => colour,
    move: (points, k, x, y) => moved(points, k, round(low + x * width), y),
    describe: ([value, , a]) => `${writeQuantity(value, unit)}, opacity ${writeNumber(a)}`,
    add(points, x, y) {
      const value = round(low + x * width);
      const above = points.findIndex(([own]) => own > value);
      const k = above < 0 ? points.length : above;
      const [colour] = points.length ? readPoints(points, value) : ["#ffffff"];
      return [[...points.slice(0, k), [value, colour, roundNumber(y)], ...points.slice(k)], k];
    },
    evaluate(points, x) {
      return points.length ? readPoints(points, low + x * width) : ["#000000", 0];
    },
    fields: [
      {
        label: "Value", unit, low, high, step: chooseStep(low, low + width),
        get: ([value]) => value, set: (points, k, value) => moved(points, k, value, points[k][2]),
      },
      {
        label: "Opacity", low: 0, high: 1, step: 0.01,
        get: ([, , a]) => a, set: (points, k, a) => replace(points, k, [...points[k].slice(0, 2), a]),
      },
      {
        label: "Colour", colour: true,
        get: ([, colour]) => colour,
        set: (points, k, colour) => replace(points, k, [points[k][0], colour, points[k][2]]),
      },
    ],
  };
}
