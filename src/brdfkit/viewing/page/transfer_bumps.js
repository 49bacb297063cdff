// A transfer function of bumps, over values or over values and gradient magnitudes.

const NEW_BUMP_COLOURS = ["#e69f00", "#56b4e9", "#009e73", "#d55e00", "#cc79a7", "#f0e442"];
const NARROWEST = 0.002; // of a bump, as a share of an axis
const WIDEST = 2;
const MOST_BUMPS = 64;

/** Return the opacity of a bump at a place; `y` is null where gradients do not count. */
function fadeBump({ x, y, sx, sy, a }, atX, atY) {
  const up = atY === null ? 0 : (atY - y) / sy;
  return a * Math.exp(-(((atX - x) / sx) ** 2) - up ** 2);
}

/** Return [red, green, blue, opacity] of bumps at a place, later ones over earlier ones. */
function blendBumps(bumps, x, y) {
  const sum = [0, 0, 0, 0];
  for (const bump of bumps) {
    const a = fadeBump(bump, x, y);
    const rest = sum[3] * (1 - a);
    const whole = a + rest || 1;
    for (let c = 0; c < 3; c++) {
      const own = parseInt(bump.colour.slice(1 + 2 * c, 3 + 2 * c), 16);
      sum[c] = (a * own + rest * sum[c]) / whole;
    }
    sum[3] = a + rest;
  }
  return sum;
}

/** Return what the editor needs to know of bumps; `flat` if they are over values and gradients. */
function makeBumpKind(volume, flat) {
  const { range: [low, high], steepest = 1, value_unit: unit = "", unit: length = "" } = volume;
  const width = high - low || 1;
  const slope = unit && length ? `${unit}/${length}` : "";
  const replace = (bumps, k, changes) => bumps.map((old, j) => (j === k ? { ...old, ...changes } : old));
  const share = (value) => roundNumber(clamp(value, 0, 1));
  const spread = (value) => roundNumber(clamp(value, NARROWEST, WIDEST));
  const number = (label, own, scale, offset, limits) => ({
    label, ...limits,
    get: (bump) => roundNumber(bump[own] * scale + offset),
    set: (bumps, k, value) => replace(bumps, k, { [own]: roundNumber((value - offset) / scale) }),
  });
  const step = chooseStep(0, width);
  const rise = chooseStep(0, steepest);
  const across = [
    number("Value", "x", width, low, { unit, low, high, step }),
    number("Width", "sx", width, 0, { unit, low: NARROWEST * width, high: WIDEST * width, step }),
  ];
  const upwards = [
    number("Gradient", "y", steepest, 0, { title: slope, low: 0, high: steepest, step: rise }),
    number("Height", "sy", steepest, 0, {
      title: slope, low: NARROWEST * steepest, high: WIDEST * steepest, step: rise,
    }),
  ];
  return {
    name: "transfer.bumps",
    noun: "bump",
    allows: (bumps) => bumps.length <= MOST_BUMPS,
    flat,
    place: ({ x, y, a }) => [x, flat ? y : a],
    colour: ({ colour }) => colour,
    move: (bumps, k, x, y) => replace(bumps, k, { x: share(x), [flat ? "y" : "a"]: share(y) }),
    describe({ x, y, a }) {
      const gradient = flat ? `, gradient ${writeQuantity(y * steepest, slope)}` : "";
      return `${writeQuantity(low + x * width, unit)}${gradient}, opacity ${writeNumber(a)}`;
    },
    /** Return bumps of which one is wider and higher by factors. */
    scale: (bumps, k, right, up) =>
      replace(bumps, k, { sx: spread(bumps[k].sx * right), sy: spread(bumps[k].sy * up) }),
    add(bumps, x, y, shown) {
      const colour = NEW_BUMP_COLOURS[bumps.length % NEW_BUMP_COLOURS.length];
      const [up, a] = flat ? [share(y), 0.5] : [0.25, share(y)];
      return [[...bumps, { x: share(x), y: up, sx: spread(0.08 * shown), sy: 0.2, colour, a }], bumps.length];
    },
    evaluate(bumps, x) {
      const [r, g, b, a] = blendBumps(bumps, x, null);
      return [`rgb(${r} ${g} ${b})`, a];
    },
    fields: [
      ...across,
      ...(flat ? upwards : []),
      number("Opacity", "a", 1, 0, { low: 0, high: 1, step: 0.01 }),
      {
        label: "Colour", colour: true,
        get: ({ colour }) => colour, set: (bumps, k, colour) => replace(bumps, k, { colour }),
      },
    ],
  };
}
