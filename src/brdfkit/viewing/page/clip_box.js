// The clipping box: for each axis two sliders with number boxes, from 0 to 1 of the volume.

const THINNEST_CLIP = 0.01; // share of an axis that stays between its two ends

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

/** Make the control of one end of an axis: `end` 0 or 1, `axis` 0 to 2. */
function makeClipEnd(session, label, end, axis) {
  // A slider changes one name of a session; here that name stands for one number in "clip"
  const within = (how) => ({ [label]: value }) => {
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
      return { [label]: session.state.clip[end][axis] };
    },
  };
  const { row, show } = makeSlider(part, { name: label, label, low: 0, high: 1, step: 0.01 });
  return { row, show: () => show(session.state.clip[end][axis]) };
}
