// The start: what an empty page says can be dropped on it, and what it offers by name.

/** Make a list of names that open something; those with a title show it after the name. */
function makeStartList(session, title, things) {
  const buttons = things.map(([name, text]) => make("li", {},
    makeButton(name.replaceAll("_", " "), () => {
      session.emit("busy", { text: `Opening ${name}`, fraction: null });
      session.send({ type: "load", name });
    }, { title: text })));
  return make("section", {}, make("h3", {}, title), make("ul", {}, ...buttons));
}

/** Fill the stage with the start while nothing is shown; `pick` opens the file dialog. */
function createStart(session, stage, pick) {
  const element = make("div", { class: "start", hidden: true });
  // The picture's gestures are not meant
  for (const type of ["pointerdown", "pointermove", "dblclick", "wheel", "keydown"]) {
    element.addEventListener(type, (event) => event.stopPropagation());
  }
  stage.append(element);

  session.on("open", ({ start }) => {
    element.hidden = !start;
    stage.classList.toggle("empty", Boolean(start));
    if (!start) return;
    const files = start.files.flatMap(([kind, formats]) =>
      [make("dt", {}, kind), make("dd", {}, formats)]);
    element.replaceChildren(
      make("div", { class: "target" },
        make("h2", {}, "Drop files here"),
        makeButton("Open…", () => pick(), { class: "main" }),
        make("dl", {}, ...files)),
      make("h2", {}, "Or begin with"),
      make("div", { class: "lists" },
        ...start.lists.map(([title, things]) => makeStartList(session, title, things))));
  });
}
