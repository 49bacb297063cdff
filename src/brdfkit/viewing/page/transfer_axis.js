// The value axis of the transfer editor: which part of the range of values the plot shows.

const NARROWEST_SPAN = 0.001; // of what is shown, as a share of the range of values
const SPAN_STEP = 1.5; // factor for a press of + or −
const SPAN_WHEEL = 0.002; // of the wheel's way, in the exponent

/**
 * Make the axis; `show` draws the plot anew.
 *
 * It shows the values from `axis.from` to `axis.to`, as shares of the range of values.
 */
function createValueAxis(show) {
  const axis = { from: 0, to: 1 };
  let range = null;
  const toValue = (share) => range[0] + share * (range[1] - range[0]);
  const toShare = (value) => (value - range[0]) / (range[1] - range[0] || 1);

  function write(box) {
    box.value = roundNumber(toValue(box === boxes[0] ? axis.from : axis.to));
  }

  function set(from, to) {
    const width = clamp(to - from, NARROWEST_SPAN, 1);
    axis.from = clamp(from, 0, 1 - width);
    axis.to = axis.from + width;
    boxes.filter((box) => !box.matches(":focus")).forEach(write);
    whole.disabled = width === 1;
    show();
  }

  axis.zoom = (factor, at = (axis.from + axis.to) / 2) => {
    set(at - (at - axis.from) * factor, at + (axis.to - at) * factor);
  };
  axis.pan = (share) => set(axis.from + share, axis.to + share);
  /** Show a share of the range, in the middle if it was not to be seen. */
  axis.reveal = (share) => {
    if (share < axis.from || share > axis.to) axis.pan(share - (axis.from + axis.to) / 2);
  };
  /** Show the whole range of another volume. */
  axis.open = (volume) => {
    if (equal(range, volume.range)) return;
    range = volume.range;
    const limits = { min: range[0], max: range[1], step: chooseStep(...range) };
    boxes.forEach((box) => Object.assign(box, limits));
    set(0, 1);
  };

  const boxes = ["from", "to"].map((end) => make("input", {
    type: "number", "aria-label": `The plot shows values ${end}`,
    oninput: () => {
      const [from, to] = boxes.map(readNumber);
      if (from !== null && to !== null && from < to) set(toShare(from), toShare(to));
    },
    onchange: () => boxes.forEach(write),
  }));
  const word = (text) => make("span", { "aria-hidden": "true" }, text);
  const button = (text, key, label, onclick) =>
    makeButton(text, onclick, { "aria-label": label, title: `${label} (${key})` });
  const whole = button("All", "0", "Show all values", () => set(0, 1));
  axis.element = make("div", { class: "axis", role: "group", "aria-label": "Values that the plot shows" },
    word("From"), boxes[0], word("to"), boxes[1],
    button("−", "−", "Show more values", () => axis.zoom(SPAN_STEP)),
    button("+", "+", "Show fewer values", () => axis.zoom(1 / SPAN_STEP)),
    whole);
  return axis;
}

/**
 * Move the axis by pointers and keys on the plot.
 *
 * A drag beside the handles, and the wheel with shift, pan; the wheel with Ctrl, + and − zoom.
 * `locate(event)` gives the share under a pointer, `middle()` the share that keys zoom about.
 */
function followAxisGestures(plot, axis, locate, middle) {
  plot.addEventListener("wheel", (event) => {
    if (!event.ctrlKey && !event.shiftKey) return; // the panels scroll
    event.preventDefault();
    const way = event.deltaY || event.deltaX;
    if (event.ctrlKey) axis.zoom(Math.exp(SPAN_WHEEL * way), locate(event));
    else axis.pan(SPAN_WHEEL * way * (axis.to - axis.from));
  }, { passive: false });

  let held = null; // the share that stays under the pointer
  plot.addEventListener("pointerdown", (event) => {
    if (event.button !== 0 || event.target.closest("button")) return;
    plot.setPointerCapture(event.pointerId);
    held = locate(event);
  });
  plot.addEventListener("pointermove", (event) => {
    if (held !== null) axis.pan(held - locate(event));
  });
  plot.addEventListener("lostpointercapture", () => (held = null));

  plot.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key === "+" || event.key === "=") axis.zoom(1 / SPAN_STEP, middle());
    else if (event.key === "-" || event.key === "_") axis.zoom(SPAN_STEP, middle());
    else if (event.key === "0") axis.zoom(1 / NARROWEST_SPAN);
    else return;
    event.preventDefault();
    event.stopPropagation();
  });
}
