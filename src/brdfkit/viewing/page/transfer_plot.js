// Draws the plot of the transfer editor: histogram, opacity, colours and the ticks of its axes.

const PLOT_MARGIN = { left: 30, right: 10, top: 8, bottom: 34 };
const BAR_HEIGHT = 10; // of the bar of colours below the plot
const CURVE_STEPS = 256;
const MAP_SIZE = [128, 64]; // of the picture of bumps over values and gradients

/**
 * Return the rectangle of the plot on its canvas, which shows the part of an axis `from` … `to`.
 *
 * `across` gives the place of a share of the range of values, and `share` the share at a place.
 */
function findPlotArea(canvas, { from, to }) {
  const { left, right, top, bottom } = PLOT_MARGIN;
  const width = Math.max(canvas.clientWidth - left - right, 1);
  return {
    x: left, y: top, width, from, to,
    height: Math.max(canvas.clientHeight - top - bottom, 1),
    across: (share) => left + (width * (share - from)) / (to - from),
    share: (place) => from + ((place - left) / width) * (to - from),
  };
}

/**
 * Draw everything but the handles.
 *
 * `volume` and `histogram` are Python's; `joint` is the picture of the joint histogram or null;
 * `items` are points or bumps, and `kind` says what they mean; `axis` is the part of the values.
 */
function drawPlot(canvas, { kind, axis, items, selected, volume, histogram, joint }) {
  const context = startDrawing(canvas);
  const area = findPlotArea(canvas, axis);
  const colour = readColours(canvas);
  context.font = readFont(canvas, 11);
  context.fillStyle = colour("plot");
  context.fillRect(area.x, area.y, area.width, area.height);
  drawTicks(context, area, colour, volume, kind.flat);
  context.save();
  context.beginPath();
  context.rect(area.x, area.y, area.width, area.height);
  context.clip();
  if (kind.flat) {
    if (joint) drawJointHistogram(context, area, joint, colour("soft"));
    drawBumpMap(context, area, items);
    if (items[selected]) drawEllipse(context, area, items[selected], colour("ink"));
  } else {
    drawHistogram(context, area, histogram || [], colour("bars"));
    drawCurve(context, area, kind, items, colour("ink"));
  }
  context.restore();
  if (kind.flat) nameGradients(context, area, volume, colour("soft"));
  drawColourBar(context, area, kind, items, colour("line"));
}

/** Write that gradients go upwards, inside at the top of the plot. */
function nameGradients(context, area, { value_unit, unit }, ink) {
  const slope = value_unit && unit ? ` [${value_unit}/${unit}]` : "";
  context.fillStyle = ink;
  context.textAlign = "right";
  context.textBaseline = "top";
  context.fillText(`gradient${slope}`, area.x + area.width - 4, area.y + 4);
}

/** Draw the grid, and the numbers beside it. */
function drawTicks(context, area, colour, volume, flat) {
  const [least, most] = volume.range;
  const [low, high] = [area.from, area.to].map((share) => least + share * (most - least));
  context.strokeStyle = colour("line");
  context.fillStyle = colour("soft");
  context.lineWidth = 1;
  context.textBaseline = "middle";
  context.textAlign = "right";
  const top = flat ? volume.steepest : 1;
  for (const tick of chooseTicks(0, top, 3)) {
    const y = area.y + area.height * (1 - tick / top);
    context.strokeRect(area.x, Math.round(y) + 0.5, area.width, 0);
    context.fillText(writeNumber(tick), area.x - 4, y);
  }
  context.textBaseline = "top";
  context.textAlign = "center";
  const unit = volume.value_unit ? ` ${volume.value_unit}` : "";
  const room = (area.width / 70) | 0;
  const ticks = chooseTicks(low, high, Math.max(room, 2));
  ticks.forEach((tick, k) => {
    const x = area.x + (area.width * (tick - low)) / (high - low || 1);
    context.strokeRect(Math.round(x) + 0.5, area.y, 0, area.height);
    const text = writeNumber(tick) + (k === ticks.length - 1 ? unit : "");
    const half = context.measureText(text).width / 2;
    const end = area.x + area.width + PLOT_MARGIN.right;
    context.fillText(text, clamp(x, half, end - half - 1), area.y + area.height + BAR_HEIGHT + 9);
  });
}

