// The fit of the model that is shown, its pins, how good they are, and the table of errors.

/** Make the part of a panel that fits and pins; it has no Fit where nothing can be fitted. */
function createFitPanel(session, root) {
  let fitting = false;
  let errors = null;
  const button = makeButton("Fit", () => {
    session.send({ type: fitting ? "cancel" : "fit" });
    show(!fitting);
  }, { class: "main" });
  const all = makeButton("Fit all", () => {
    session.send({ type: "fit", all: true });
    show(true);
  });
  const pin = makeButton("Pin", () => session.send({ type: "pin" }), {
    title: "Keep this model with its values under a colour, to compare it with others",
  });
  const about = makeButton("About the model", () => session.send({ type: "about" }), {
    title: "Its formula, its parameters and the works that describe it",
  });
  session.on("about", (content) => showAbout(root, content));
  const preset = createPresets(session);
  const note = make("div", { class: "verdict" });
  const verdict = make("p", { class: "best", "aria-live": "polite" });
  const table = createErrorTable(([, , usual]) => usual);
  const more = make("div", { class: "tools", hidden: true },
    makeButton("All losses …", () => showAllErrors(session, root, errors)));
  const element = make("div", { class: "fit" },
    make("div", { class: "tools" }, preset, about), make("div", { class: "tools" }, button, all, pin), note,
    createPins(session), table.element, verdict, more);

  function show(now) {
    fitting = now;
    button.textContent = now ? "Cancel the fit" : "Fit";
    button.classList.toggle("main", !now);
    all.disabled = now;
  }
  session.on("open", () => {
    button.hidden = all.hidden = !uses(session, "fit");
    table.clear();
    verdict.textContent = "";
    more.hidden = true;
    show(false);
  });
  const nameAll = ({ fit_all: labels = [] }) => {
    all.title = `Fits and pins ${labels.join(", ")}: models that were given or looked at, or usual ones; fits with these settings are kept`;
  };
  session.on("open", nameAll);
  session.on("controls", nameAll);
  session.on("busy", ({ task, text }) => show(task === "fit" && Boolean(text)));
  session.on("fit", ({ text, notes }) => {
    const lines = [text, ...notes].filter(Boolean);
    note.replaceChildren(...lines.map((line) => make("p", {}, `${line[0].toUpperCase()}${line.slice(1)}.`)));
  });
  session.on("errors", (content) => {
    errors = content;
    table.fill(content);
    verdict.textContent = content.verdict;
    more.hidden = !content.rows.length;
  });
  return element;
}

/** Make the menu of presets: values of the model that is shown. */
function createPresets(session) {
  const menu = make("select", {
    "aria-label": "Values of the model",
    title: "Other values: those at first, or a fit to a material",
    onchange: () => {
      session.send({ type: "preset", name: menu.value });
      menu.selectedIndex = 0; // sliders may change the values at any time
    },
  });
  session.on("open", ({ presets_of_models: presets = [] }) => {
    menu.replaceChildren(make("option", { hidden: true, value: "-" }, "Values …"),
      ...presets.map(([value, text]) => make("option", { value }, text)));
    menu.selectedIndex = 0;
  });
  return menu;
}
