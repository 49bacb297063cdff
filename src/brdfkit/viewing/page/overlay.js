// Draws over the picture: the box of the volume, its axes, and the part that the clipping leaves.

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
    context.font = readFont(stage, 12);
    if (state["show.axes"] !== false) {
      drawScale(context, overlay.across / Math.min(width, height), session.description.volume?.unit);
    }
    const corners = overlay.corners.map(([u, v, depth]) => [x + u * width, y + v * height, depth]);
    if (corners.some(([, , depth]) => !(depth > 0))) return; // the camera is inside the box
    if (state["show.box"] !== false) {
      const clipped = isClipped(state.clip);
      if (clipped) drawBox(context, findPartCorners(corners, state.clip), CLIP_COLOURS);
      drawBox(context, corners, clipped ? DIM_COLOURS : BOX_COLOURS);
    }
    if (state["show.axes"] !== false) {
      const { size = [], ends = [] } = overlay;
      // Axes whose ends have no names are named with their lengths
      const named = size.map((length, axis) => `${"xyz"[axis]} ${length}`);
      const write = createLabels(context);
      drawEnds(write, corners, ends);
      drawLengths(context, write, corners, ends.length ? size : named);
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

/** Write a text with a dark rim, so that it shows on every picture, around a place. */
function writeRimmed(context, text, x, y) {
  context.textAlign = "center";
  context.textBaseline = "middle";
  context.lineJoin = "round";
  context.lineWidth = 3;
  context.strokeStyle = "rgb(0 0 0 / 65%)";
  context.fillStyle = "#fff";
  context.strokeText(text, x, y);
  context.fillText(text, x, y);
}
