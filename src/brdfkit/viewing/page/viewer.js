// The viewer: puts the parts together, and connects them to a model of anywidget's kind.

/** Return whether a key means nothing to the control that receives it, so that the picture may. */
function isFree(event) {
  const { key, target, defaultPrevented } = event;
  const takesLetters = takesText(target) || target.closest("select, dialog, [role=application]:not(.stage)");
  return /^[a-z]$/.test(key) && !takesLetters && !defaultPrevented;
}

/** Do what a key means to the whole viewer; the picture's own keys come first. */
function listenForKeys(session, root, stage, { pictureKeys, moveCross, switchWipe, help }) {
  root.addEventListener("keydown", (event) => {
    if (event.target !== stage && !isFree(event)) return;
    const plain = !event.ctrlKey && !event.metaKey && !event.altKey;
    if (pictureKeys.some((key) => key(event))) event.preventDefault();
    else if (plain && event.key === " ") {
      event.preventDefault();
      session.emit("pause");
    } else if (plain && event.key === "f") switchFullScreen(stage);
    else if (plain && event.key === "c") moveCross();
    else if (plain && event.key === "w") switchWipe();
    else if (plain && event.key === "u") session.command("undo");
  });
  root.addEventListener("keydown", (event) => {
    if (event.target.closest("dialog")) return;
    if (event.key === "?" && !takesText(event.target)) help();
    if (event.key === "Escape") session.emit("cancel");
  });
  listenForUndo(session, root);
  // A notebook has keys of its own, which are not meant while the focus is in the viewer
  root.addEventListener("keydown", (event) => event.stopPropagation());
}

/**
 * Ask for the value under the pointer while it is over the picture and no button is pressed.
 *
 * A new picture of a material has other values there, so that they are asked for again.
 */
function probePicture(session, stage, picture, probe) {
  let question = null; // about where the pointer is
  function leave() {
    question = null;
    probe(null);
    session.emit("left");
  }
  stage.addEventListener("pointermove", (event) => {
    const [x, y] = picture.locate(event);
    const inside = event.target === stage && x >= 0 && x <= 1 && y >= 0 && y <= 1;
    if (!inside) return leave();
    question = { type: "probe", x, y };
    if (!event.buttons) probe(question);
  });
  stage.addEventListener("pointerleave", leave);
  session.on("picture", () => question && uses(session, "light") && probe(question));
}

/**
 * Give the picture the focus that nothing else has, and the keys of nothing, so that they work: only
 * in the server's page, since a notebook has other things to focus. Returns a function that ends it.
 */
function keepFocus(session, root, stage) {
  const take = () => {
    if (document.activeElement === document.body) stage.focus({ preventScroll: true, focusVisible: false });
  };
  function pass(event) {
    if (event.target !== document.body || root.querySelector("dialog[open]")) return;
    take();
    if (!stage.dispatchEvent(new KeyboardEvent("keydown", event))) event.preventDefault();
  }
  session.on("open", take);
  root.addEventListener("click", take);
  document.addEventListener("keydown", pass);
  return () => document.removeEventListener("keydown", pass);
}

/** Tell the parts that draw on canvases when the colours of the style sheet change. */
function watchTheme(session) {
  const queries = ["(prefers-color-scheme: dark)", "(forced-colors: active)"]
    .map((text) => window.matchMedia(text));
  const tell = () => session.emit("theme");
  queries.forEach((query) => query.addEventListener("change", tell));
  return () => queries.forEach((query) => query.removeEventListener("change", tell));
}

/** Say hello to Python, with the state that the page has already, or that its address carries. */
function greet(session, stage) {
  const linked = session.model.address ? readAddress(location.hash) : null;
  session.send({ type: "hello", ...measurePixels(stage), state: nameState(session) || linked });
}

/**
 * Show a viewer in `el` for `model`, and return the function that removes it again.
 *
 * The contract is anywidget's, and the server's page fulfils it, too. The model of that page has
 * `address: true`, a `reconnect` function, and the events "lost" and "found".
 */
function render({ model, el }) {
  const session = createSession(model);
  const stage = make("div", {
    class: "stage", tabIndex: 0, role: "application", "aria-label": "Picture; ? shows its keys",
  });
  const root = make("div", {
    class: model.address ? "brdfkit-view whole" : "brdfkit-view",
    "data-lm-suppress-shortcuts": "true", // JupyterLab's keys
  });
  const help = () => showHelp(session, root);
  const probe = makeProbe(session);

  const turns = createTurns(session);
  const picture = createPicture(session, stage, turns);
  createOverlay(session, stage);
  createPreparation(session, stage, picture);
  createWipe(session, stage, picture);
  createCaptions(session, stage, picture);
  const zoomKey = createZoom(session, stage, picture);
  const paint = createPaint(session, stage, picture);
  const moves = makeCameraMoves(session, picture);
  followPointers(session, stage, moves);
  turnLight(session, stage);
  createLampMark(session, stage, picture);
  stage.append(makeViewButtons(session, stage, moves));
  createBallHandle(session, stage, picture);
  createNotices(session, stage);
  probePicture(session, stage, picture, probe);

  const slices = createSlices(session, probe);
  const transfer = createTransferEditor(session);
  const panels = make("div", { class: "panels" });
  const editors = {
    transfer: transfer.element, clip: createClipBox(session), camera: createTargetBoxes(session),
    audit: createAuditPanel(session), fit: createFitPanel(session, root),
  };
  const findControl = createPanels(session, panels, editors, new Set(TRANSFER_NAMES));
  markParameters(session, findControl);
  offerFixing(session, findControl);

  const pick = acceptFiles(session, root);
  createStart(session, stage, pick);
  const plots = createPlots(session);
  const views = make("div", { class: "views-area" }, stage, slices.element, plots.element);
  root.append(
    createToolbar(session, pick, paint.button, help),
    make("div", { class: "main-area" }, views, panels),
    createStatus(session),
  );
  el.append(root);

  listenForKeys(session, root, stage, {
    pictureKeys: [makeCameraKeys(session, moves), paint.key, makeLightKeys(session), zoomKey, turns.key],
    moveCross: makeCrossKey(session), switchWipe: makeWipeSwitch(session), help,
  });
  session.on("redraw", picture.draw);
  session.on("file", download);
  session.on("text", (content) => showText(root, content));
  session.on("ask_raw", (content) => askRaw(session, root, content));

  const lose = () => session.emit("lost");
  const find = () => greet(session, stage);
  model.on("lost", lose);
  model.on("found", find);

  const stops = [
    watchSize(session, stage, find, picture.draw), watchVisibility(session, stage),
    watchTheme(session), turns.stop, slices.stop, transfer.stop, plots.stop,
    ...(model.address ? [keepAddress(session), keepFocus(session, root, stage)] : []),
  ];
  return () => {
    stops.forEach((stop) => stop());
    model.off?.("lost", lose);
    model.off?.("found", find);
    session.stop();
    root.remove();
  };
}

export default { render };
