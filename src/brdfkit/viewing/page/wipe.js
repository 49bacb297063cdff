// The line between two pictures, with a handle that is dragged or moved by the arrow keys.

const WIPE_STEP = 0.02; // for a press of an arrow key

/** Put the wipe on a stage. It is there if the state has a second picture. */
function createWipe(session, stage, picture) {
  const handle = make("div", {
    class: "wipe", tabIndex: 0, role: "slider", hidden: true,
    "aria-label": "Wipe between the two pictures",
    "aria-valuemin": "0", "aria-valuemax": "100", "aria-orientation": "horizontal",
  }, make("span", { class: "grip", "aria-hidden": "true" }));
  const names = ["left", "right"].map((side) => make("span", { class: `side ${side}`, "aria-hidden": "true" }));
  handle.append(...names);
  stage.append(handle);

  function place() {
    const { state } = session;
    handle.hidden = findComparison(state) !== "wipe" || !picture.parts.length;
    const { x, width } = picture.place;
    handle.style.left = `${clamp(x + (state.wipe ?? 0.5) * width, 0, stage.clientWidth)}px`;
    const percent = Math.round(100 * (state.wipe ?? 0.5));
    handle.setAttribute("aria-valuenow", percent);
    handle.setAttribute("aria-valuetext", `${percent} % of the first picture`);
    names.forEach((name, k) => {
      name.textContent = picture.shown[picture.parts[k]?.side ?? k]?.name ?? "";
    });
  }

  handle.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    event.stopPropagation();
    handle.setPointerCapture(event.pointerId);
  });
  handle.addEventListener("pointermove", (event) => {
    event.stopPropagation();
    if (!handle.hasPointerCapture(event.pointerId)) return;
    session.drag({ wipe: Math.round(1000 * clamp(picture.locate(event)[0], 0, 1)) / 1000 });
  });
  handle.addEventListener("lostpointercapture", session.finish);
  handle.addEventListener("dblclick", (event) => {
    event.stopPropagation();
    session.change({ wipe: 0.5 });
  });
  handle.addEventListener("keydown", (event) => {
    const { wipe } = session.state;
    const target = {
      ArrowLeft: wipe - WIPE_STEP, ArrowDown: wipe - WIPE_STEP, ArrowRight: wipe + WIPE_STEP,
      ArrowUp: wipe + WIPE_STEP, Home: 0, End: 1,
    }[event.key];
    if (target === undefined) return;
    event.preventDefault();
    event.stopPropagation();
    session.nudge({ wipe: Math.round(1000 * clamp(target, 0, 1)) / 1000 });
  });
  session.on("drawn", place);
}

/** Switch the second picture on and off: the key w of the picture. */
function makeWipeSwitch(session) {
  let last = "";
  return () => {
    const control = session.description?.controls.find(({ name }) => name === "second");
    if (!control) return;
    const { second, renderer } = session.state;
    if (second) last = second;
    const other = control.choices.map(([value]) => value).find((value) => value && value !== renderer);
    session.change({ second: second ? "" : last || other });
  };
}
