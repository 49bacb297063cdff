// The box for the model: it is typed, or chosen from a list that each letter makes shorter.

let listCount = 0; // the parts of a list need names that are unique in the page

/** Make a box for a text with a list of [value, description] below it; a sum is typed with "+". */
function makeText(session, { name, label, choices = [] }) {
  const list = make("ul", { class: "options", role: "listbox", hidden: true, "aria-label": label });
  list.id = `brdfkit-list-${(listCount += 1)}`;
  const box = make("input", {
    type: "text", role: "combobox", spellcheck: false, autocomplete: "off",
    "aria-autocomplete": "list", "aria-expanded": "false", "aria-controls": list.id,
  });
  const opener = make("span", { class: "unfold", "aria-hidden": "true" }, "▾");
  let active = -1;
  let typed = false; // since the list was opened; before that, all entries are shown

  /** Return what comes before the model that is typed, such as "ggx+". */
  const start = () => (typed ? box.value.slice(0, box.value.lastIndexOf("+") + 1) : "");

  function fill() {
    const word = typed ? box.value.slice(start().length).trim().toLowerCase() : "";
    const found = choices.filter(([value, text]) => `${value} ${text}`.toLowerCase().includes(word));
    // What is typed whole comes first, then what begins so
    const rank = ([value]) => (value === word ? 0 : value.startsWith(word) ? 1 : 2);
    const sorted = typed ? found.sort((one, other) => rank(one) - rank(other)) : found;
    list.replaceChildren(...sorted.map(([value, text], k) => make("li", {
      role: "option", id: `${list.id}-${k}`, "aria-selected": "false",
      onpointerdown: (event) => event.preventDefault(), // the box keeps the focus
      onclick: () => choose(start() + value),
    }, make("b", {}, start() + value), " ", make("span", {}, text))));
    activate(typed && word && list.children.length ? 0 : -1);
  }
  function activate(k) {
    list.children[active]?.setAttribute("aria-selected", "false");
    active = k;
    const option = list.children[k];
    option?.setAttribute("aria-selected", "true");
    option?.scrollIntoView({ block: "nearest" });
    if (option) box.setAttribute("aria-activedescendant", option.id);
    else box.removeAttribute("aria-activedescendant");
  }
  function open(wanted) {
    if (wanted && list.hidden) fill();
    list.hidden = !wanted;
    box.setAttribute("aria-expanded", String(wanted));
    if (!wanted) activate(-1);
  }
  function choose(value) {
    typed = false;
    open(false);
    box.value = value.trim();
    if (box.value && box.value !== session.state[name]) session.change({ [name]: box.value });
    else show(session.state[name]);
  }
  function show(value) {
    if (!box.matches(":focus") || list.hidden) box.value = value;
  }

  box.addEventListener("click", () => {
    box.select();
    open(true);
  });
  opener.addEventListener("click", () => {
    box.focus();
    box.select();
    open(list.hidden);
  });
  box.addEventListener("input", () => {
    typed = true;
    list.hidden = false;
    box.setAttribute("aria-expanded", "true");
    fill();
  });
  box.addEventListener("blur", () => choose(typed ? box.value : session.state[name]));
  box.addEventListener("keydown", (event) => {
    const way = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    const count = list.children.length;
    if (way) {
      if (list.hidden) open(true);
      else if (count) activate((active + way + count + (active < 0 && way < 0 ? 1 : 0)) % count);
    } else if (event.key === "Enter") {
      if (!list.hidden && active >= 0) list.children[active].click();
      else choose(box.value);
    } else if (event.key === "Escape" && !list.hidden) {
      typed = false;
      open(false);
      show(session.state[name]);
      event.stopPropagation();
    } else return;
    event.preventDefault();
  });
  const row = makeRow("text", label, box);
  row.append(opener, list);
  return { row, show, input: box };
}
