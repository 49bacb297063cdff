// Paints on the picture: a stroke shows what is under it, or hides it, by the transfer function.

const BRUSH = 0.02; // radius, as a share of the picture's shorter side; as in painting.py
const STROKE_STEP = 0.004; // shares of the picture between two places of a stroke
const MOST_PLACES = 1000; // of a stroke
const STROKE_COLOURS = { show: "rgb(255 210 74 / 55%)", hide: "rgb(90 170 255 / 55%)" };

/** Draw a stroke of places in the picture, as wide as the brush. */
function drawStroke(context, { places, hide }, { x, y, width, height }) {
  context.beginPath();
  for (const [u, v] of places) context.lineTo(x + u * width, y + v * height);
  context.lineTo(x + places[0][0] * width, y + places[0][1] * height + (places.length > 1 ? 0 : 0.01));
  context.lineWidth = 2 * BRUSH * Math.min(width, height);
  context.lineCap = context.lineJoin = "round";
  context.strokeStyle = STROKE_COLOURS[hide ? "hide" : "show"];
  context.stroke();
}

/** Draw a ring where a key paints, in the middle of the picture. */
function drawBrush(context, { x, y, width, height }) {
  context.beginPath();
  context.arc(x + width / 2, y + height / 2, BRUSH * Math.min(width, height), 0, 2 * Math.PI);
  strokeTwice(context, "#fff");
}

/**
 * Let strokes be painted on a stage while the button is pressed; they take the place of orbits.
 *
 * `key` does what a key means to it, and returns whether it means anything.
 */
function createPaint(session, stage, picture) {
  const canvas = make("canvas", { class: "strokes", "aria-hidden": "true" });
  stage.append(canvas);
  let on = false;
  let stroke = null; // { places, hide }, until Python has answered
  let pointer = null; // the one that paints

  const button = makeButton("Paint", () => press(!on), {
    "aria-pressed": "false", disabled: true,
    title: "Draw on the picture to show what is there; with Shift, to hide it (p)",
  });

  function draw() {
    const context = startDrawing(canvas);
    if (stroke) drawStroke(context, stroke, picture.place);
    if (on && stage.matches(":focus-visible")) drawBrush(context, picture.place);
  }

  function press(wanted) {
    on = wanted && !button.disabled;
    button.setAttribute("aria-pressed", String(on));
    stage.classList.toggle("paints", on);
    draw();
  }

  function send() {
    session.finish();
    session.send({ type: "paint", stroke: stroke.places, hide: stroke.hide });
  }

  /** Add the place of a pointer to the stroke, unless it is at the last one. */
  function extend(event) {
    const place = picture.locate(event).map((share) => Math.round(1e4 * clamp(share, 0, 1)) / 1e4);
    const { places } = stroke;
    const last = places.at(-1);
    const far = !last || Math.hypot(place[0] - last[0], place[1] - last[1]) > STROKE_STEP;
    if (far && places.length < MOST_PLACES) places.push(place);
    draw();
  }

  // Painting comes before orbiting, so these listeners capture what happens on the stage
  stage.addEventListener("pointerdown", (event) => {
    if (!on || event.button !== 0 || event.target.closest("button, .wipe, .notice")) return;
    event.stopImmediatePropagation();
    if (pointer !== null) return;
    pointer = event.pointerId;
    stage.setPointerCapture(pointer);
    stroke = { places: [], hide: event.shiftKey };
    extend(event);
  }, true);
  stage.addEventListener("pointermove", (event) => {
    if (event.pointerId === pointer) extend(event);
  });
  stage.addEventListener("lostpointercapture", (event) => {
    if (event.pointerId !== pointer) return;
    pointer = null;
    send();
  });
  stage.addEventListener("dblclick", (event) => {
    if (on) event.stopImmediatePropagation();
  }, true);
  for (const type of ["focus", "blur"]) stage.addEventListener(type, draw);

  function forget() {
    if (pointer === null && stroke) stroke = null;
    draw();
  }
  session.on("history", forget);
  session.on("error", forget);
  session.on("drawn", draw);
  session.on("open", ({ volume }) => {
    button.disabled = !volume;
    press(on);
  });

  function key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return false;
    if (event.key === "p" && uses(session, "paint")) press(!on);
    else if (on && event.key === "Enter") {
      stroke = { places: [[0.5, 0.5]], hide: event.shiftKey };
      draw();
      send();
    } else return false;
    return true;
  }
  return { button, key };
}