/** Fill the histogram, its counts on a logarithmic scale up to the most that are shown. */
function drawHistogram(context, area, counts, colour) {
  const first = Math.floor(area.from * counts.length);
  const shown = counts.slice(first, Math.ceil(area.to * counts.length));
  const most = Math.log1p(Math.max(...shown, 1));
  const bottom = area.y + area.height;
  const edge = (k) => area.across((first + k) / counts.length);
  context.beginPath();
  context.moveTo(edge(0), bottom);
  shown.forEach((count, k) => {
    const y = bottom - (area.height * Math.log1p(count)) / most;
    context.lineTo(edge(k), y);
    context.lineTo(edge(k + 1), y);
  });
  context.lineTo(edge(shown.length), bottom);
  context.fillStyle = colour;
  context.fill();
}

/** Return the gradient of the transfer function's colours along the plot. */
function makeColourGradient(context, area, kind, items) {
  const gradient = context.createLinearGradient(area.x, 0, area.x + area.width, 0);
  for (let k = 0; k <= CURVE_STEPS; k += 2) {
    const share = area.from + (area.to - area.from) * (k / CURVE_STEPS);
    gradient.addColorStop(k / CURVE_STEPS, kind.evaluate(items, share)[0]);
  }
  return gradient;
}

/** Draw the curve of opacity, with the colours below it. */
function drawCurve(context, area, kind, items, ink) {
  const curve = new Path2D();
  for (let k = 0; k <= CURVE_STEPS; k++) {
    const place = area.x + (area.width * k) / CURVE_STEPS;
    curve.lineTo(place, area.y + area.height * (1 - kind.evaluate(items, area.share(place))[1]));
  }
  const below = new Path2D(curve);
  below.lineTo(area.x + area.width, area.y + area.height);
  below.lineTo(area.x, area.y + area.height);
  context.globalAlpha = 0.55;
  context.fillStyle = makeColourGradient(context, area, kind, items);
  context.fill(below);
  context.globalAlpha = 1;
  context.lineWidth = 1.5;
  context.strokeStyle = ink;
  context.stroke(curve);
}

/** Draw the bar of colours below the plot; two-dimensional bumps show those of all gradients. */
function drawColourBar(context, area, kind, items, line) {
  const y = area.y + area.height + 5;
  context.fillStyle = items.length ? makeColourGradient(context, area, kind, items) : line;
  context.fillRect(area.x, y, area.width, BAR_HEIGHT);
  context.strokeStyle = line;
  context.lineWidth = 1;
  context.strokeRect(area.x + 0.5, y + 0.5, area.width - 1, BAR_HEIGHT - 1);
}

/** Draw a picture of grey values in one ink, through the values as its opacity. */
function drawJointHistogram(context, area, joint, ink) {
  const layer = new OffscreenCanvas(joint.width, joint.height);
  const own = layer.getContext("2d");
  own.drawImage(joint, 0, 0);
  const pixels = own.getImageData(0, 0, joint.width, joint.height);
  for (let k = 0; k < pixels.data.length; k += 4) pixels.data[k + 3] = pixels.data[k];
  own.putImageData(pixels, 0, 0);
  own.globalCompositeOperation = "source-in";
  own.fillStyle = ink;
  own.fillRect(0, 0, joint.width, joint.height);
  const part = [area.from * joint.width, 0, (area.to - area.from) * joint.width, joint.height];
  context.drawImage(layer, ...part, area.x, area.y, area.width, area.height);
}

/** Draw bumps over values and gradients, as opaque as they are. */
function drawBumpMap(context, area, bumps) {
  const [width, height] = MAP_SIZE;
  const layer = new OffscreenCanvas(width, height);
  const own = layer.getContext("2d");
  const pixels = own.createImageData(width, height);
  for (let row = 0; row < height; row++) {
    for (let column = 0; column < width; column++) {
      const share = area.from + ((column + 0.5) / width) * (area.to - area.from);
      const [r, g, b, a] = blendBumps(bumps, share, 1 - (row + 0.5) / height);
      pixels.data.set([r, g, b, 255 * a], 4 * (row * width + column));
    }
  }
  own.putImageData(pixels, 0, 0);
  context.drawImage(layer, area.x, area.y, area.width, area.height);
}

/** Draw how wide and high a bump is: where it has fallen to 1/e of its opacity. */
function drawEllipse(context, area, { x, y, sx, sy }, ink) {
  context.beginPath();
  context.ellipse(
    area.across(x), area.y + (1 - y) * area.height,
    area.across(x + sx) - area.across(x), sy * area.height, 0, 0, 2 * Math.PI,
  );
  context.setLineDash([3, 3]);
  context.lineWidth = 1;
  context.strokeStyle = ink;
  context.stroke();
  context.setLineDash([]);
}
