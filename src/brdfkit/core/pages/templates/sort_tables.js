// Sorts a table of the class "sortable" by the column whose head is pressed; once more turns the
// order round. What is no number stands last in a column of numbers, either way.

const text = (row, column) => row.cells[column].textContent.trim();

/** The order of two texts: of numbers by size; else by letters. */
function compare(a, b, numeric, turned) {
  if (!numeric) return turned * a.localeCompare(b, "en", { numeric: true });
  const [x, y] = [a, b].map((number) => parseFloat(number.replaceAll(",", "")));
  return Number.isNaN(x) - Number.isNaN(y) || turned * (x - y) || 0;
}

function sort(head) {
  const table = head.closest("table");
  const turned = head.ariaSort === "ascending" ? -1 : 1;
  const rows = [...table.tBodies[0].rows];
  const numeric = head.classList.contains("number");
  rows.sort((a, b) => compare(text(a, head.cellIndex), text(b, head.cellIndex), numeric, turned));
  table.tBodies[0].append(...rows);
  for (const other of head.parentNode.cells) other.removeAttribute("aria-sort");
  head.ariaSort = turned > 0 ? "ascending" : "descending";
}

for (const head of document.querySelectorAll(".sortable thead th:not(.pictured)")) {
  const button = document.createElement("button");
  button.append(...head.childNodes);
  button.addEventListener("click", () => sort(head));
  head.append(button);
}
