// The point that the camera looks at and turns around: a number box for each of its coordinates.

/** Make the boxes of the state's "camera.target", [x, y, z] in the volume's unit. */
function createTargetBoxes(session) {
  const name = "camera.target";
  const boxes = ["x", "y", "z"].map((axis, k) => make("input", {
    type: "number", step: "any",
    oninput: () => {
      const value = readNumber(boxes[k]);
      if (value === null) return;
      session.nudge({ [name]: session.state[name].map((old, j) => (j === k ? value : old)) });
    },
    onchange: () => {
      session.finish();
      show();
    },
  }));
  const fields = make("div", { class: "fields" });
  const element = make("div", { role: "group", "aria-label": "Target", hidden: true }, fields);

  function show() {
    boxes.forEach((box, k) => {
      const value = roundNumber(session.state[name][k]);
      if (!(box.matches(":focus") && Number(box.value) === value)) box.value = value;
    });
  }
  session.on("open", ({ volume }) => {
    const step = chooseStep(0, session.state["camera.distance"] ?? 1);
    boxes.forEach((box) => (box.step = step));
    fields.replaceChildren(...boxes.map((box, k) => makeField(`Target ${"xyz"[k]}`, box, volume?.unit)));
  });
  session.on("state", (names) => {
    element.hidden = !session.state[name];
    if (names.has(name)) show();
  });
  return element;
}
