// Three slices through the volume, with a cross that is dragged to the voxel of interest.

const PLANE_NAMES = { x: "Sagittal", y: "Coronal", z: "Axial" }; // of a patient (RAS)
const WINDOW_DRAG = 0.005; // of the window, for a pixel of a drag
const WINDOW_LEAST = 0.002; // of the range of values
const PROBE_INTERVAL = 100; // ms between two questions for a voxel's value, at least

/** Return a function that asks for values, not more often than Python likes, the latest last. */
function makeProbe(session) {
  let timer = 0;
  let question = null;
  function ask() {
    timer = 0;
    if (!question) return;
    session.send(question);
    question = null;
    timer = setTimeout(ask, PROBE_INTERVAL);
  }
  return (content) => {
    question = content;
    if (!timer) ask();
  };
}

/** Return the function that shows the slices through the voxel whose value was asked for last. */
function makeCrossKey(session) {
  let voxel = null;
  session.on("probe", (answer) => (voxel = answer.voxel));
  session.on("open", () => (voxel = null));
  return () => voxel && session.change({ slices: voxel, "show.slices": true });
}

/** Make the three slices; they show themselves while the state wants them. */
function createSlices(session, probe) {
  const element = make("div", { class: "slices", role: "group", "aria-label": "Slices", hidden: true });
  const views = [];
  let received = 0; // messages; pictures need not be decoded in their order

  session.on("slices", async ({ planes }, pictures) => {
    const number = ++received;
    while (views.length < planes.length) {
      views.push(createSlice(session, views.length, probe));
      element.append(views[views.length - 1].element);
    }
    const bitmaps = await Promise.all(
      pictures.map((bytes) => createImageBitmap(new Blob([bytes], { type: "image/png" }))),
    );
    // All three at first, and then only those that change
    planes.forEach((plane, k) => views["zyx".indexOf(plane.axis)].show(plane, bitmaps[k], number));
  });

  session.on("state", (names) => {
    element.hidden = !session.state["show.slices"];
    if (names.has("slices") || names.has("show.slices")) views.forEach((view) => view.draw());
  });
  const observer = new ResizeObserver(() => views.forEach((view) => view.draw()));
  observer.observe(element);
  session.on("theme", () => views.forEach((view) => view.draw()));
  return { element, stop: () => observer.disconnect() };
}

/**
 * Change the values that are black and white by a drag with shift or the right button.
 *
 * To the right the range between them grows, upwards everything becomes brighter.
 */
function followWindowDrag(session, canvas) {
  let before = null; // the pointer's last place
  canvas.addEventListener("pointerdown", (event) => {
    if (!event.shiftKey && event.button !== 2) return;
    canvas.setPointerCapture(event.pointerId);
    before = [event.clientX, event.clientY];
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!before) return;
    const [right, down] = [event.clientX - before[0], event.clientY - before[1]];
    before = [event.clientX, event.clientY];
    const { "slices.low": low, "slices.high": high } = session.state;
    const [least, most] = session.description.volume.range;
    const pixel = Math.max(high - low, WINDOW_LEAST * (most - least)) * WINDOW_DRAG;
    const width = Math.max(high - low + 2 * pixel * right, WINDOW_LEAST * (most - least));
    const middle = (low + high) / 2 + pixel * down;
    session.drag({
      "slices.low": clamp(middle - width / 2, least, most),
      "slices.high": clamp(middle + width / 2, least, most),
    });
  });
  canvas.addEventListener("lostpointercapture", () => (before = null));
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
}

