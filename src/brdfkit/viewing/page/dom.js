// Makes the elements of the page, sizes its canvases and writes its numbers.

/**
 * Make an element: `make("p", { class: "soft", textContent: "none" }, child, …)`.
 *
 * A name that begins with "on" adds a listener; what the element has as a property is set as one,
 * everything else as an attribute. Properties that are undefined or null are left out.
 */
function make(tag, properties = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (value === undefined || value === null) continue;
    if (name === "class") element.className = value;
    else if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else if (name in element) element[name] = value;
    else element.setAttribute(name, value);
  }
  element.append(...children);
  return element;
}

/** Make a button that shows `text`; `properties` as for `make`. */
function makeButton(text, onclick, properties = {}) {
  return make("button", { type: "button", onclick, ...properties }, text);
}

/** Make an input with its visible label, which is clickable because it is around the input. */
function makeField(label, input, unit = "") {
  const after = unit ? [make("span", { class: "unit" }, unit)] : [];
  return make("label", { class: "field" }, make("span", { class: "name" }, label), input, ...after);
}

/** Return the size of an element in the screen's own pixels. */
function measurePixels(element) {
  const ratio = window.devicePixelRatio || 1;
  return {
    width: Math.max(Math.round(element.clientWidth * ratio), 1),
    height: Math.max(Math.round(element.clientHeight * ratio), 1),
  };
}

/**
 * Clear a canvas, as sharp as the screen, and return its context.
 *
 * The context's unit is the pixel of CSS. Setting the size of a canvas clears it, so this is
 * to be called directly before drawing: then nothing flickers.
 */
function startDrawing(canvas) {
  const { width, height } = measurePixels(canvas);
  if (canvas.width !== width) canvas.width = width;
  if (canvas.height !== height) canvas.height = height;
  const context = canvas.getContext("2d");
  const ratio = window.devicePixelRatio || 1;
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, canvas.clientWidth, canvas.clientHeight);
  return context;
}

/** Return a function that reads a colour of the style sheet: `readColours(canvas)("ink")`. */
function readColours(element) {
  const style = getComputedStyle(element);
  return (name) => style.getPropertyValue(`--${name}`).trim();
}

/** Return the font of the style sheet at a size in pixels, for a canvas. */
function readFont(element, size) {
  return `${size}px ${getComputedStyle(element).fontFamily}`;
}

/** Return the number between `low` and `high` that is nearest to `value`. */
function clamp(value, low, high) {
  return Math.min(Math.max(value, low), high);
}

/** Write a number with at most four significant digits and a true minus. */
function writeNumber(value) {
  return String(roundNumber(value)).replace("-", "−");
}

/** Write a number with its unit, which may be unknown. */
function writeQuantity(value, unit) {
  return unit ? `${writeNumber(value)} ${unit}` : writeNumber(value);
}

/** Round a number to four significant digits; whole numbers stay whole. */
function roundNumber(value) {
  return Number.isInteger(value) ? value : Number(Number(value).toPrecision(4));
}

/** Return round numbers from `low` to `high`, about `count` of them, for the ticks of an axis. */
function chooseTicks(low, high, count) {
  if (!(high > low)) return [low];
  const rough = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 5, 10].find((factor) => factor * power >= rough * 0.999);
  const first = Math.ceil(low / step - 1e-9);
  const last = Math.floor(high / step + 1e-9);
  return Array.from({ length: last - first + 1 }, (_, k) => roundNumber((first + k) * step));
}

/** Return whether two values of a state are the same. */
function equal(first, second) {
  return first === second || JSON.stringify(first) === JSON.stringify(second);
}

/** Return whether keys that an element receives are text for it, not commands. */
function takesText(element) {
  if (element.tagName === "TEXTAREA") return true;
  return element.tagName === "INPUT" && !["range", "checkbox", "color"].includes(element.type);
}
