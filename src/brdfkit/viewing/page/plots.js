// The plots below the picture: which are open, what all of them show, and the legend.

const PLOT_KINDS = () => ({
  polar: POLAR, lobe: LOBE, slices: SLICES, albedo: ALBEDO, samples: SAMPLES,
});
const OWN_SETTINGS = {
  polar: ["plots.phi_o", "plots.sampler"], slices: ["plots.phi_d"], samples: ["plots.samples_over"],
};
const LEAST_PLOTS = 130; // pixels of height that the plots keep
const LEAST_PICTURE = 120; // pixels of height that the picture keeps
const SPLIT_STEP = 20; // pixels for a press of an arrow key

/** Make the controls of the plots, which are small: a number has no slider. */
function makePlotControl(session, control) {
  const parts = CONTROL_MAKERS[control.kind](session, control);
  parts.row.title = control.help;
  parts.input.setAttribute("aria-description", control.help);
  return [control, parts];
}

/** Make the button that opens and closes a plot. */
function makePlotButton(session, { name, label, help }) {
  const key = `plots.show.${name}`;
  const button = makeButton(label, () => {
    session.change({ [key]: !session.state[key] });
    document.querySelector(`.plot-${name}`)?.scrollIntoView({ block: "nearest" });
  }, { title: help });
  return { key, button };
}

/** Make the plots of a page; they are there if Python describes any. */
function createPlots(session) {
  const toggles = make("div", { class: "group", role: "group", "aria-label": "Plots" });
  const shared = make("div", { class: "settings" });
  const legend = make("p", { class: "legend" });
  const row = make("div", { class: "plots-row" });
  const selection = createSelection(session);
  const area = make("div", { class: "plots-area" }, row, selection.element);
  const element = make("div", { class: "plots", role: "region", "aria-label": "Plots", hidden: true });
  const splitter = makeSplitter(element);
  element.append(splitter, make("div", { class: "plots-bar" }, toggles, shared, legend), area);
  let frames = new Map();
  let buttons = [];
  let controls = [];

  function build({ plots = [] }) {
    frames.forEach(({ stop }) => stop());
    element.hidden = !plots.length;
    frames = new Map(plots.filter(({ name }) => PLOT_KINDS()[name])
      .map((described) => [described.name, createPlotFrame(session, described, PLOT_KINDS()[described.name])]));
    buttons = plots.map((described) => makePlotButton(session, described));
    toggles.replaceChildren(...buttons.map(({ button }) => button));
    row.replaceChildren(...[...frames.values()].map((frame) => frame.element));
  }

  function buildControls({ controls: all = [] }) {
    if (!frames.size) return;
    const focused = controls.find(([, { row: own }]) => own.matches(":focus-within"))?.[0].name;
    controls = all.filter(({ name, panel }) => panel === "plots" && !name.startsWith("plots.show."))
      .filter(({ kind }) => CONTROL_MAKERS[kind])
      .map((control) => makePlotControl(session, control));
    const rowOf = (wanted) => controls.find(([{ name }]) => name === wanted)?.[1].row;
    const owned = Object.values(OWN_SETTINGS).flat();
    shared.replaceChildren(...controls.filter(([{ name }]) => !owned.includes(name)).map(([, parts]) => parts.row));
    for (const [name, frame] of frames) {
      frame.settings.replaceChildren(...(OWN_SETTINGS[name] || []).map(rowOf).filter(Boolean));
    }
    controls.find(([{ name }]) => name === focused)?.[1].input.focus();
  }

  function showState(names) {
    if (!frames.size) return;
    const { state } = session;
    for (const { key, button } of buttons) button.setAttribute("aria-pressed", String(Boolean(state[key])));
    for (const [name, frame] of frames) frame.element.hidden = !state[`plots.show.${name}`];
    const anyOpen = [...frames.keys()].some((name) => state[`plots.show.${name}`]);
    area.hidden = splitter.hidden = shared.hidden = legend.hidden = !anyOpen;
    element.classList.toggle("closed", !anyOpen);
    for (const [control, parts] of controls) {
      if (names.has(control.name)) parts.show(state[control.name]);
      // What means nothing now keeps its place, so that the plots do not move
      const idle = !isWanted(control, state);
      parts.row.classList.toggle("idle", idle);
      for (const input of parts.row.querySelectorAll("input, select")) input.disabled = idle;
    }
    if (names.has("plots.selection")) {
      const none = !state["plots.selection"]?.length;
      selection.element.hidden = none;
      if (!none) selection.wait();
      else frames.forEach(({ plot }) => (plot.selection = null));
    }
    if ([...names].some((name) => name.startsWith("plots."))) frames.forEach(({ plot }) => plot.draw());
  }

  session.on("open", (content) => {
    build(content);
    buildControls(content);
  });
  session.on("controls", buildControls);
  session.on("state", showState);
  session.on("plot", (content, [bytes]) => {
    const shown = bytes ? readArrays(content, bytes) : content;
    showLegend(legend, content.curves, session.state["plots.channel"] === "each");
    if (content.plot !== "selection") {
      frames.get(content.plot)?.plot.show(shown);
      return;
    }
    selection.show(shown);
    frames.forEach(({ plot }) => {
      plot.selection = shown.marks ? shown : null;
      plot.draw();
    });
  });
  return { element, stop: () => frames.forEach(({ stop }) => stop()) };
}

/** Show which colour is which material; with `each`, lines have the colours of channels instead. */
function showLegend(legend, curves, each) {
  const key = JSON.stringify([curves, each]);
  if (legend.dataset.key === key) return;
  legend.dataset.key = key;
  const channels = [..."RGB"].map((name, k) => nameEntry(name, { colour: CHANNEL_COLOURS[k] }));
  const models = make("span", { class: "entry" }, "models dashed");
  legend.replaceChildren(...curves.map((curve) => nameEntry(curve.name, curve)), ...(each ? [...channels, models] : []));
}

/** Make the bar above the plots that a drag or the arrow keys move, to make them higher or lower. */
function makeSplitter(element) {
  const splitter = make("div", {
    class: "splitter", tabIndex: 0, role: "separator", "aria-orientation": "horizontal",
    "aria-label": "Height of the plots", "aria-valuemin": "0", "aria-valuemax": "100", "aria-valuenow": "40",
    title: "Drag: higher or lower plots; double click: as at first",
  });
  const setHeight = (height) => {
    const room = element.parentElement.clientHeight;
    const own = clamp(height, LEAST_PLOTS, Math.max(room - LEAST_PICTURE, LEAST_PLOTS));
    element.style.flexBasis = `${own}px`;
    splitter.setAttribute("aria-valuenow", Math.round((100 * own) / room));
  };
  splitter.addEventListener("pointerdown", (event) => splitter.setPointerCapture(event.pointerId));
  splitter.addEventListener("pointermove", (event) => {
    if (!splitter.hasPointerCapture(event.pointerId)) return;
    setHeight(element.getBoundingClientRect().bottom - event.clientY);
  });
  splitter.addEventListener("dblclick", () => (element.style.flexBasis = ""));
  splitter.addEventListener("keydown", (event) => {
    const way = { ArrowUp: 1, ArrowDown: -1 }[event.key];
    if (!way) return;
    event.preventDefault();
    setHeight(element.clientHeight + way * SPLIT_STEP);
  });
  return splitter;
}
