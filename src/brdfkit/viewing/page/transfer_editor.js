// The editor of the transfer function: its plot, its handles, and the boxes of the selected one.

const NUDGE = 0.01; // of the plot for a press of an arrow key; with shift ten times as much
const BUMP_WHEEL = 0.003; // of the wheel's way, in the exponent of a bump's size
const BUMP_KEY = 1.1; // factor of a bump's size for a press of a bracket
const TRANSFER_NAMES = ["transfer.mode", "transfer.preset", "transfer.points", "transfer.bumps"];

/** Make the editor; it shows itself where Python's description has a volume. */
function createTransferEditor(session) {
  const canvas = make("canvas", { role: "img" });
  const handles = make("div", {
    class: "handles", role: "group", "aria-label": "Handles",
    "aria-description": "Arrow keys move a handle, Page Up and Page Down go to another, Delete removes it",
  });
  const plot = make("div", { class: "plot" }, canvas, handles);
  const head = make("div", { class: "head" });
  const fields = make("div", { class: "fields", role: "group", "aria-label": "Selected handle" });
  const axis = createValueAxis(show);
  const addButton = makeButton("Add", () => add(findGap(), 0.5));
  const removeButton = makeButton("Remove", () => remove(), { title: "Delete" });
  const tools = make("div", { class: "tools" }, addButton, removeButton,
    makeButton("Load…", () => session.emit("pick", ".json")),
    makeButton("Save", () => session.send({ type: "save", kind: "transfer" })));
  const element = make("div", { class: "transfer", hidden: true }, head, plot, axis.element, fields, tools);

  let kind = null;
  let selected = 0;
  let joint = null;
  let presetMenu = null;
  let modeMenu = null;
  let boxes = []; // of [field, input]

  const items = () => session.state[kind.name] || [];

  // ---- Changes ---------------------------------------------------------------------------------

  function edit(list, how = "nudge") {
    if (!kind.allows(list)) return;
    session[how]({ [kind.name]: list });
  }

  function add(x, y) {
    const [list, k] = kind.add(items(), x, y, axis.to - axis.from);
    if (!kind.allows(list)) return;
    selected = k;
    edit(list, "change");
    focusHandle(k);
  }

  /** Return the middle of the widest gap between the handles that the plot shows. */
  function findGap() {
    const own = items().map((item) => kind.place(item)[0]).filter((x) => x > axis.from && x < axis.to);
    const places = [axis.from, ...own, axis.to].sort((one, other) => one - other);
    const width = (k) => places[k + 1] - places[k];
    const widest = own.reduce((best, _, k) => (width(k + 1) > width(best) ? k + 1 : best), 0);
    return places[widest] + width(widest) / 2;
  }

  const withoutSelected = () => items().filter((_, k) => k !== selected);

  function remove() {
    const list = withoutSelected();
    if (list.length === items().length || !kind.allows(list)) return;
    selected = clamp(selected, 0, Math.max(list.length - 1, 0));
    edit(list, "change");
    (handles.children[selected] || addButton).focus();
  }

  function select(k) {
    selected = k;
    axis.reveal(kind.place(items()[k])[0]);
    show();
  }

  // ---- Handles ---------------------------------------------------------------------------------

  function locate(event) {
    const { left, top } = canvas.getBoundingClientRect();
    const area = findPlotArea(canvas, axis);
    return [
      clamp(area.share(event.clientX - left), 0, 1),
      clamp(1 - (event.clientY - top - area.y) / area.height, 0, 1),
    ];
  }

  const focusHandle = (k) => handles.children[k]?.focus();

  /** Make the handle at a place of the list; it serves whatever item is there. */
  function makeHandle(k) {
    const handle = makeButton("", undefined, { class: "handle" });
    let offset = null; // from the pointer to the middle of the handle
    handle.addEventListener("focus", () => select(k));
    handle.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return;
      handle.setPointerCapture(event.pointerId);
      handle.focus();
      const [at, own] = [locate(event), kind.place(items()[k])];
      offset = [own[0] - at[0], own[1] - at[1]];
    });
    handle.addEventListener("pointermove", (event) => {
      if (!offset || !handle.hasPointerCapture(event.pointerId)) return;
      const [x, y] = locate(event);
      edit(kind.move(items(), k, x + offset[0], y + offset[1]), "drag");
    });
    handle.addEventListener("lostpointercapture", () => {
      offset = null;
      session.finish();
    });
    handle.addEventListener("dblclick", (event) => event.stopPropagation());
    handle.addEventListener("keydown", (event) => pressKey(event, k));
    handle.addEventListener("wheel", (event) => {
      if (!kind.scale || event.ctrlKey) return;
      event.preventDefault();
      event.stopPropagation();
      // Browsers turn a wheel with shift into a horizontal one
      const factor = Math.exp(-BUMP_WHEEL * (event.deltaY || event.deltaX));
      edit(kind.scale(items(), k, ...(event.shiftKey ? [1, factor] : [factor, 1])));
    }, { passive: false });
    return handle;
  }

  function pressKey(event, k) {
    const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    const factors = {
      "[": [1 / BUMP_KEY, 1], "]": [BUMP_KEY, 1], "{": [1, 1 / BUMP_KEY], "}": [1, BUMP_KEY],
    }[event.key];
    const other = { PageUp: k - 1, PageDown: k + 1, Home: 0, End: items().length - 1 }[event.key];
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (other !== undefined) focusHandle(other);
    else if (way) {
      const step = event.shiftKey ? 10 * NUDGE : NUDGE;
      const [x, y] = kind.place(items()[k]);
      edit(kind.move(items(), k, x + step * way[0] * (axis.to - axis.from), y + step * way[1]));
    } else if (event.key === "Delete" || event.key === "Backspace") remove();
    else if (factors && kind.scale) edit(kind.scale(items(), k, ...factors));
    else return;
    event.preventDefault();
    event.stopPropagation();
  }

  // ---- Showing ---------------------------------------------------------------------------------

  /** Choose what is edited by the state's mode, and make the boxes for it. */
  function chooseKind() {
    const { volume } = session.description;
    const mode = session.state["transfer.mode"];
    const flat = mode === "bumps2d";
    kind = flat || mode === "bumps" ? makeBumpKind(volume, flat) : makePointKind(volume);
    boxes = kind.fields.map((field) => [field, makeBox(field)]);
    fields.replaceChildren(...boxes.map(([field, input]) => makeField(field.label, input, field.unit)));
    addButton.textContent = `Add ${kind.noun}`;
    plot.classList.toggle("flat", Boolean(kind.flat));
    canvas.setAttribute("aria-label", kind.flat
      ? "Histogram of values and gradients, and the bumps over them"
      : "Histogram of the values, and the opacity over them");
  }

  function makeBox(field) {
    const { colour, low, high, step, title } = field;
    const number = { type: "number", min: low, max: high, step, title };
    const input = make("input", colour ? { type: "color" } : number);
    input.addEventListener("input", () => {
      const value = colour ? input.value : readNumber(input);
      if (value !== null && items()[selected]) edit(field.set(items(), selected, value));
    });
    input.addEventListener("change", () => {
      session.finish();
      show();
    });
    return input;
  }

  function show() {
    if (element.hidden || !canvas.clientWidth) return;
    const list = items();
    selected = clamp(selected, 0, Math.max(list.length - 1, 0));
    const { volume, histogram } = session.description;
    drawPlot(canvas, { kind, axis, items: list, selected, volume, histogram, joint });
    placeHandles(list);
    for (const [field, input] of boxes) {
      input.disabled = !list.length;
      const value = list.length ? field.get(list[selected]) : "";
      if (!(input.matches(":focus") && input.type === "number" && Number(input.value) === value)) {
        input.value = field.colour ? value || "#808080" : value === "" ? "" : roundNumber(value);
      }
    }
    removeButton.disabled = !list.length || !kind.allows(withoutSelected());
  }

  function placeHandles(list) {
    while (handles.children.length < list.length) handles.append(makeHandle(handles.children.length));
    while (handles.children.length > list.length) handles.lastChild.remove();
    const area = findPlotArea(canvas, axis);
    list.forEach((item, k) => {
      const handle = handles.children[k];
      const [x, y] = kind.place(item);
      // Handles beside the part that is shown can be reached by keys, which then show theirs
      handle.classList.toggle("outside", x < axis.from || x > axis.to);
      handle.style.left = `${area.across(clamp(x, axis.from, axis.to))}px`;
      handle.style.top = `${area.y + (1 - y) * area.height}px`;
      handle.style.backgroundColor = kind.colour(item);
      // One stop of the Tab key for all handles: presets have dozens
      handle.tabIndex = k === selected ? 0 : -1;
      handle.setAttribute("aria-pressed", String(k === selected));
      handle.setAttribute("aria-label", `${kind.noun} ${k + 1} of ${list.length}: ${kind.describe(item)}`);
    });
  }

  plot.addEventListener("dblclick", (event) => add(...locate(event)));
  followAxisGestures(plot, axis, (event) => locate(event)[0],
    () => (items()[selected] ? kind.place(items()[selected])[0] : undefined));

  session.on("open", async ({ volume, controls, presets = [] }, [picture]) => {
    element.hidden = !volume || !("transfer.mode" in session.state);
    if (element.hidden) return;
    const mode = controls.find(({ name }) => name === "transfer.mode");
    presetMenu = makePresetMenu(session, presets);
    modeMenu = makeModeMenu(session, mode);
    head.replaceChildren(presetMenu.row, modeMenu.row);
    chooseKind();
    axis.open(volume);
    joint = picture ? await createImageBitmap(new Blob([picture], { type: "image/png" })) : null;
    show();
  });

  session.on("state", (names) => {
    if (!session.description?.volume || !kind) return;
    const mode = session.description.controls.find(({ name }) => name === "transfer.mode");
    element.hidden = !isWanted(mode, session.state);
    if (names.has("transfer.mode")) {
      chooseKind();
      modeMenu.show(session.state["transfer.mode"]);
    }
    if (TRANSFER_NAMES.some((name) => names.has(name))) presetMenu.show(names);
    if (TRANSFER_NAMES.some((name) => names.has(name)) || names.has("renderer")) show();
  });

  const observer = new ResizeObserver(show);
  observer.observe(plot);
  session.on("theme", show);
  return { element, stop: () => observer.disconnect() };
}