/** Make the slice number `number`, with the box for its index. */
function createSlice(session, number, probe) {
  const canvas = make("canvas", { tabIndex: 0, role: "application" });
  const box = make("input", { type: "number", min: 0, step: 1 });
  const name = make("span", { class: "name" });
  const count = make("span", { class: "unit" });
  const element = make("div", { class: "slice" }, canvas, make("label", {}, name, box, count));
  let plane = null;
  let bitmap = null;
  let shown = 0; // number of the message that the bitmap is of
  let place = { x: 0, y: 0, width: 1, height: 1 };

  const sizeAlong = (axis) => session.description.volume.size["xyz".indexOf(axis)];
  const indexOf = (axis) => session.state.slices["xyz".indexOf(axis)];

  /** Return the slices' indices with some of them set, each within its axis. */
  function setIndices(changes) {
    return {
      slices: session.state.slices.map((old, k) => {
        const axis = "xyz"[k];
        return axis in changes ? clamp(Math.round(changes[axis]), 0, sizeAlong(axis) - 1) : old;
      }),
    };
  }

  /** Fit the slice into its canvas, with the proportions of its voxels. */
  function fit() {
    const { size, spacing = [1, 1, 1] } = session.description.volume;
    const length = (axis) => size["xyz".indexOf(axis)] * spacing["xyz".indexOf(axis)];
    const [right, up] = [length(plane.across), length(plane.up)];
    const scale = Math.min(canvas.clientWidth / right, canvas.clientHeight / up);
    const [width, height] = [scale * right, scale * up];
    place = { x: (canvas.clientWidth - width) / 2, y: (canvas.clientHeight - height) / 2, width, height };
  }

  function draw() {
    if (!plane || !bitmap || !canvas.clientWidth) return;
    const context = startDrawing(canvas);
    fit();
    const { x, y, width, height } = place;
    context.imageSmoothingQuality = "high";
    context.drawImage(bitmap, x, y, width, height);
    const across = x + (width * (indexOf(plane.across) + 0.5)) / sizeAlong(plane.across);
    const up = y + height * (1 - (indexOf(plane.up) + 0.5) / sizeAlong(plane.up));
    context.beginPath();
    context.moveTo(across, y);
    context.lineTo(across, y + height);
    context.moveTo(x, up);
    context.lineTo(x + width, up);
    context.lineWidth = 1;
    context.strokeStyle = readColours(canvas)("cross");
    context.stroke();
    if (!box.matches(":focus")) box.value = indexOf(plane.axis);
  }

  /** Return where a pointer is in the slice: 0 to 1 from its top left. */
  function locate(event) {
    const { left, top } = canvas.getBoundingClientRect();
    return [(event.clientX - left - place.x) / place.width, (event.clientY - top - place.y) / place.height];
  }

  function moveCross(event) {
    const [x, y] = locate(event);
    const { across, up } = plane;
    session.drag(setIndices({
      [across]: x * sizeAlong(across) - 0.5, [up]: (1 - y) * sizeAlong(up) - 0.5,
    }));
  }
  const step = (axis, way) => session.nudge(setIndices({ [axis]: indexOf(axis) + way }));

  followWindowDrag(session, canvas);
  canvas.addEventListener("pointerdown", (event) => {
    if (event.button !== 0 || event.shiftKey || !plane) return;
    canvas.setPointerCapture(event.pointerId);
    moveCross(event);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!plane) return;
    const [x, y] = locate(event);
    if (event.buttons & 1 && !event.shiftKey && canvas.hasPointerCapture(event.pointerId)) moveCross(event);
    else if (x >= 0 && x <= 1 && y >= 0 && y <= 1) probe({ type: "probe_slice", plane: number, x, y });
  });
  canvas.addEventListener("lostpointercapture", session.finish);
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    if (plane) step(plane.axis, event.deltaY > 0 ? -1 : 1);
  }, { passive: false });
  canvas.addEventListener("keydown", (event) => {
    if (!plane || event.ctrlKey || event.metaKey || event.altKey) return;
    const [axis, way] = {
      ArrowLeft: [plane.across, -1], ArrowRight: [plane.across, 1], ArrowDown: [plane.up, -1],
      ArrowUp: [plane.up, 1], PageDown: [plane.axis, -1], PageUp: [plane.axis, 1],
    }[event.key] || [];
    if (!axis) return;
    event.preventDefault();
    step(axis, way * (event.shiftKey ? 10 : 1));
  });
  box.addEventListener("input", () => {
    const value = readNumber(box);
    if (value !== null) session.nudge(setIndices({ [plane.axis]: value }));
  });
  box.addEventListener("change", () => {
    session.finish();
    box.value = indexOf(plane.axis);
  });

  function show(newPlane, newBitmap, newNumber) {
    if (newNumber < shown) return;
    bitmap?.close();
    [plane, bitmap, shown] = [newPlane, newBitmap, newNumber];
    const { axes } = session.description.volume;
    name.textContent = axes === "RAS" ? PLANE_NAMES[plane.axis] : plane.axis;
    canvas.setAttribute("aria-label",
      `${name.textContent} slice; arrow keys move the cross, Page Up and Page Down the slice`);
    box.max = plane.count - 1;
    count.textContent = `/ ${plane.count - 1}`;
    draw();
  }
  return { element, show, draw };
}
