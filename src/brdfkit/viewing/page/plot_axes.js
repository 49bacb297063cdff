// What all plots draw with: scales, ticks, axes, hatching, and arrays as Python sends them.

const CHANNEL_COLOURS = ["#d55e00", "#009e73", "#3a8fd9"]; // of R, G and B, for all eyes
// Most decades of a logarithmic scale, and the share of values that may lie below it
const LOG_LOBES = { decades: 5, share: 0.02 };
const LEAST_TICK = 0.13; // of a scale, between two ticks
const HATCH = 7; // pixels between the lines of unmeasured parts

/** Replace each {at, shape} in a content by the numbers that it stands for, from the bytes. */
function readArrays(content, bytes) {
  const numbers = new Float32Array(bytes.slice().buffer);
  const read = (value) => {
    if (Array.isArray(value)) return value.map(read);
    if (!value || typeof value !== "object") return value;
    if ("at" in value && "shape" in value) {
      const size = value.shape.reduce((product, length) => product * length, 1);
      const flat = numbers.subarray(value.at, value.at + size);
      if (value.shape.length !== 2) return flat;
      const [rows, columns] = value.shape;
      return Array.from({ length: rows }, (_, k) => flat.subarray(k * columns, (k + 1) * columns));
    }
    return Object.fromEntries(Object.entries(value).map(([name, inner]) => [name, read(inner)]));
  };
  return read(content);
}

/** Return the indices of curves as they are drawn: the shown model last, but for the dashes of its twins. */
function orderCurves(curves) {
  const shown = curves.findIndex(({ measured }) => !measured);
  const rank = (k) => (curves[k].twin ? 2 : k === shown ? 1 : 0);
  return [...curves.keys()].sort((a, b) => rank(a) - rank(b));
}

/** Return the largest of the numbers in arrays that are finite, or 0. */
function findLargest(arrays) {
  let largest = 0;
  for (const array of arrays) for (const value of array) if (value > largest && value < Infinity) largest = value;
  return largest;
}

/** Return the number below which a share of the positive numbers in arrays lie. */
function findLow(arrays, share) {
  const positive = [];
  for (const array of arrays) for (const value of array) if (value > 0 && value < Infinity) positive.push(value);
  positive.sort((a, b) => a - b);
  return positive[Math.floor(share * positive.length)] ?? 1;
}

/**
 * Return a scale of values from 0 or more: `place` gives 0 to 1, `ticks` pairs of value and text.
 *
 * `kind` is "linear", "cbrt" or "log"; the logarithmic one begins below most of the values.
 */
function makeValueScale(kind, arrays, { decades, share } = LOG_LOBES) {
  const top = 1.04 * (findLargest(arrays) || 1);
  if (kind === "log") {
    const high = Math.log10(top);
    const least = Math.log10(findLow(arrays, share));
    const low = Math.floor(Math.min(Math.max(least - 0.2 * (high - least), high - decades), high - 0.5));
    const step = Math.ceil((high - low) / 4.5);
    const powers = [];
    for (let power = low + step; power <= high; power += step) powers.push(10 ** power);
    const place = (value) => Math.max((Math.log10(Math.max(value, 1e-30)) - low) / (high - low), 0);
    const value = (part) => 10 ** (low + part * (high - low));
    return { place, value, ticks: powers.map((power) => [power, writeValue(power)]) };
  }
  const power = kind === "cbrt" ? 3 : 1;
  const place = (value) => Math.max(value / top, 0) ** (1 / power);
  const value = (part) => top * part ** power;
  let ticks = chooseTicks(0, top, 4).slice(1);
  if (power === 3) {
    const coarse = 10 ** Math.floor(Math.log10(top));
    ticks = [coarse / 100, coarse / 10, coarse, ...(top > 4 * coarse ? [4 * coarse] : [])];
  }
  // From the top, those that leave room for the text of the one above
  const apart = ticks.reverse().reduce((kept, tick) => (
    kept.length && place(kept[0]) - place(tick) < LEAST_TICK ? kept : [tick, ...kept]), []);
  return { place, value, ticks: apart.map((tick) => [tick, writeValue(tick)]) };
}

