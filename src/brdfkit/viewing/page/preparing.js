// Says that a picture is being prepared, as long as none or one of another renderer is shown.

/** Return the label of a renderer, as the menus show it. */
function nameRenderer(session, value) {
  const menu = session.description?.controls.find(({ name }) => name === "second");
  return (value && menu?.choices.find(([own]) => own === value)?.[1]) || "";
}

/** Return the sides of the wipe, 0 or 1, at which the picture of the state's renderer is missing. */
function listMissing({ state }, picture) {
  const wanted = [state.renderer ?? "", ...(state.second ? [state.second] : [])];
  return [0, 1].filter((side) => side in wanted && picture.renderers[side] !== wanted[side]);
}

/**
 * Dim what is shown of another renderer, and write over it what is being prepared.
 *
 * Listeners to "preparing" hear whether something is. The style sheet shows both with a delay, so
 * that a picture that comes at once does not flicker.
 */
function createPreparation(session, stage, picture) {
  const veil = make("div", { class: "veil" });
  const text = make("p", { class: "hint", role: "status" }, "Waiting for the first picture …");
  stage.classList.add("prepares");
  stage.append(veil, text);
  let stopped = false; // after an error, or by the user

  function say(missing) {
    if (stopped || !missing.length) return "";
    const { renderer, second } = session.state;
    const names = missing.map((side) => nameRenderer(session, side ? second : renderer));
    return `Preparing ${names.filter(Boolean).join(" and ") || "the picture"} …`;
  }

  /** Put both over the sides that are missing, of which `wipe` divides the stage. */
  function place(missing) {
    const { x, width } = picture.place;
    const { wipe = 0.5 } = session.state;
    const edge = findComparison(session.state) === "wipe" ? clamp(x + wipe * width, 0, stage.clientWidth) : stage.clientWidth;
    for (const { style } of [veil, text]) {
      style.left = missing.includes(0) ? "0" : `${edge}px`;
      style.right = missing.includes(1) ? "0" : `${stage.clientWidth - edge}px`;
    }
  }

  function show() {
    if (!session.description) return;
    const missing = session.description.start ? [] : listMissing(session, picture);
    if (missing.length) place(missing);
    const words = say(missing);
    // Saying the same again would be announced again
    if (text.textContent !== words) text.textContent = words;
    stage.classList.toggle("prepares", Boolean(missing.length || words));
    session.emit("preparing", missing.length > 0);
  }

  session.on("progress", ({ paused }) => {
    stopped = Boolean(paused);
    show();
  });
  session.on("state", (names) => {
    if (names.has("renderer") || names.has("second")) stopped = false;
    show();
  });
  session.on("drawn", show);
}
