// Marks at the sliders of a model: its fitted values, and parameters that do nothing at the moment.

const THUMB = 16; // pixels: the middle of a slider's thumb stays half of it away from the ends

/** Put a mark at the fitted value of a slider, as wide as its standard error both ways. */
function placeMark({ row, place }, mark, [value, error]) {
  const [low, high] = [place(value - (error ?? 0)), place(value + (error ?? 0))];
  mark.style.left = `calc(${THUMB / 2}px + ${low} * (100% - ${THUMB}px))`;
  mark.style.width = `calc(${high - low} * (100% - ${THUMB}px))`;
  const spread = error === null ? "" : ` ± ${writeNumber(Number(error.toPrecision(2)))}`;
  row.dataset.fitted = `fitted: ${writeNumber(value)}${spread}`;
}

/** Keep the marks of all parameters; `find` gives the parts of a control by its name. */
function markParameters(session, find) {
  let marks = {}; // control's name → [fitted value, standard error or null]
  let idle = {}; // parameter's name → reason

  /** Return the names of the controls of a parameter, but not of those that tie or link it. */
  const controlsOf = (name) => session.description.controls
    .filter(({ kind }) => kind !== "flag").map((control) => control.name)
    .filter((own) => own === name || own.startsWith(`${name}.`));

  function describe({ row, input }, help) {
    const text = [help, row.dataset.fitted].filter(Boolean).join(" ");
    row.title = text;
    input.setAttribute("aria-description", text);
  }

  function showMarks() {
    for (const { name, help } of session.description?.controls || []) {
      const parts = find(name);
      parts?.row.querySelector(".mark")?.remove();
      if (!parts || !marks[name]) continue;
      const mark = make("span", { class: "mark", "aria-hidden": "true" }, make("span"));
      parts.row.append(mark);
      placeMark(parts, mark.firstChild, marks[name]);
      describe(parts, help);
    }
  }

  function showIdle(reasons) {
    for (const name of new Set([...Object.keys(idle), ...Object.keys(reasons)])) {
      const [first, ...others] = controlsOf(name).map(find).filter(Boolean);
      for (const { row } of first ? [first, ...others] : []) row.classList.toggle("idle", name in reasons);
      first?.row.querySelector(".reason")?.remove();
      if (first && reasons[name]) first.row.append(make("span", { class: "reason" }, reasons[name]));
    }
    idle = reasons;
  }

  session.on("picture", ({ overlay }) => {
    if (overlay?.idle && !equal(overlay.idle, idle)) showIdle(overlay.idle);
  });
  session.on("fit", (content) => {
    marks = content.marks;
    showMarks();
  });
  for (const type of ["open", "controls"]) {
    session.on(type, () => {
      idle = {};
      marks = {};
    });
  }
}
