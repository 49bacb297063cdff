// Shows the measured picture and that of a fit: wiped, side by side, in turns, or their difference.
// The pictures are numbers of linear light (see pixels.py), so that an exposure can scale them.

const data = JSON.parse(document.getElementById("pixels").textContent);
const { width, height } = data;
const area = width * height;
const viewer = document.querySelector(".viewer");
const stage = viewer.querySelector(".stage");
const form = viewer.querySelector("form");
const wipe = viewer.querySelector("[name=wipe]");
const panes = [...stage.querySelectorAll(".pane")];
const canvases = panes.map((pane) => pane.querySelector("canvas"));
const FLICKER = 700; // ms that each picture is shown: far from the three flashes a second that harm

// ---- The numbers -------------------------------------------------------------------------------

/** The bytes of a text in base64. */
function bytes(text) {
  return Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
}

/** The codes that pixels.py packed: deflated, low bytes, high bytes, each less the one before it. */
async function unpack(text) {
  const stream = new Blob([bytes(text)]).stream().pipeThrough(new DecompressionStream("deflate"));
  const split = new Uint8Array(await new Response(stream).arrayBuffer());
  const codes = new Uint16Array(split.length / 2);
  let sum = 0;
  for (let k = 0; k < codes.length; k++) {
    sum += split[k] + 256 * split[k + codes.length];
    codes[k] = sum; // the array keeps the low 16 bits
  }
  return codes;
}

/** The linear light of a code; 0 is black. */
const light = (code) => (code ? 2 ** (data.darkest + code / data.steps) : 0);

/** The colour difference ΔE of a code. */
const difference = (code) => data.highest * (code / 255) ** 2;

const palette = bytes(data.palette);
const pictures = await Promise.all(data.pictures.map(unpack)); // all R, then all G, then all B
const differences = await Promise.all(data.differences.map(unpack));

// ---- Drawing -----------------------------------------------------------------------------------

/** The byte of sRGB for each code, at an exposure in stops. */
function displayed(stops) {
  return Uint8ClampedArray.from({ length: 4096 }, (_, code) => {
    const x = Math.min(light(code) * 2 ** stops, 1);
    return 255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055);
  });
}

/** Draw what `colour(pixel, channel)` gives, bytes of sRGB. */
function draw(canvas, colour) {
  const image = new ImageData(width, height);
  for (let k = 0; k < area; k++) {
    for (let c = 0; c < 3; c++) image.data[4 * k + c] = colour(k, c);
    image.data[4 * k + 3] = 255;
  }
  canvas.getContext("2d").putImageData(image, 0, 0);
}

function drawPicture(canvas, number) {
  const codes = pictures[number];
  const shown = displayed(Number(form.exposure.value));
  draw(canvas, (k, c) => shown[codes[c * area + k]]);
}

/** Draw the difference of a fit, as many rows of the palette as it has steps. */
function drawDifference(canvas, number) {
  const codes = differences[number - 1];
  const shade = (k) => Math.round(255 * Math.min(difference(codes[k]) / data.most, 1));
  draw(canvas, (k, c) => palette[3 * shade(k) + c]);
}

// ---- What the controls say ---------------------------------------------------------------------

let flicker = 0; // the timer of the flicker

function update() {
  const { mode, fit, zoom, exposure } = form;
  const number = Number(fit.value);
  const [left, right] = stage.querySelectorAll(".tag");
  stage.className = `stage ${mode.value}`;
  stage.classList.toggle("zoomed", zoom.value > 1);
  stage.style.setProperty("--zoom", zoom.value);
  stage.style.setProperty("--wipe", `${wipe.value}%`);
  wipe.closest("label").hidden = mode.value !== "wipe";
  viewer.querySelector(".scale").hidden = mode.value !== "difference";
  form.stops.value = `${exposure.value > 0 ? "+" : ""}${exposure.value.replace("-", "−")} stops`;

  drawPicture(canvases[0], 0);
  if (mode.value === "difference") drawDifference(canvases[1], number);
  else drawPicture(canvases[1], number);

  left.textContent = ["wipe", "beside"].includes(mode.value) ? "measured" : "";
  right.textContent = mode.value === "difference" ? `ΔE of ${data.names[number]}` : data.names[number];
  clearInterval(flicker);
  if (mode.value === "flicker") {
    flicker = setInterval(() => {
      const first = stage.classList.toggle("first");
      right.textContent = first ? "measured" : data.names[number];
    }, FLICKER);
  }
  read();
}

