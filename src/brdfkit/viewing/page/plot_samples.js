// The plot of samples: measured values as points over an angle, coloured by what the model makes of them.

const SAMPLE_RADIUS = 2;
const LOG_SAMPLES = { decades: 9, share: 0.002 }; // an axis that reaches nearly all samples

/** Return the axes of the plot, across θh (even in its square root) or θo, and the values upwards. */
function makeSampleAxes(plot) {
  const { content, session } = plot;
  const half = session.state["plots.samples_over"] !== "theta_o";
  const values = makeValueScale("log", [content.values], LOG_SAMPLES);
  const across = half ? { ...SLICE_AXES[0], value: (share) => 90 * share ** 2 } : makeAngleAxis("θo", 90, 15);
  return { angles: half ? content.theta_h : content.theta_o, across, up: { ...values, label: `BRDF [sr⁻¹], ${nameChannel(plot, true)}` } };
}

/** Return the area of the plot, left of the colours. */
function placeSamples(plot) {
  const area = placeChart(plot);
  return { ...area, width: area.width - LEGEND_ROOM };
}

/** Return the index of the sample nearest to a place, within a few pixels, or −1. */
function findSample(at, plot) {
  const { angles, across, up } = makeSampleAxes(plot);
  const place = makePlacer(plot, placeSamples(plot), across, up);
  let [best, least] = [-1, 10];
  plot.content.values.forEach((value, k) => {
    const [x, y] = place(angles[k], value);
    const distance = Math.hypot(x - at[0], y - at[1]);
    if (distance < least) [best, least] = [k, distance];
  });
  return best;
}

/** Draw a stroke from the value less its noise to the value plus it at each sample. */
function drawNoise(context, plot, place, angles) {
  const { noise, values } = plot.content;
  context.lineWidth = 1;
  context.globalAlpha = 0.35;
  context.strokeStyle = plot.colours("soft");
  context.beginPath();
  values.forEach((value, k) => {
    context.moveTo(...place(angles[k], value * Math.max(1 - noise, 0.01)));
    context.lineTo(...place(angles[k], value * (1 + noise)));
  });
  context.stroke();
  context.globalAlpha = 1;
}

/** Draw the samples, coloured by the ratio of the first model to them, a batch for each colour. */
function drawSamples(context, { content }, place, angles) {
  const ratios = content.models[0]?.ratio;
  const batches = new Map();
  content.values.forEach((value, k) => {
    const share = ratios ? clamp(ratios[k] / Math.log2(content.largest_ratio) / 2 + 0.5, 0, 1) : 0.5;
    const step = Math.round(share * 16);
    if (!batches.has(step)) batches.set(step, []);
    batches.get(step).push(place(angles[k], value));
  });
  // Small differences first, so that large ones lie above them
  for (const [step, places] of [...batches].sort(([a], [b]) => Math.abs(a - 8) - Math.abs(b - 8))) {
    context.fillStyle = `rgb(${mixColour(content.colours, step / 16).map(Math.round).join(" ")})`;
    fillDots(context, places, SAMPLE_RADIUS);
    if (Math.abs(step - 8) > 3) continue; // colours that show on white and on black
    context.lineWidth = 0.4;
    context.strokeStyle = "rgb(128 128 128 / 80%)";
    context.beginPath();
    for (const [x, y] of places) {
      context.moveTo(x + SAMPLE_RADIUS, y);
      context.arc(x, y, SAMPLE_RADIUS, 0, 2 * Math.PI);
    }
    context.stroke();
  }
}

const SAMPLES = {
  draw(context, plot) {
    const { content, colours } = plot;
    const { angles, across, up } = makeSampleAxes(plot);
    const area = placeSamples(plot);
    const place = makePlacer(plot, area, across, up);
    drawAxes(context, colours, area, plot.at, [across, up]);
    context.save();
    clipTo(context, area);
    if (content.noise) drawNoise(context, plot, place, angles);
    drawSamples(context, plot, place, angles);
    const range = findRange(plot.session, angles === content.theta_h ? "theta_h" : "theta_o");
    const values = findRange(plot.session, "value");
    if (range && values) {
      outlineRegion(context, plot, [[0, 0], [1, 0], [1, 1], [0, 1]].map(([i, j]) => place(range[i], values[j])));
    } else {
      drawMarks(context, plot, listMarks(plot).map((mark) => place(
        angles === content.theta_h ? mark.theta_h : mark.theta_o, mark.value)));
    }
    context.restore();
    const bar = { ...plot, content: { ...content, ratio_colours: content.colours } };
    drawColourScale(context, bar, "ratio", area);
  },
  read(at, plot) {
    const k = findSample(at, plot);
    if (k < 0) return "";
    const { content, curves } = plot;
    const names = curves.filter(({ measured }) => !measured).map(({ name }) => name);
    const models = content.models.map(({ values, ratio }, number) => (
      `${names[number]} ${writeValue(values[k])} (× ${writeValue(2 ** ratio[k])})`));
    const angles = `θh ${writeAngle(content.theta_h[k])}, θo ${writeAngle(content.theta_o[k])}`;
    return `${angles}, ${nameChannel(plot, true)}: data ${writeValue(content.values[k])} · ${models.join(" · ")}`;
  },
  select(from, to, plot) {
    const { content } = plot;
    if (from === to) {
      const nearest = findSample(from, plot);
      if (nearest < 0) return null;
      const [h, o, value] = [content.theta_h[nearest], content.theta_o[nearest], content.values[nearest]];
      const near = Math.abs(value) * 1e-4 + 1e-9; // numbers came in single precision
      return selectRanges([["theta_h", h - 0.01, h + 0.01], ["theta_o", o - 0.01, o + 0.01], ["value", value - near, value + near]]);
    }
    const { angles, across, up } = makeSampleAxes(plot);
    const area = placeSamples(plot);
    const [start, end] = [from, to].map((own) => {
      const [x, y] = plot.back(own);
      const [right, high] = [clamp((x - area.x) / area.width, 0, 1), clamp(1 - (y - area.y) / area.height, 0, 1)];
      return [across.value(right), up.value(high)];
    });
    const name = angles === content.theta_h ? "theta_h" : "theta_o";
    return selectRanges([[name, start[0], end[0]], ["value", start[1], end[1]]]);
  },
  rows({ content, curves }) {
    const names = curves.filter(({ measured }) => !measured).map(({ name }) => name);
    const table = [["theta_h", "theta_o", "measured", ...names]];
    content.values.forEach((value, k) => table.push(
      [content.theta_h[k], content.theta_o[k], value, ...content.models.map(({ values }) => values[k])]));
    return table;
  },
};
