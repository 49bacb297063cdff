// Writes on the overlay of the picture: the ends and the lengths of the axes, and a bar of scale.

const LABEL_HEIGHT = 16; // pixels
const LABEL_GAP = 4; // pixels between two labels, at least
const BEST_EDGES = 2; // of the four along an axis, beside which its length may stand
const LONGEST_BAR = 120; // pixels
const NARROWEST_STAGE = 420; // pixels, below which the buttons leave no room for a bar

/**
 * Return a function that writes a text around a place, which it keeps on the canvas.
 *
 * It writes nothing, and returns false, where the text would lie over one that it has written.
 */
function createLabels(context) {
  const written = []; // of [x, y, half the width]
  const { clientWidth: right, clientHeight: bottom } = context.canvas;
  return (text, x, y) => {
    const half = context.measureText(text).width / 2;
    const own = [clamp(x, half + 4, right - half - 4), clamp(y, 10, bottom - VIEW_BUTTONS), half];
    const overlaps = ([otherX, otherY, otherHalf]) =>
      Math.abs(otherX - own[0]) < otherHalf + half + LABEL_GAP && Math.abs(otherY - own[1]) < LABEL_HEIGHT;
    if (written.some(overlaps)) return false;
    written.push(own);
    writeRimmed(context, text, own[0], own[1]);
    return true;
  };
}

/** Return the edges along an axis (0 to 2), the best for its length first: far out, low, in sight. */
function rankEdges(corners, axis, { clientWidth, clientHeight }) {
  const bit = AXIS_BITS[axis];
  const middle = findMiddle(corners);
  const score = ([from, to]) => {
    const [x, y] = findMiddle([corners[from], corners[to]]);
    const hidden = Math.max(-x, x - clientWidth, -y, y - clientHeight, 0);
    return Math.hypot(x - middle[0], y - middle[1]) + 0.4 * (y - middle[1]) - 4 * hidden;
  };
  return EDGES.filter(([from, to]) => from + bit === to).sort((one, other) => score(other) - score(one));
}

/** Write the length along each axis outside the box, beside the best edge that has room for it. */
function drawLengths(context, write, corners, lengths) {
  const middle = findMiddle(corners);
  lengths.forEach((text, axis) => {
    const edges = rankEdges(corners, axis, context.canvas).slice(0, BEST_EDGES);
    const gap = 8 + context.measureText(text).width / 2;
    edges.some((edge) => {
      const ends = edge.map((k) => corners[k]);
      if (Math.hypot(ends[0][0] - ends[1][0], ends[0][1] - ends[1][1]) < 30) return false; // seen end on
      const [x, y] = findMiddle(ends);
      const away = Math.hypot(x - middle[0], y - middle[1]) || 1;
      return write(text, x + (gap * (x - middle[0])) / away, y + (14 * (y - middle[1])) / away);
    });
  });
}

/** Write the names of the ends, such as L and R, in the middle of the faces. */
function drawEnds(write, corners, names) {
  names.forEach((name, k) => {
    const bit = AXIS_BITS[k >> 1];
    const face = corners.filter((_, corner) => Boolean(corner & bit) === (k % 2 === 1));
    const opposite = corners.filter((_, corner) => Boolean(corner & bit) !== (k % 2 === 1));
    const [x, y] = findMiddle(face);
    const [u, v] = findMiddle(opposite);
    const length = Math.hypot(x - u, y - v);
    if (length < 24) return; // the axis is seen end on
    write(name, x + (12 * (x - u)) / length, y + (12 * (y - v)) / length);
  });
}

/** Draw a bar of a round length at the lower right, as long as that is at the camera's target. */
function drawScale(context, pixel, unit) {
  const { clientWidth, clientHeight } = context.canvas;
  if (!unit || !(pixel > 0) || clientWidth < NARROWEST_STAGE) return;
  const most = LONGEST_BAR * pixel;
  const power = 10 ** Math.floor(Math.log10(most));
  const length = power * [5, 2, 1].find((factor) => factor * power <= most);
  const [right, y] = [clientWidth - 14.5, clientHeight - 12.5];
  const left = right - length / pixel;
  context.beginPath();
  context.moveTo(left, y - 5);
  context.lineTo(left, y);
  context.lineTo(right, y);
  context.lineTo(right, y - 5);
  strokeTwice(context, "#fff");
  writeRimmed(context, writeQuantity(length, unit), (left + right) / 2, y - 11);
}
