// Sorts the table by the column whose head is pressed; once more turns the order round.

const table = document.querySelector(".gallery");
const heads = [...table.tHead.rows[0].cells].slice(1); // the first column has pictures
const text = (row, column) => row.cells[column].textContent.trim();

/** The order of two texts: of numbers by size, with those that are none last; else by letters. */
function compare(a, b, numeric) {
  if (!numeric) return a.localeCompare(b, "en", { numeric: true });
  const [x, y] = [a, b].map((number) => (Number.isNaN(parseFloat(number)) ? Infinity : parseFloat(number)));
  return x === y ? 0 : x - y;
}

function sort(head) {
  const turned = head.ariaSort === "ascending" ? -1 : 1;
  const rows = [...table.tBodies[0].rows];
  const numeric = head.classList.contains("number");
  rows.sort((a, b) => turned * compare(text(a, head.cellIndex), text(b, head.cellIndex), numeric));
  table.tBodies[0].append(...rows);
  for (const other of heads) other.removeAttribute("aria-sort");
  head.ariaSort = turned > 0 ? "ascending" : "descending";
}

for (const head of heads) {
  const button = document.createElement("button");
  button.append(...head.childNodes);
  button.addEventListener("click", () => sort(head));
  head.append(button);
}
