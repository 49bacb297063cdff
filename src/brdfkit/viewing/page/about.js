// The dialog about a model: its formula, its parameters and the works that describe it.

/** Return the parts of a text in which k_d has a lowered d, and θ_h a lowered h. */
function lowerIndices(text) {
  const parts = text.split(/_(\w+)/);
  return parts.map((part, k) => (k % 2 ? make("sub", {}, part) : part));
}

/** Make what the dialog says about one model. */
function describeModel({ name, title, sentence, formula, texts, parameters, references }) {
  const rows = parameters.map(([symbol, own, bounds, meaning]) => make("tr", {},
    make("th", { scope: "row" }, ...lowerIndices(symbol)), make("td", {}, make("code", {}, own)),
    make("td", {}, bounds), make("td", {}, meaning)));
  const works = references.map(({ text, link }) => make("li", {}, text,
    ...(link ? [". ", make("a", { href: link, target: "_blank", rel: "noreferrer" }, link)] : [])));
  return make("section", { class: "about" },
    make("h3", {}, title, " ", make("code", {}, name)),
    make("p", {}, sentence),
    ...(formula.length ? [make("pre", { class: "formula" }, ...lowerIndices(formula.join("\n")))] : []),
    ...texts.map((text) => make("p", {}, ...lowerIndices(text))),
    make("table", {}, make("thead", {}, make("tr", {},
      ...["symbol", "name", "from … to", "meaning"].map((head) => make("th", { scope: "col" }, head)))),
    make("tbody", {}, ...rows)),
    ...(works.length ? [make("ul", {}, ...works)] : []));
}

/** Show the page of each model that is shown. */
function showAbout(root, { models }) {
  const title = `About ${models.map(({ name }) => name).join(" and ")}`;
  const close = makeButton("Close", () => dialog.close(), { class: "main" });
  const pages = make("div", { class: "scroll", tabIndex: 0, role: "region", "aria-label": title },
    ...models.map(describeModel));
  const dialog = openDialog(root, title, pages, makeAnswers(close));
  close.focus();
}