/** Write a value of a BRDF with three digits, as 0.0123 or 1.2e−5. */
function writeValue(value) {
  if (!Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  const text = size >= 1e5 || size < 1e-3 ? Number(value).toExponential(size < 1e-3 ? 0 : 1) : String(Number(value.toPrecision(3)));
  return text.replace("e+", "e").replace(/-/g, "−");
}

/** Write an angle in degrees. */
function writeAngle(degrees) {
  return `${String(Math.round(10 * degrees) / 10).replace("-", "−")}°`;
}

/** Return a pattern of thin oblique lines in a colour, for what was not measured. */
function makeHatch(context, colour) {
  const tile = document.createElement("canvas");
  tile.width = tile.height = HATCH;
  const own = tile.getContext("2d");
  own.strokeStyle = colour;
  own.lineWidth = 1;
  own.beginPath();
  for (const shift of [-HATCH, 0, HATCH]) {
    own.moveTo(shift - 1, HATCH + 1);
    own.lineTo(shift + HATCH + 1, -1);
  }
  own.stroke();
  return context.createPattern(tile, "repeat");
}

/** Return the ranges [from, to] of indices in which a mask is 0. */
function listGaps(mask) {
  const gaps = [];
  let start = -1;
  for (let k = 0; k <= mask.length; k++) {
    const missing = k < mask.length && !mask[k];
    if (missing && start < 0) start = k;
    if (!missing && start >= 0) {
      gaps.push([start, k - 1]);
      start = -1;
    }
  }
  return gaps;
}

/** Draw a line through places [x, y], with gaps where one is null. */
function strokeLine(context, places) {
  let drawing = false;
  context.beginPath();
  for (const place of places) {
    if (place && drawing) context.lineTo(...place);
    else if (place) context.moveTo(...place);
    drawing = Boolean(place);
  }
  context.stroke();
}

/** Draw round dots at places [x, y]. */
function fillDots(context, places, radius) {
  context.beginPath();
  for (const [x, y] of places) {
    context.moveTo(x + radius, y);
    context.arc(x, y, radius, 0, 2 * Math.PI);
  }
  context.fill();
}

/**
 * Draw the frame, the ticks and the names of two axes around an area.
 *
 * An axis has `place` (value → 0 to 1), `ticks` ([value, text] each) and a `label`; `at` takes a
 * place of the whole plot to the zoomed one on the canvas. Ticks are lines only with `grid`.
 */
function drawAxes(context, colours, area, at, [across, up], grid = true) {
  const { x, y, width, height } = area;
  context.save();
  context.lineWidth = 1;
  context.fillStyle = colours("soft");
  context.strokeStyle = colours("line");
  context.textBaseline = "top";
  context.textAlign = "center";
  for (const [value, text] of across.ticks) {
    const [px] = at([x + across.place(value) * width, y]);
    if (px < x - 0.5 || px > x + width + 0.5) continue;
    if (grid) strokeLine(context, [[px, y], [px, y + height]]);
    context.fillText(text, px, y + height + 4);
  }
  context.textBaseline = "middle";
  context.textAlign = "right";
  for (const [value, text] of up.ticks) {
    const [, py] = at([x, y + (1 - up.place(value)) * height]);
    if (py < y - 0.5 || py > y + height + 0.5) continue;
    if (grid) strokeLine(context, [[x, py], [x + width, py]]);
    context.fillText(text, x - 5, py);
  }
  context.strokeStyle = colours("edge");
  context.strokeRect(x + 0.5, y + 0.5, width - 1, height - 1);
  context.textAlign = "center";
  context.textBaseline = "bottom";
  context.fillStyle = colours("ink");
  context.fillText(across.label, x + width / 2, y + height + 31);
  context.translate(x > 60 ? x - 34 : 9, y + height / 2);
  context.rotate(-Math.PI / 2);
  context.textBaseline = "middle";
  context.fillText(up.label, 0, 0);
  context.restore();
}

/** Return what of the colour a plot shows; one that has a single value shows luminance for all. */
function nameChannel({ session }, single = false) {
  const channel = session.state["plots.channel"];
  return channel === "each" ? (single ? "luminance" : "R, G, B") : channel;
}