// ---- The readout -------------------------------------------------------------------------------

const point = { x: Math.floor(width / 2), y: Math.floor(height / 2), chosen: false };
const digits = (value) => (value ? value.toPrecision(3) : "0").replace("Infinity", "∞");

/** Say what the two pictures have at the point. */
function read() {
  if (!point.chosen) return;
  const k = point.y * width + point.x;
  const number = Number(form.fit.value);
  const rows = viewer.querySelectorAll(".readout tbody tr");
  const pair = [pictures[0], pictures[number]].map((codes) => [0, 1, 2].map((c) => light(codes[c * area + k])));
  const ratio = pair[1].map((value, c) => value / pair[0][c]);
  [...pair, ratio].forEach((values, row) =>
    values.forEach((value, c) => (rows[row].cells[c + 1].textContent = digits(value))),
  );
  const shown = displayed(Number(form.exposure.value));
  [pictures[0], pictures[number]].forEach((codes, row) => {
    const rgb = [0, 1, 2].map((c) => shown[codes[c * area + k]]);
    rows[row].querySelector(".chip").style.background = `rgb(${rgb})`;
  });
  viewer.querySelector(".fit-name").textContent = data.names[number];
  viewer.querySelector(".delta").textContent = `ΔE ${difference(differences[number - 1][k]).toFixed(1)}`;
  viewer.querySelector(".place").textContent = `${point.x}, ${point.y}`;
  for (const probe of stage.querySelectorAll(".probe")) {
    probe.hidden = false;
    probe.style.left = `${((point.x + 0.5) / width) * 100 * form.zoom.value}%`;
    probe.style.top = `${((point.y + 0.5) / height) * 100 * form.zoom.value}%`;
  }
}

function choose(x, y) {
  point.x = Math.max(0, Math.min(width - 1, x));
  point.y = Math.max(0, Math.min(height - 1, y));
  point.chosen = true;
  read();
}

// ---- Events ------------------------------------------------------------------------------------

panes.forEach((pane, which) => {
  const canvas = canvases[which];
  [canvas.width, canvas.height] = [width, height];
  pane.addEventListener("pointermove", (event) => {
    const box = canvas.getBoundingClientRect();
    const [x, y] = [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
    choose(Math.floor(x * width), Math.floor(y * height));
    if (event.buttons && form.mode.value === "wipe" && form.zoom.value === "1") {
      wipe.value = 100 * x;
      update();
    }
  });
  // Both show the same part
  pane.addEventListener("scroll", () => {
    const other = panes[1 - which];
    if (other.scrollLeft !== pane.scrollLeft) other.scrollLeft = pane.scrollLeft;
    if (other.scrollTop !== pane.scrollTop) other.scrollTop = pane.scrollTop;
  });
  pane.addEventListener("keydown", (event) => {
    const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    if (!step) return;
    event.preventDefault();
    const far = event.shiftKey ? 10 : 1;
    choose(point.x + far * step[0], point.y + far * step[1]);
    pane.querySelector(".probe").scrollIntoView({ block: "nearest", inline: "nearest" });
  });
});
form.addEventListener("input", update);
form.addEventListener("submit", (event) => event.preventDefault());
wipe.addEventListener("input", update);

drawScale(viewer.querySelector(".scale .bar"));
viewer.hidden = false;
update();

/** The palette from 0 to its bright end. */
function drawScale(bar) {
  const colours = [0, 32, 64, 96, 128, 160, 192, 224, 255].map((k) => `rgb(${palette.slice(3 * k, 3 * k + 3)})`);
  bar.style.background = `linear-gradient(90deg, ${colours})`;
}
