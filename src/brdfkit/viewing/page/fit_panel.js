// The fit of the model that is shown: its button, how good it is, and the table of errors.

/** Make a cell of a table. */
function makeCell(tag, text, properties = {}) {
  return make(tag, properties, text);
}

/** Make the table of errors: a row for each fit, and one for the noise of the measurement. */
function makeErrorTable({ columns, rows }) {
  const head = make("tr", {}, makeCell("th", "error", { scope: "col" }),
    ...columns.map(([name, meaning]) => makeCell("th", name, { scope: "col", title: meaning })));
  const body = rows.map(({ name, cells, best }) => make("tr", {},
    makeCell("th", name, { scope: "row" }),
    ...cells.map((text, k) => makeCell("td", text, { class: best[k] ? "best" : "" }))));
  return make("table", { class: "errors" }, make("thead", {}, head), make("tbody", {}, ...body));
}

/** Make the part of a panel that fits; it hides where nothing can be fitted. */
function createFitPanel(session) {
  let fitting = false;
  const button = makeButton("Fit", () => {
    session.send({ type: fitting ? "cancel" : "fit" });
    show(!fitting);
  }, { class: "main" });
  const verdict = make("p", { class: "verdict" });
  const table = make("div", { class: "table" });
  const element = make("div", { class: "fit", hidden: true },
    make("div", { class: "tools" }, button, verdict), table);

  function show(now) {
    fitting = now;
    button.textContent = now ? "Cancel the fit" : "Fit";
    button.classList.toggle("main", !now);
  }
  session.on("open", () => {
    element.hidden = !uses(session, "fit");
    table.replaceChildren();
    show(false);
  });
  session.on("busy", ({ task, text }) => show(task === "fit" && Boolean(text)));
  session.on("fit", ({ text, notes }) => {
    verdict.textContent = [text, ...notes].filter(Boolean).join(" ");
  });
  session.on("errors", (content) => table.replaceChildren(makeErrorTable(content)));
  return element;
}
