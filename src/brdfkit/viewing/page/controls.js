// Builds the panels and their controls from the description that Python sends.

const LOG_STEPS = 400; // places of a slider whose scale is logarithmic

/**
 * Return how a control's value and the place of its slider belong together.
 *
 * The places of a logarithmic scale are the indices of a list of values, which holds no value
 * twice: so each press of an arrow key changes whole numbers, too.
 */
function makeScale({ low = 0, high = 1, step, log }) {
  if (!log) {
    const itself = (value) => value;
    return { low, high, step: step || (high - low) / 200, toPlace: itself, toValue: itself };
  }
  const round = (value) => (step >= 1 ? step * Math.round(value / step) : roundNumber(value));
  const shares = Array.from({ length: LOG_STEPS + 1 }, (_, k) => k / LOG_STEPS);
  const values = [...new Set(shares.map((share) => round(low * (high / low) ** share)))];
  const toPlace = (value) => {
    const above = values.findIndex((other) => other >= value);
    return above < 0 ? values.length - 1 : above;
  };
  return { low: 0, high: values.length - 1, step: 1, toPlace, toValue: (place) => values[place] };
}

/** Return the number in a box for numbers alone, or null while it is not one that the box allows. */
function readNumber(box) {
  const { badInput, rangeOverflow, rangeUnderflow } = box.validity;
  return box.value === "" || badInput || rangeOverflow || rangeUnderflow ? null : Number(box.value);
}

/** Make a slider with a number box; both change `control.name` in the session. */
function makeSlider(session, control, scale = makeScale(control)) {
  const { name, label, unit = "" } = control;
  const range = make("input", { type: "range", min: scale.low, max: scale.high, step: scale.step });
  const number = makeNumberBox(session, control);
  let byKey = false;
  range.addEventListener("keydown", () => (byKey = true));
  range.addEventListener("pointerdown", () => (byKey = false));
  range.addEventListener("input", () => {
    const changes = { [name]: scale.toValue(Number(range.value)) };
    // Keys have no release that ends a drag: a held key is one step of undo
    if (byKey) session.nudge(changes);
    else session.drag(changes);
  });
  range.addEventListener("change", () => byKey || session.finish());
  function show(value) {
    range.value = scale.toPlace(value);
    range.setAttribute("aria-valuetext", `${roundNumber(value)} ${unit}`.trim());
    number.show(value);
  }
  const row = make("div", { class: "control slider" },
    make("label", {}, make("span", { class: "name" }, label), range), number.box,
    make("span", { class: "unit" }, unit), make("span", { class: "extras" }), number.note);
  /** Return how far along the slider a value is, 0 to 1. */
  const place = (value) => clamp((scale.toPlace(value) - scale.low) / (scale.high - scale.low), 0, 1);
  return { row, show, input: range, place };
}

/** Make a menu of choices. */
function makeChoice(session, { name, label, choices = [] }) {
  const select = make("select", {
    onchange: () => session.change({ [name]: choices[select.selectedIndex][0] }),
  }, ...choices.map(([, text]) => make("option", {}, text)));
  const show = (value) => (select.selectedIndex = choices.findIndex(([own]) => equal(own, value)));
  return { row: makeRow("choice", label, select), show, input: select };
}

/** Make a box to tick. */
function makeFlag(session, { name, label }) {
  const box = make("input", { type: "checkbox", onchange: () => session.change({ [name]: box.checked }) });
  const row = make("div", { class: "control flag" },
    make("label", {}, box, make("span", { class: "name" }, label)));
  return { row, show: (value) => (box.checked = Boolean(value)), input: box };
}

/** Make a colour well. */
function makeColour(session, { name, label }) {
  const well = make("input", {
    type: "color",
    oninput: () => session.drag({ [name]: well.value }),
    onchange: () => session.finish(),
  });
  return { row: makeRow("colour", label, well), show: (value) => (well.value = value), input: well };
}

/** Make a box for a few words. */
function makeWords(session, { name, label }) {
  const box = make("input", {
    type: "text", spellcheck: false, autocomplete: "off", onchange: () => session.change({ [name]: box.value.trim() }),
  });
  return { row: makeRow("words", label, box), show: (value) => (box.value = value), input: box };
}

