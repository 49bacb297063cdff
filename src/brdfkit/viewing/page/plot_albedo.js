// The plot of directional albedo: the share of light that is reflected, over the angle of incidence.

const CHART_MARGIN = { left: 52, right: 12, top: 10, bottom: 34 };

/** Return the area of a plot with two axes. */
function placeChart({ width, height }) {
  const { left, right, top, bottom } = CHART_MARGIN;
  return { x: left, y: top, width: Math.max(width - left - right, 20), height: Math.max(height - top - bottom, 20) };
}

/** Return a linear axis in degrees up to `high`. */
function makeAngleAxis(label, high, step) {
  const ticks = [];
  for (let value = 0; value <= high; value += step) ticks.push([value, `${value}°`]);
  return { place: (value) => value / high, value: (share) => share * high, ticks, label };
}

/** Return the axis of the albedo, which reaches to 1 if that is near. */
function makeAlbedoAxis(plot) {
  const { lines } = plot.content;
  const largest = findLargest(lines.flatMap(({ values }) => values)) || 1;
  const top = largest > 0.6 ? Math.max(1.05, 1.05 * Math.min(largest, 10)) : 1.15 * largest;
  return {
    place: (value) => value / top, value: (share) => share * top,
    ticks: chooseTicks(0, top, 4).map((tick) => [tick, writeValue(tick)]), label: `reflected share, ${nameChannel(plot)}`,
  };
}

/** Clip what is drawn to an area. */
function clipTo(context, { x, y, width, height }) {
  context.beginPath();
  context.rect(x, y, width, height);
  context.clip();
}

/** Return the function from values on two axes to the canvas. */
function makePlacer(plot, area, across, up) {
  return (x, y) => plot.at([area.x + across.place(x) * area.width, area.y + (1 - up.place(y)) * area.height]);
}

const ALBEDO = {
  draw(context, plot) {
    const { content, colours, curves, session } = plot;
    const area = placeChart(plot);
    const [across, up] = [makeAngleAxis("θi", 90, 15), makeAlbedoAxis(plot)];
    const place = makePlacer(plot, area, across, up);
    context.save();
    clipTo(context, area);
    content.lines.forEach(({ theta_i: angles, known }) => {
      context.fillStyle = makeHatch(context, colours("bars"));
      for (const [from, to] of listGaps(known)) {
        const low = from === 0 ? 0 : (angles[from - 1] + angles[from]) / 2;
        const high = to === known.length - 1 ? 90 : (angles[to] + angles[to + 1]) / 2;
        const [[left], [right]] = [place(low, 0), place(high, 0)];
        context.fillRect(left, area.y, right - left, area.height);
      }
    });
    context.restore();
    drawAxes(context, colours, area, plot.at, [across, up]);
    context.save();
    clipTo(context, area);
    context.lineWidth = 1;
    context.strokeStyle = colours("ink");
    strokeLine(context, [place(0, 1), place(90, 1)]);
    context.strokeStyle = colours("soft");
    context.setLineDash([2, 4]);
    strokeLine(context, [place(session.state["plots.theta_i"], 0), place(session.state["plots.theta_i"], up.value(1))]);
    context.setLineDash([]);
    const marked = listMarks(plot).map((mark) => mark.theta_i);
    const [low, high] = findRange(session, "theta_i") || [Math.min(...marked), Math.max(...marked)];
    if (high >= low) {
      const [[left], [right]] = [place(low, 0), place(high, 0)];
      const [top, bottom] = [area.y + 1, area.y + area.height - 1];
      outlineRegion(context, plot, [[left, top], [right, top], [right, bottom], [left, bottom]]);
    }
    orderCurves(curves).forEach((number) => drawAlbedoLine(context, plot, content.lines[number], number, place));
    context.restore();
  },
  read(at, plot) {
    const area = placeChart(plot);
    const share = (plot.back(at)[0] - area.x) / area.width;
    if (share < 0 || share > 1) return "";
    const parts = plot.content.lines.map(({ theta_i: angles, values, known }, number) => {
      const k = findAngle({ theta_o: angles }, 90 * share);
      const text = values.map((own) => writeValue(own[k])).join(" ");
      return [angles[k], `${plot.curves[number].name} ${text}${known[k] ? "" : " (extrapolated)"}`];
    });
    return `albedo, ${nameChannel(plot)}, at θi ${writeAngle(parts[0][0])}: ${parts.map(([, text]) => text).join(" · ")}`;
  },
  select(from, to, plot) {
    const { x, width } = placeChart(plot);
    const [low, high] = [from, to].map((own) => 90 * clamp((plot.back(own)[0] - x) / width, 0, 1)).sort((a, b) => a - b);
    return selectRanges([["theta_i", Math.max(low - 1, 0), Math.min(high + 1, 90)]]);
  },
  rows({ content: { lines }, curves }) {
    const table = [["material", "theta_i", "known", ...lines[0].values.map((_, k) => `albedo_${k}`)]];
    lines.forEach((line, number) => line.theta_i.forEach((angle, k) => (
      table.push([curves[number].name, angle, line.known[k], ...line.values.map((values) => values[k])]))));
    return table;
  },
};

/** Draw the albedo of one material, dotted where it is extrapolated. */
function drawAlbedoLine(context, { curves }, { theta_i: angles, values, known }, number, place) {
  const { colour, measured, twin } = curves[number];
  values.forEach((own, channel) => {
    const tint = values.length > 1 ? CHANNEL_COLOURS[channel] : colour;
    const places = [...own].map((value, k) => place(angles[k], value));
    context.strokeStyle = context.fillStyle = tint;
    context.lineWidth = measured ? 2.5 : 1.75;
    for (let k = 1; k < places.length; k++) {
      context.setLineDash(known[k] && known[k - 1] ? (twin ? [7, 7] : values.length > 1 && !measured ? [7, 3] : []) : [1.5, 3]);
      strokeLine(context, [places[k - 1], places[k]]);
    }
    context.setLineDash([]);
    if (measured) fillDots(context, places.filter((_, k) => known[k]), 3);
  });
}
