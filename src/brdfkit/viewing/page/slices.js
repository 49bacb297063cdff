// Three slices through the volume, with a cross that is dragged to the voxel of interest.

const WINDOW_DRAG = 0.005; // of the window, for a pixel of a drag
const WINDOW_LEAST = 0.002; // of the range of values
const END_RADIUS = 9; // pixels of the disc with the name of an edge
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
    planes.forEach((plane, k) => views[plane.number].show(plane, bitmaps[k], number));
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

  const sizeAlong = (axis) => session.description.volume.size[axis];

  /** Return where the voxel of the cross is along an axis of the plane: 0 to 1, to the right or up. */
  function findCrossShare(k) {
    const share = (session.state.slices[plane.axes[k]] + 0.5) / sizeAlong(plane.axes[k]);
    return plane.ways[k] > 0 ? share : 1 - share;
  }

  /** Return the slices' indices with some of them set, {axis: index}, each within its axis. */
  function setIndices(changes) {
    return {
      slices: session.state.slices.map((old, axis) => (
        axis in changes ? clamp(Math.round(changes[axis]), 0, sizeAlong(axis) - 1) : old)),
    };
  }

  /** Fit the slice into its canvas, with the proportions of its voxels. */
  function fit() {
    const { size, spacing = [1, 1, 1] } = session.description.volume;
    const [right, up] = plane.axes.map((axis) => size[axis] * spacing[axis]);
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
    const across = x + width * findCrossShare(0);
    const up = y + height * (1 - findCrossShare(1));
    context.beginPath();
    context.moveTo(across, y);
    context.lineTo(across, y + height);
    context.moveTo(x, up);
    context.lineTo(x + width, up);
    context.lineWidth = 1;
    context.strokeStyle = readColours(canvas)("cross");
    context.stroke();
    writeEnds(context);
    showIndex();
  }

  /** Write the names of the edges, such as R and L, on discs that hide the cross. */
  function writeEnds(context) {
    const { x, y, width, height } = place;
    const [left, right, lower, upper] = plane.ends;
    const [middle, level] = [x + width / 2, y + height / 2];
    context.font = readFont(canvas, 12);
    context.textAlign = "center";
    context.textBaseline = "middle";
    const write = (text, across, down) => {
      if (!text) return;
      context.beginPath();
      context.arc(across, down, END_RADIUS, 0, 2 * Math.PI);
      context.fillStyle = "rgb(0 0 0 / 75%)";
      context.fill();
      context.fillStyle = "#fff";
      context.fillText(text, across, down);
    };
    write(left, x + END_RADIUS, level);
    write(right, x + width - END_RADIUS, level);
    write(lower, middle, y + height - END_RADIUS);
    write(upper, middle, y + END_RADIUS);
  }

  /** Show the index of the slice, unless it is being typed. */
  function showIndex() {
    if (!box.matches(":focus")) box.value = session.state.slices[plane.axes[2]];
  }

  /** Return where a pointer is in the slice: 0 to 1 from its top left. */
  function locate(event) {
    const { left, top } = canvas.getBoundingClientRect();
    return [(event.clientX - left - place.x) / place.width, (event.clientY - top - place.y) / place.height];
  }

  function moveCross(event) {
    const [x, y] = locate(event);
    const changes = [x, 1 - y].map((share, k) => {
      const along = plane.ways[k] > 0 ? share : 1 - share;
      return [plane.axes[k], along * sizeAlong(plane.axes[k]) - 0.5];
    });
    session.drag(setIndices(Object.fromEntries(changes)));
  }

  /** Move the cross by voxels: to the right (k = 0), upwards (1) or through the plane (2). */
  function step(k, voxels) {
    const axis = plane.axes[k];
    session.nudge(setIndices({ [axis]: session.state.slices[axis] + plane.ways[k] * voxels }));
  }

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
    if (plane) step(2, event.deltaY > 0 ? -1 : 1);
  }, { passive: false });
  canvas.addEventListener("keydown", (event) => {
    if (!plane || event.ctrlKey || event.metaKey || event.altKey) return;
    const [k, way] = {
      ArrowLeft: [0, -1], ArrowRight: [0, 1], ArrowDown: [1, -1], ArrowUp: [1, 1],
      PageDown: [2, -1], PageUp: [2, 1],
    }[event.key] || [];
    if (!way) return;
    event.preventDefault();
    step(k, way * (event.shiftKey ? 10 : 1));
  });
  box.addEventListener("input", () => {
    const value = readNumber(box);
    if (value !== null) session.nudge(setIndices({ [plane.axes[2]]: value }));
  });
  box.addEventListener("change", () => {
    session.finish();
    box.value = session.state.slices[plane.axes[2]];
  });

  function show(newPlane, newBitmap, newNumber) {
    if (newNumber < shown) return;
    bitmap?.close();
    [plane, bitmap, shown] = [newPlane, newBitmap, newNumber];
    name.textContent = plane.name;
    canvas.setAttribute("aria-label",
      `${plane.name} slice; arrow keys move the cross, Page Up and Page Down the slice`);
    box.max = sizeAlong(plane.axes[2]) - 1;
    count.textContent = `/ ${box.max}`;
    draw();
  }
  return { element, show, draw };
}
