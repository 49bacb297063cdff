// Draws over the picture: the box of the volume, the names of its axes, its lengths.

// The corners of the box come in the order of the bits x, y, z: corner 101b = 5 is at the end of x
// and z, and at the start of y. Edges join corners that differ in one bit.
const AXIS_BITS = [4, 2, 1];
const EDGES = AXIS_BITS.flatMap((bit) =>
  [0, 1, 2, 3, 4, 5, 6, 7].filter((k) => !(k & bit)).map((k) => [k, k | bit]));

const BOX_COLOURS = ["rgb(255 255 255 / 80%)", "rgb(255 255 255 / 45%)"]; // near and far edges
const DIM_COLOURS = ["rgb(255 255 255 / 35%)", "rgb(255 255 255 / 25%)"];
const VIEW_BUTTONS = 46; // pixels at the bottom, where no text is
const CLIP_COLOURS = ["rgb(255 210 74 / 95%)", "rgb(255 210 74 / 50%)"];

/** Return the middle of some corners, [x, y, depth]. */
function findMiddle(corners) {
  return [0, 1, 2].map((k) => corners.reduce((sum, corner) => sum + corner[k], 0) / corners.length);
}

/** Return the edges that start at the farthest corner, the hidden ones of a box. */
function findFarEdges(corners) {
  const farthest = corners.reduce((far, corner, k) => (corner[2] > corners[far][2] ? k : far), 0);
  return new Set(EDGES.filter((edge) => edge.includes(farthest)));
}

/** Return the edge along an axis (0 to 2) that is best for a length: far out and low, but in sight. */
function chooseEdge(corners, axis, { clientWidth, clientHeight }) {
  const bit = AXIS_BITS[axis];
  const middle = findMiddle(corners);
  const score = ([from, to]) => {
    const [x, y] = findMiddle([corners[from], corners[to]]);
    const hidden = Math.max(-x, x - clientWidth, -y, y - clientHeight, 0);
    return Math.hypot(x - middle[0], y - middle[1]) + 0.4 * (y - middle[1]) - 4 * hidden;
  };
  const along = EDGES.filter(([from, to]) => from + bit === to);
  return along.reduce((best, edge) => (score(edge) > score(best) ? edge : best));
}

/**
 * Return the corners on the screen of a part of the box, such as [[0, 0, 0], [1, 0.5, 1]].
 *
 * A place times its depth is linear in the place in space, which a perspective is not by itself.
 */
function findPartCorners(corners, [low, high]) {
  const weigh = ([x, y, depth]) => [x * depth, y * depth, depth];
  const [origin, ...ends] = [corners[0], ...AXIS_BITS.map((bit) => corners[bit])].map(weigh);
  return corners.map((_, corner) => {
    const shares = AXIS_BITS.map((bit, axis) => (corner & bit ? high : low)[axis]);
    const [x, y, depth] = origin.map(
      (start, k) => shares.reduce((sum, share, axis) => sum + share * (ends[axis][k] - start), start),
    );
    return [x / depth, y / depth, depth];
  });
}

/** Return whether a clipping box cuts something off. */
function isClipped(clip) {
  return Boolean(clip) && (clip[0].some((share) => share > 0) || clip[1].some((share) => share < 1));
}

/** Put the overlay on a stage; it follows the picture that is shown, not the newest state. */
function createOverlay(session, stage) {
  const canvas = make("canvas", { class: "overlay", "aria-hidden": "true" });
  stage.append(canvas);

  function draw(picture) {
    const context = startDrawing(canvas);
    const overlay = picture.described?.overlay;
    const { state } = session;
    if (!overlay?.corners?.length) return;
    const { x, y, width, height } = picture.place;
    const corners = overlay.corners.map(([u, v, depth]) => [x + u * width, y + v * height, depth]);
    if (corners.some(([, , depth]) => !(depth > 0))) return; // the camera is inside the box
    context.font = readFont(stage, 12);
    if (state["show.box"] !== false) {
      const clipped = isClipped(state.clip);
      if (clipped) drawBox(context, findPartCorners(corners, state.clip), CLIP_COLOURS);
      drawBox(context, corners, clipped ? DIM_COLOURS : BOX_COLOURS);
    }
    if (state["show.axes"] !== false) {
      const { size = [], ends = [] } = overlay;
      // Axes whose ends have no names are named with their lengths
      const named = size.map((length, axis) => `${"xyz"[axis]} ${length}`);
      drawLengths(context, corners, ends.length ? size : named);
      drawEnds(context, corners, ends);
    }
  }
  session.on("drawn", draw);
  session.on("state", (names) => {
    if (["show.box", "show.axes", "clip"].some((name) => names.has(name))) session.emit("redraw");
  });
}

/** Stroke a path twice, dark below light, so that it shows on every picture. */
function strokeTwice(context, light) {
  context.lineWidth = 3;
  context.strokeStyle = "rgb(0 0 0 / 35%)";
  context.stroke();
  context.lineWidth = 1;
  context.strokeStyle = light;
  context.stroke();
}

/** Draw the edges of a box, the far ones dashed; `colours` are those of near and far edges. */
function drawBox(context, corners, [near, dim]) {
  const far = findFarEdges(corners);
  for (const edge of EDGES) {
    const [from, to] = edge.map((k) => corners[k]);
    context.setLineDash(far.has(edge) ? [3, 5] : []);
    context.beginPath();
    context.moveTo(from[0], from[1]);
    context.lineTo(to[0], to[1]);
    strokeTwice(context, far.has(edge) ? dim : near);
  }
  context.setLineDash([]);
}

/** Write a text with a dark rim, in the middle of a place that is kept on the canvas. */
function writeOver(context, text, x, y) {
  const half = context.measureText(text).width / 2;
  const right = context.canvas.clientWidth;
  const bottom = context.canvas.clientHeight;
  context.textAlign = "center";
  context.textBaseline = "middle";
  context.lineJoin = "round";
  context.lineWidth = 3;
  context.strokeStyle = "rgb(0 0 0 / 65%)";
  context.fillStyle = "#fff";
  const place = [clamp(x, half + 4, right - half - 4), clamp(y, 10, bottom - VIEW_BUTTONS)];
  context.strokeText(text, ...place);
  context.fillText(text, ...place);
}

/** Write the length along each axis beside an edge, outside the box. */
function drawLengths(context, corners, lengths) {
  const middle = findMiddle(corners);
  lengths.forEach((text, axis) => {
    const ends = chooseEdge(corners, axis, context.canvas).map((k) => corners[k]);
    const [x, y] = findMiddle(ends);
    if (Math.hypot(ends[0][0] - ends[1][0], ends[0][1] - ends[1][1]) < 30) return; // seen end on
    const away = Math.hypot(x - middle[0], y - middle[1]) || 1;
    const gap = 8 + context.measureText(text).width / 2;
    writeOver(context, text, x + (gap * (x - middle[0])) / away, y + (14 * (y - middle[1])) / away);
  });
}

/** Write the names of the ends, such as L and R, in the middle of the faces. */
function drawEnds(context, corners, names) {
  names.forEach((name, k) => {
    const bit = AXIS_BITS[k >> 1];
    const face = corners.filter((_, corner) => Boolean(corner & bit) === (k % 2 === 1));
    const opposite = corners.filter((_, corner) => Boolean(corner & bit) !== (k % 2 === 1));
    const [x, y] = findMiddle(face);
    const [u, v] = findMiddle(opposite);
    const length = Math.hypot(x - u, y - v);
    if (length < 24) return; // the axis is seen end on
    writeOver(context, name, x + (12 * (x - u)) / length, y + (12 * (y - v)) / length);
  });
}
