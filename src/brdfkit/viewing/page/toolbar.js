// The toolbar: files, copies, history, pause and help.

/** Make a button that opens a list of buttons, which Escape or a click elsewhere closes. */
function makeMenu(label) {
  const list = make("div", { class: "list", hidden: true });
  const button = makeButton(label, () => open(list.hidden), { class: "opener", "aria-expanded": "false" });
  const element = make("div", { class: "menu" }, button, list);

  function open(wanted) {
    list.hidden = !wanted;
    button.setAttribute("aria-expanded", String(wanted));
    if (wanted) list.firstElementChild?.focus();
  }
  element.addEventListener("keydown", (event) => {
    const entries = [...list.children];
    const way = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (list.hidden) return;
    if (event.key === "Escape") {
      open(false);
      button.focus();
    } else if (way) {
      const k = entries.findIndex((entry) => entry.matches(":focus"));
      entries[(k + way + entries.length) % entries.length]?.focus();
    } else return;
    event.preventDefault();
    event.stopPropagation();
  });
  element.addEventListener("focusout", (event) => {
    if (!element.contains(event.relatedTarget)) open(false);
  });
  list.addEventListener("click", () => {
    open(false);
    button.focus();
  });
  return { element, button, fill: (...entries) => list.replaceChildren(...entries) };
}

/** Make the button that stops the rendering and lets it go on. */
function makePauseButton(session) {
  let paused = false;
  const button = makeButton("Pause", () => session.emit("pause"), { title: "Space" });
  session.on("open", ({ start }) => (button.hidden = Boolean(start)));
  session.on("pause", () => session.send({ type: "pause", paused: !paused }));
  session.on("progress", (progress) => {
    paused = Boolean(progress.paused);
    button.textContent = paused ? "Go on" : "Pause";
  });
  return button;
}

/** Make the toolbar; `pick` opens the file dialog, `paint` is a button, `help` opens the help. */
function createToolbar(session, pick, paint, help) {
  const save = makeMenu("Save");
  const copy = makeMenu("More");
  const group = (...buttons) => make("div", { class: "group" }, ...buttons);
  const title = make("span", { class: "title" });
  const open = makeButton("Open…", () => pick(), { class: "main" });
  session.on("open", (content) => {
    title.textContent = title.title = content.title || "";
    paint.hidden = !uses(session, "paint");
    save.element.hidden = Boolean(content.start);
    save.button.disabled = !content.saves?.length;
    save.fill(...(content.saves || []).map(({ kind, label }) =>
      makeButton(label, () => session.send({ type: "save", kind }))));
  });
  session.on("open", ({ copies = [] }) => {
    copy.element.hidden = !copies.length;
    copy.fill(...copies.map(([kind, label]) =>
      makeButton(label, () => session.send({ type: "copy", kind }))));
  });
  return make("div", { class: "toolbar", role: "group", "aria-label": "Files and history" },
    group(open, save.element),
    group(
      makeButton("Copy as Python", () => session.send({ type: "copy", kind: "python" })),
      makeButton("Copy as command", () => session.send({ type: "copy", kind: "command" })),
      copy.element,
    ),
    group(...makeHistoryButtons(session)),
    group(paint),
    group(makePauseButton(session), makeButton("Help", help, { title: "?" })),
    title);
}
