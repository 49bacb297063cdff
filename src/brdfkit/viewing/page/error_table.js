// The table of errors of pins and fits under each loss, which its heads sort, and the dialog with all of it.

/** Make the square of a pin, in its colour and with its number; without a pin an empty place. */
function makeChip({ pin, colour }) {
  const chip = make("span", { class: "pin-chip" }, pin ? pin.replace(/\D/g, "") : "");
  chip.style.background = colour || "transparent";
  return chip;
}

/** Return rows in the order of a column (−1: their names); what has no value, as the noise, stays last. */
function sortRows(rows, { column, down }) {
  const sign = down ? -1 : 1;
  const compare = (one, other) => (column < 0
    ? one.name.localeCompare(other.name) : one.values[column] - other.values[column]);
  const [sorted, last] = [[], []];
  for (const row of rows) (isFloor(row) || (column >= 0 && row.values[column] === null) ? last : sorted).push(row);
  return [...sorted.sort((one, other) => sign * compare(one, other)), ...last];
}

/** Return whether a row of the table is that of the noise. */
function isFloor({ note }) {
  return note === undefined;
}

/**
 * Make the table of an "errors" message; `order` has the column that sorts it, and `down`.
 *
 * `shown` tells which columns it has; `sort(column)` is called by its heads.
 */
function makeErrorTable({ columns, rows }, order, shown, sort) {
  const head = (text, column, title) => make("th", {
    scope: "col", title,
    "aria-sort": order.column === column ? (order.down ? "descending" : "ascending") : "none",
  }, makeButton(text, () => sort(column)));
  const wanted = columns.map((_, k) => k).filter((k) => shown(columns[k]));
  const makeBodyRow = (row) => make("tr", { title: row.note ?? "What the noise of the measurement leaves to a perfect model." },
    make("th", { scope: "row" }, make("span", { class: "named" }, makeChip(row),
      make("span", {}, row.name, row.note?.startsWith("not") ? make("span", { class: "tied" }, " ≈") : ""))),
    ...wanted.map((k) => make("td", { class: row.best[k] ? "best" : "" }, row.cells[k])));
  return make("table", { class: "errors" },
    make("thead", {}, make("tr", {}, head("error", -1), ...wanted.map((k) => head(columns[k][0], k, columns[k][1])))),
    make("tbody", {}, ...sortRows(rows, order).map(makeBodyRow)));
}

/** Make a place for a table that its heads sort; returns it with `fill(content)`. */
function createErrorTable(shown) {
  const element = make("div", { class: "table" });
  let content = null;
  let order = null;

  function sort(column) {
    order = { column, down: order.column === column && !order.down };
    draw();
    const wanted = `th:nth-child(${[...element.querySelectorAll("thead th")].findIndex((th) => th.ariaSort !== "none") + 1}) button`;
    element.querySelector(`thead ${wanted}`)?.focus();
  }
  function draw() {
    const rows = content.rows.length ? [makeErrorTable(content, order, shown, sort)] : [];
    const findHeads = () => [...element.querySelectorAll("thead button")];
    const focused = findHeads().findIndex((head) => head.matches(":focus"));
    element.replaceChildren(...rows);
    findHeads()[focused]?.focus(); // new errors of a pin replace the head under the keyboard's focus
  }
  function fill(now) {
    const column = now.columns.findIndex(([name]) => name === now.loss);
    if (!order || content?.loss !== now.loss) order = { column, down: false };
    content = now;
    draw();
  }
  return { element, fill, clear: () => element.replaceChildren() };
}

/** Show the table with all losses and what each of them means, and offer to save it. */
function showAllErrors(session, root, content) {
  const table = createErrorTable(() => true);
  table.fill(content);
  const meanings = content.columns.map(([name, meaning]) =>
    make("div", {}, make("dt", {}, name), make("dd", {}, ...lowerIndices(meaning))));
  const notes = content.rows.filter(({ note }) => note?.startsWith("not"))
    .map((row) => make("p", {}, makeChip(row), `${row.name} is ${row.note}.`));
  const save = makeButton("Save as CSV", () => session.send({ type: "save", kind: "errors" }));
  const close = makeButton("Close", () => dialog.close(), { class: "main" });
  const dialog = openDialog(root, "Errors under every loss",
    make("p", {}, content.verdict), table.element, ...notes, make("dl", { class: "losses" }, ...meanings), makeAnswers(save, close));
  close.focus();
}