/** Put a label before an input. */
function makeRow(kind, label, input) {
  return make("div", { class: `control ${kind}` },
    make("label", {}, make("span", { class: "name" }, label), input));
}

const CONTROL_MAKERS = {
  slider: makeSlider, choice: makeChoice, flag: makeFlag, colour: makeColour, text: makeText,
  words: makeWords,
};

/**
 * Let a button, a double click on a control's label, and Delete, set it to its default.
 *
 * Only a slider has the button, while its value is another one. Returns a function that shows it.
 */
function offerDefault(session, control, row) {
  if (control.default === undefined) return () => {};
  const restore = () => session.change({ [control.name]: control.default });
  row.querySelector(".name").addEventListener("dblclick", restore);
  row.addEventListener("keydown", (event) => {
    if (event.key === "Delete" && !takesText(event.target)) restore();
  });
  const extras = row.querySelector(".extras");
  if (!extras) return () => {};
  const value = `${writeNumber(control.default)} ${control.unit || ""}`.trim();
  const button = makeButton("↺", restore, {
    class: "restore", title: `Back to ${value}`, "aria-label": `${control.label} back to ${value}`,
  });
  extras.prepend(button);
  return (now) => button.classList.toggle("unneeded", now === control.default);
}

/**
 * Return whether a control's condition, `when`, holds in a state.
 *
 * What is asked of the renderer may as well hold for the second one, right of the wipe.
 */
function isWanted({ when }, state) {
  return Object.entries(when || {}).every(([name, values]) => {
    const own = name === "renderer" ? [state.renderer, state.second] : [state[name]];
    return values.some((value) => own.some((other) => equal(value, other)));
  });
}

/**
 * Keep the panels in `element` as Python describes them.
 *
 * `editors` maps a panel's name to an element with a richer view of the panel's values, which
 * comes first in it; `edited` are the names that such views change, so that no control repeats
 * them. Panels of editors that Python does not mention are not shown. Returns a function that
 * gives the parts of a control by its name.
 */
function createPanels(session, element, editors, edited) {
  let shown = []; // of [control, its parts]
  const opened = new Map(); // what the user opened and closed outlasts a new volume

  function makePanel({ name, label, open }) {
    const rows = shown.filter(([control]) => control.panel === name).map(([, parts]) => parts.row);
    const details = make("details", { class: "panel", open: opened.get(name) ?? Boolean(open) },
      make("summary", {}, label),
      make("div", { class: "rows" }, ...(editors[name] ? [editors[name]] : []), ...rows));
    details.addEventListener("toggle", () => opened.set(name, details.open));
    return details;
  }

  function build({ panels = [], controls = [] }) {
    const focused = shown.find(([, { row }]) => row.matches(":focus-within"))?.[0].name;
    shown = controls
      .filter(({ name, kind }) => !edited.has(name) && CONTROL_MAKERS[kind])
      .map((control) => [control, CONTROL_MAKERS[control.kind](session, control)]);
    for (const [control, parts] of shown) {
      const { row, input } = parts;
      parts.showDefault = offerDefault(session, control, row);
      if (!control.help) continue;
      row.title = control.help;
      input.setAttribute("aria-description", control.help);
    }
    const active = element.querySelector(":focus");
    element.replaceChildren(...panels.map(makePanel));
    if (active && element.contains(active)) active.focus({ preventScroll: true }); // in an editor
    if (focused) find(focused)?.input.focus();
  }
  const find = (name) => shown.find(([control]) => control.name === name)?.[1];
  session.on("open", build);
  session.on("controls", build);

  session.on("state", (names) => {
    for (const [control, parts] of shown) {
      if (names.has(control.name)) {
        parts.show(session.state[control.name]);
        parts.showDefault(session.state[control.name]);
      }
      parts.row.hidden = !isWanted(control, session.state);
    }
    for (const panel of element.children) {
      const { children } = panel.lastElementChild;
      panel.hidden = [...children].every((child) => child.hidden);
    }
  });
  return find;
}
