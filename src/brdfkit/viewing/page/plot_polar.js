// The polar plot of lobes: BRDFs over the angle of view, with the light as an arrow that is dragged.

const POLAR_MARGIN = { side: 30, top: 22, bottom: 20 };
const HANDLE = 7; // pixels of the radius of the light's handle
const LARGEST_INCIDENCE = 89;

/** Return the centre and the radius of the half disc on the canvas, before the zoom. */
function placeDisc({ width, height }) {
  const { side, top, bottom } = POLAR_MARGIN;
  const radius = Math.max(Math.min(width / 2 - side, height - top - bottom), 10);
  return { x: width / 2, y: top + radius + Math.max((height - top - bottom - radius) / 2, 0), radius };
}

/** Return the place of an angle [degrees] and a share of the radius, zoomed. */
function placePolar(plot, degrees, share) {
  const { x, y, radius } = placeDisc(plot);
  const angle = (degrees * Math.PI) / 180;
  return plot.at([x + share * radius * Math.sin(angle), y - share * radius * Math.cos(angle)]);
}

/** Return the angle [degrees] and the share of the radius of a place. */
function readPolar(plot, place) {
  const { x, y, radius } = placeDisc(plot);
  const [px, py] = plot.back(place);
  return [(Math.atan2(px - x, y - py) * 180) / Math.PI, Math.hypot(px - x, py - y) / radius];
}

/** Return the scale of the radius, from all that is drawn. */
function makeRadius({ content, session }) {
  const arrays = content.lobes.flatMap(({ values, point_values: points = [] }) => [...values, ...points]);
  return makeValueScale(session.state["plots.scale"], arrays);
}

/** Draw the half disc: what was not measured is hatched. */
function drawDisc(context, plot, scale) {
  const { colours, content } = plot;
  const rim = Array.from({ length: 91 }, (_, k) => placePolar(plot, 2 * k - 90, 1));
  for (const { theta_o: angles, known } of content.lobes) {
    context.fillStyle = makeHatch(context, colours("bars"));
    for (const [from, to] of listGaps(known)) {
      const low = from === 0 ? -90 : angles[from];
      const high = to === known.length - 1 ? 90 : angles[to];
      context.beginPath();
      context.moveTo(...placePolar(plot, 0, 0));
      for (let step = 0; step <= 30; step++) context.lineTo(...placePolar(plot, low + (step / 30) * (high - low), 1));
      context.fill();
    }
  }
  context.lineWidth = 1;
  context.strokeStyle = colours("line");
  for (let angle = -60; angle <= 60; angle += 30) {
    strokeLine(context, [placePolar(plot, angle, 0), placePolar(plot, angle, 1)]);
  }
  for (const [value] of scale.ticks) {
    strokeLine(context, rim.map((_, k) => placePolar(plot, 2 * k - 90, scale.place(value))));
  }
  context.strokeStyle = colours("edge");
  strokeLine(context, [...rim, rim[0]]);
}

/** Write the angles around the half disc, and the values below it. */
function writeDisc(context, plot, scale) {
  const { colours } = plot;
  context.fillStyle = colours("soft");
  context.textBaseline = "middle";
  for (let angle = -90; angle <= 90; angle += 30) {
    const [x, y] = placePolar(plot, angle, 1);
    const turn = (angle * Math.PI) / 180;
    context.textAlign = angle < 0 ? "right" : angle > 0 ? "left" : "center";
    context.fillText(`${Math.abs(angle)}°`, x + 6 * Math.sin(turn), y - 9 * Math.cos(turn));
  }
  context.textBaseline = "top";
  context.textAlign = "left";
  context.fillText(`${plot.content.cosine ? "BRDF × cos θo" : "BRDF"} [sr⁻¹], ${nameChannel(plot)}`, 8, 4);
  context.textAlign = "center";
  for (const [value, text] of scale.ticks) {
    const [x, y] = placePolar(plot, 90, scale.place(value));
    context.fillText(text, x, y + 4);
  }
}

/** Draw the light as an arrow to the centre, with a handle at its rim, and the mirror direction. */
function drawLight(context, plot) {
  const { colours, session } = plot;
  const theta = session.state["plots.theta_i"];
  const [start, end] = [placePolar(plot, -theta, 1), placePolar(plot, -theta, 0)];
  context.lineWidth = 1;
  context.strokeStyle = colours("soft");
  context.setLineDash([2, 4]);
  strokeLine(context, [end, placePolar(plot, theta, 1)]);
  context.setLineDash([]);
  context.lineWidth = 1.5;
  context.strokeStyle = colours("ink");
  strokeLine(context, [start, end]);
  const angle = Math.atan2(end[1] - start[1], end[0] - start[0]);
  const side = (turn) => [end[0] - 9 * Math.cos(angle + turn), end[1] - 9 * Math.sin(angle + turn)];
  strokeLine(context, [side(0.4), end, side(-0.4)]);
  context.fillStyle = colours("paper");
  context.lineWidth = 2;
  context.beginPath();
  context.arc(...start, HANDLE, 0, 2 * Math.PI);
  context.fill();
  context.stroke();
}

