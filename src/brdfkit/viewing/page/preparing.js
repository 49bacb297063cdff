// Says that a picture is being prepared, as long as none or one of something else is shown.

/** Return the name of what a side is to show, as the menus have it. */
function nameRenderer(session, value) {
  if (value === "model") return session.state.model;
  const menu = session.description?.controls.find(({ name }) => name === "second");
  return (value && menu?.choices.find(([own]) => own === value)?.[1]) || "";
}

/** Return the sides of the wipe, 0 or 1, whose picture is missing or shows other settings. */
function listMissing({ state }, picture) {
  const sides = state.second ? [0, 1] : [0];
  return sides.filter((side) => {
    const { needs } = picture.shown[side] ?? {};
    return !needs || Object.entries(needs).some(([name, value]) => name in state && state[name] !== value);
  });
}

/**
 * Dim what is shown of something else, and write over it what is being prepared.
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
    stage.classList.toggle("prepares-all", missing.length > 1); // then the words are over the wipe
    session.emit("preparing", missing.length > 0);
  }

  session.on("progress", ({ paused }) => {
    stopped = Boolean(paused);
    show();
  });
  session.on("state", (names) => {
    const isShown = (name) => picture.shown.some((own) => own && name in own.needs);
    if (["renderer", "second"].some((name) => names.has(name)) || [...names].some(isShown)) stopped = false;
    show();
  });
  session.on("drawn", show);
}
