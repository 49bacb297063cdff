// What is selected in the plots: its marks in each of them, and the list of its numbers.

const MARK_RADIUS = 3;
const NAMES_OF_COORDINATES = {
  theta_i: "θi", theta_o: "θo", theta_h: "θh", theta_d: "θd", view: "θo", value: "value",
};

/** Draw a dot with a rim at each place, so that it shows on every picture. */
function drawMarks(context, { colours }, places) {
  context.fillStyle = colours("paper");
  fillDots(context, places, MARK_RADIUS + 1);
  context.fillStyle = colours("accent");
  fillDots(context, places, MARK_RADIUS);
}

/** Return the range [low, high] of a coordinate in the state's selection, or null. */
function findRange({ state }, wanted) {
  const found = state["plots.selection"]?.find(([name]) => name === wanted);
  return found ? found.slice(1) : null;
}

/** Outline a selected region, a path of places on the canvas. */
function outlineRegion(context, { colours }, places) {
  context.setLineDash([5, 3]);
  context.lineWidth = 1.5;
  context.strokeStyle = colours("accent");
  strokeLine(context, [...places, places[0]]);
  context.setLineDash([]);
}

/** Return the change of the state that selects ranges [name, low, high]. */
function selectRanges(ranges) {
  return { "plots.selection": ranges.map(([name, low, high]) => [name, Math.min(low, high), Math.max(low, high)]) };
}

/** Return the selected marks as objects with all of their coordinates. */
function listMarks({ selection }) {
  if (!selection) return [];
  const { marks } = selection;
  return [...marks.theta_i].map((_, k) => (
    Object.fromEntries(Object.entries(marks).map(([name, values]) => [name, values[k]]))));
}

/** Write the ranges of a selection in words. */
function writeSelection(ranges) {
  return ranges.filter(([name]) => NAMES_OF_COORDINATES[name]).map(([name, low, high]) => {
    const write = name === "value" ? writeValue : writeAngle;
    return `${NAMES_OF_COORDINATES[name]} ${write(low)} to ${write(high)}`;
  }).join(", ");
}

/** Write the channels of a colour. */
function writeChannels(numbers) {
  return numbers.map(writeValue).join("  ");
}

/** Make a table with a head of texts, and rows of a first cell and others. */
function makeNumberTable(head, rows) {
  return make("table", { class: "errors" },
    make("thead", {}, make("tr", {}, ...head.map((text) => make("th", { scope: "col" }, text)))),
    make("tbody", {}, ...rows.map(([first, ...others]) => make("tr", {},
      make("th", { scope: "row" }, first), ...others.map((text) => make("td", {}, text))))));
}

/** Make the list of what is selected, which is there as long as something is. */
function createSelection(session) {
  const close = makeButton("Clear", () => session.change({ "plots.selection": [] }), { title: "Select nothing (Escape)" });
  const body = make("div", { class: "selection-body", tabIndex: 0, role: "group", "aria-label": "Numbers of the selection" });
  const element = make("section", { class: "plot-frame selection", "aria-label": "Selection", hidden: true },
    make("header", {}, make("h3", {}, "Selection"), make("div", { class: "plot-buttons" }, close)), body);

  let last = null; // the content that was shown last, and of which selection it is
  const write = () => JSON.stringify(session.state["plots.selection"]);

  function show(content) {
    const { text, count, names, medians, ratios, rows, curves } = content;
    last = { content, selection: write() };
    const ranges = make("p", {}, writeSelection(session.state["plots.selection"] || []));
    if (!rows?.length) {
      body.replaceChildren(ranges, make("p", {}, text));
      return;
    }
    const what = count ? `${count.toLocaleString("en")} ${count === 1 ? "sample" : "samples"}` : "no sample: interpolated values";
    const quotient = `/ ${names[0]}`;
    const several = names.length > 1;
    const summary = makeNumberTable(["median", "R G B", ...(several ? [quotient] : [])], names.map((name, k) => (
      [nameEntry(name, curves[k]), writeChannels(medians[k]), ...(several ? [`× ${writeValue(ratios[k])}`] : [])])));
    const list = makeNumberTable(
      [...(several ? ["ratio"] : []), "θi θo θh θd [°]", ...names],
      rows.map(({ angles, colours, ratio }) => (
        [...(several ? [`× ${writeValue(ratio)}`] : []), angles.join("  "), ...colours.map(writeChannels)])));
    const order = several ? `Farthest first, by ${names[1]} ${quotient}:` : "Samples:";
    body.replaceChildren(ranges, make("p", {}, what), summary, make("p", { class: "soft" }, order), list);
  }
  /** Show what is selected, until its numbers come; Python does not send again what it sent last. */
  function wait() {
    if (last?.selection === write()) {
      show(last.content);
      return;
    }
    body.replaceChildren(make("p", {}, writeSelection(session.state["plots.selection"])), make("p", { class: "soft" }, "Loading…"));
  }
  return { element, show, wait };
}

/** Make the name of a material with its colour. */
function nameEntry(name, { colour, measured }) {
  const chip = make("span", { class: measured ? "chip dots" : "chip", "aria-hidden": "true" });
  chip.style.backgroundColor = colour;
  return make("span", { class: "entry", title: measured ? `${name}, measured` : name }, chip, name);
}