/** Draw the lines and the points of one material. */
function drawLobe(context, plot, scale, number) {
  const { content, curves, colours } = plot;
  const lobe = content.lobes[number];
  const { colour, measured, twin } = curves[number];
  const several = lobe.values.length > 1;
  const tint = (channel) => (several ? CHANNEL_COLOURS[channel] : colour);
  (lobe.point_values || []).forEach((values, channel) => {
    context.fillStyle = tint(channel);
    context.globalAlpha = 0.45;
    fillDots(context, [...values].map((value, k) => placePolar(plot, lobe.points[k], scale.place(value))), 2);
    context.globalAlpha = 1;
  });
  lobe.values.forEach((values, channel) => {
    context.strokeStyle = tint(channel);
    context.lineWidth = measured ? 2.5 : 1.75;
    context.setLineDash(twin ? [7, 7] : several && !measured ? [7, 3] : []);
    strokeLine(context, [...values].map((value, k) => (
      lobe.known[k] && Number.isFinite(value) ? placePolar(plot, lobe.theta_o[k], scale.place(value)) : null)));
    context.setLineDash([]);
  });
  if (!lobe.sampler) return;
  context.strokeStyle = colours("ink"); // over a line that it may cover
  context.lineWidth = 1.5;
  context.setLineDash([1.5, 3]);
  strokeLine(context, [...lobe.sampler].map((value, k) => placePolar(plot, lobe.theta_o[k], scale.place(value))));
  context.setLineDash([]);
}

/** Return the index of the angle of view that is nearest to another one [degrees]. */
function findAngle({ theta_o: angles }, degrees) {
  let best = 0;
  for (let k = 1; k < angles.length; k++) {
    if (Math.abs(angles[k] - degrees) < Math.abs(angles[best] - degrees)) best = k;
  }
  return best;
}

/** Return whether a place is on the handle of the light. */
function isOnLight(place, plot) {
  const [x, y] = placePolar(plot, -plot.session.state["plots.theta_i"], 1);
  return Math.hypot(place[0] - x, place[1] - y) < 2 * HANDLE;
}

/** Return the angle between the plane of the views and that of the light, 0 to 90 [degrees]. */
function findPlane({ session: { state } }) {
  return Math.min(state["plots.phi_o"], 180 - state["plots.phi_o"]);
}

/** Return whether a selected pair of directions is near what the plot shows. */
function isShown({ theta_i: theta, plane }, plot) {
  const [near, across] = plot.content.reach;
  return Math.abs(theta - plot.session.state["plots.theta_i"]) <= near + 0.01
    && Math.abs(plane - findPlane(plot)) <= across + 0.01;
}

/** Draw the sector of the angles of view that are selected, and the selected samples near by. */
function drawSelectedViews(context, plot, scale) {
  const range = findRange(plot.session, "view");
  if (range) {
    const arc = Array.from({ length: 21 }, (_, k) => placePolar(plot, range[0] + (k / 20) * (range[1] - range[0]), 1));
    outlineRegion(context, plot, [placePolar(plot, 0, 0), ...arc]);
  }
  const cosine = (degrees) => (plot.content.cosine ? Math.cos((degrees * Math.PI) / 180) : 1);
  drawMarks(context, plot, listMarks(plot).filter((mark) => isShown(mark, plot)).map(
    ({ view, value }) => placePolar(plot, view, scale.place(value * cosine(view)))));
}

const POLAR = {
  draw(context, plot) {
    const scale = makeRadius(plot);
    drawDisc(context, plot, scale);
    orderCurves(plot.curves).forEach((number) => drawLobe(context, plot, scale, number));
    drawSelectedViews(context, plot, scale);
    writeDisc(context, plot, scale);
    drawLight(context, plot);
  },
  read(place, plot) {
    const [degrees] = readPolar(plot, place);
    if (Math.abs(degrees) > 90) return "";
    const parts = plot.content.lobes.map((lobe, number) => {
      const k = findAngle(lobe, degrees);
      const text = lobe.known[k] ? lobe.values.map((values) => writeValue(values[k])).join(" ") : "not measured";
      return `${plot.curves[number].name} ${text}`;
    });
    const side = degrees < -0.5 ? " on the light’s side" : "";
    return `θo ${writeAngle(Math.abs(degrees))}${side}, ${nameChannel(plot)}: ${parts.join(" · ")}`;
  },
  canGrab: isOnLight,
  grab(place, plot) {
    if (!isOnLight(place, plot)) return null;
    return (now) => {
      const [degrees] = readPolar(plot, now);
      const theta = clamp(Math.abs(degrees), 0, LARGEST_INCIDENCE);
      plot.session.drag({ "plots.theta_i": Math.round(2 * theta) / 2 });
    };
  },
  select(from, to, plot) {
    const [near, across] = plot.content.reach;
    const [low, high] = [from, to].map((place) => clamp(readPolar(plot, place)[0], -90, 90)).sort((a, b) => a - b);
    const [plane, theta] = [findPlane(plot), plot.session.state["plots.theta_i"]];
    return selectRanges([
      ["view", low - 0.5, high + 0.5], ["theta_i", theta - near, theta + near],
      ["plane", Math.max(plane - across, 0), plane + across],
    ]);
  },
  rows({ content, curves }) {
    const rows = [["material", "theta_o", "known", ...content.lobes[0].values.map((_, k) => `value_${k}`)]];
    content.lobes.forEach((lobe, number) => {
      lobe.theta_o.forEach((angle, k) => rows.push(
        [curves[number].name, angle, lobe.known[k], ...lobe.values.map((values) => values[k])]));
    });
    return rows;
  },
};
