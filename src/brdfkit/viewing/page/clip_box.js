// The clipping box: for each axis two sliders with number boxes, in the volume's unit.

const THINNEST_CLIP = 0.01; // share of an axis that stays between its two ends
const CLIP_STEP = 0.005; // of a slider, as a share of the axis

/** Make the editor of the state's "clip", [[x0, y0, z0], [x1, y1, z1]]. */
function createClipBox(session) {
  let ends = [];
  const whole = makeButton("Whole volume", () => session.change({ clip: [[0, 0, 0], [1, 1, 1]] }));
  const tools = make("div", { class: "tools" }, whole);
  const element = make("div", { class: "clip", hidden: true }, tools);
  session.on("open", ({ volume }) => {
    ends = (volume?.axis_names || []).flatMap((axis, k) => [
      makeClipEnd(session, `${axis} from`, 0, k), makeClipEnd(session, `${axis} to`, 1, k),
    ]);
    element.replaceChildren(...ends.map(({ row }) => row), tools);
  });
  session.on("state", (names) => {
    element.hidden = !session.state.clip;
    if (names.has("clip")) ends.forEach(({ show }) => show());
  });
  return element;
}

/**
 * Make the control of one end of an axis: `end` 0 or 1, `axis` 0 to 2.
 *
 * It shows the length from the start of the axis; the state holds its share of the whole axis.
 */
function makeClipEnd(session, label, end, axis) {
  const { size, spacing = [1, 1, 1], unit = "" } = session.description.volume;
  const length = size[axis] * spacing[axis];
  // A slider changes one name of a session; here that name stands for one number in "clip"
  const within = (how) => ({ [label]: place }) => {
    const value = place / length;
    const clip = session.state.clip.map((corner) => [...corner]);
    clip[end][axis] = end
      ? Math.max(value, clip[0][axis] + THINNEST_CLIP)
      : Math.min(value, clip[1][axis] - THINNEST_CLIP);
    session[how]({ clip });
  };
  const part = {
    drag: within("drag"),
    nudge: within("nudge"),
    finish: session.finish,
    get state() {
      return { [label]: length * session.state.clip[end][axis] };
    },
  };
  const scale = {
    low: 0, high: 1, step: CLIP_STEP,
    toPlace: (place) => place / length, toValue: (share) => share * length,
  };
  const high = Math.max(length, roundNumber(length)); // as the box shows it
  const { row, show } = makeSlider(part, { name: label, label, unit, low: 0, high }, scale);
  return { row, show: () => show(part.state[label]) };
}
