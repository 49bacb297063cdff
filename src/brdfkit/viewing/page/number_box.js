// The number boxes of sliders: what may be typed, how arrow keys count, and what is said of the rest.

/** Return a round step for a number box, about a hundredth of the way from `low` to `high`. */
function chooseStep(low, high) {
  return 10 ** Math.round(Math.log10((high - low) / 100) - 0.2);
}

/** Return the number that a text says, with a decimal point or comma, or null if it says none. */
function parseNumber(text) {
  const plain = text.trim().replace(",", ".").replace("−", "-");
  const number = Number(plain);
  return /^[-+.\d]/.test(plain) && Number.isFinite(number) ? number : null;
}

/**
 * Make the number box of a control, and the note that says why it shows another number than typed.
 *
 * It is a box for text, because browsers do not let a comma into one for numbers, and undo in it what
 * was typed long ago. The value changes while a number within the bounds is typed.
 */
function makeNumberBox(session, { name, label, low, high, step, log, unit = "" }) {
  const note = make("span", { class: "limits", role: "status" });
  const box = make("input", {
    type: "text", inputmode: "decimal", role: "spinbutton", autocomplete: "off", spellcheck: false,
    "aria-label": unit ? `${label} [${unit}]` : label, "aria-valuemin": low, "aria-valuemax": high,
  });
  const count = step || chooseStep(low, log ? 10 * low : high);
  const write = () => (box.value = roundNumber(session.state[name]));

  box.addEventListener("input", () => {
    note.textContent = "";
    const value = parseNumber(box.value);
    if (value !== null && value === clamp(value, low, high)) session.nudge({ [name]: value });
  });
  box.addEventListener("change", () => {
    const value = parseNumber(box.value);
    const text = box.value.trim();
    const allowed = value === null ? null : clamp(value, low, high);
    if (allowed !== null && allowed !== value) session.nudge({ [name]: allowed });
    session.finish();
    write();
    if (allowed === value && value !== null) return;
    const bounds = [low, high].map((end) => writeQuantity(end, unit)).join(" and ");
    if (value !== null) note.textContent = `${label} is between ${bounds}.`;
    else if (text) note.textContent = `“${text.slice(0, 20)}” is no number.`;
  });
  box.addEventListener("keydown", (event) => {
    const way = { ArrowUp: 1, ArrowDown: -1 }[event.key];
    const isUndo = (event.ctrlKey || event.metaKey) && event.key.toLowerCase() === "z";
    if (way) {
      session.nudge({ [name]: roundNumber(clamp(session.state[name] + way * count, low, high)) });
      write();
    } else if (isUndo && !isCommitted()) {
      event.stopPropagation(); // what was not taken over is no step of the page's undo
      note.textContent = "";
      write();
    } else return;
    event.preventDefault();
  });

  /** Return whether the box shows the value, perhaps in other words. */
  function isCommitted() {
    const value = parseNumber(box.value);
    return value === session.state[name] || value === roundNumber(session.state[name]);
  }

  let last; // the value that was shown
  function show(value) {
    if (value !== last) note.textContent = "";
    last = value;
    box.setAttribute("aria-valuenow", roundNumber(value));
    const typing = box.matches(":focus") && parseNumber(box.value) === value;
    if (!typing) write();
  }
  return { box, note, show };
}
