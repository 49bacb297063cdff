// Compares the pictures of both sides: by the wipe, in turn, by the map of differences, or in halves.

const FLICKER_TIME = 500; // ms for which a side is shown while both are shown in turn
const LIKE = 1.1; // proportions that differ less are the same, as Python chooses them in steps
const SHARP_ZOOM = 2; // from which on pixels are shown as squares

/** Return how both sides are compared; "" without a second one. */
function findComparison({ second, compare = "wipe" }) {
  return second ? compare : "";
}

/** Return the halves of a stage, or the whole of it. */
function divideStage({ clientWidth: width, clientHeight: height }, comparison) {
  if (comparison !== "beside") return [{ x: 0, y: 0, width, height }];
  return [0, 1].map((side) => ({ x: (side * width) / 2, y: 0, width: width / 2, height }));
}

/**
 * Return where a picture of some proportions is in an area: it covers a stage of nearly the same, as
 * Python chooses them; elsewhere, as in a half, its middle square fits, so that a stage that becomes
 * lower shows the same things, smaller, as the next picture will. `view` says how far it is enlarged, and which place of it is in the middle.
 */
function placePicture({ width, height }, area, view, whole) {
  const cover = Math.max(area.width / width, area.height / height);
  const fit = Math.min(area.width, area.height) / Math.min(width, height);
  const scale = view.zoom * (whole && cover < LIKE * fit ? cover : fit);
  const size = { width: scale * width, height: scale * height };
  return {
    x: area.x + area.width / 2 - view.x * size.width,
    y: area.y + area.height / 2 - view.y * size.height,
    ...size,
  };
}

/**
 * Return what is drawn on a stage, in this order: the side of each picture, its place, and the area
 * that shows it. `shown` is the side that is shown alone where one is.
 */
function layOut(stage, size, state, view, shown) {
  const comparison = findComparison(state);
  const areas = divideStage(stage, comparison);
  const parts = areas.map((area, k) => ({
    side: areas.length > 1 ? k : shown, area,
    place: placePicture(size, area, view, areas.length === 1),
  }));
  if (comparison === "wipe") {
    const [{ area, place }] = parts;
    const edge = clamp(place.x + state.wipe * place.width, 0, area.width);
    const right = { ...area, x: edge, width: area.width - edge };
    return [{ side: 0, area, place }, { side: 1, area: right, place }];
  }
  return parts;
}

/** Draw a picture in its area alone. */
function drawPart(context, bitmap, { area, place }, sharp) {
  context.save();
  context.beginPath();
  context.rect(area.x, area.y, area.width, area.height);
  context.clip();
  context.imageSmoothingEnabled = !sharp;
  context.imageSmoothingQuality = "high";
  context.drawImage(bitmap, place.x, place.y, place.width, place.height);
  context.restore();
}

/**
 * Choose which side is shown where both are shown in turn, and exchange both while a key is held.
 *
 * `turn(side)` is the side to be shown in place of another one.
 */
function createTurns(session) {
  const still = window.matchMedia("(prefers-reduced-motion: reduce)");
  let odd = false; // of the turns by time
  let held = false; // the key
  const timer = setInterval(() => {
    const runs = findComparison(session.state) === "flicker" && !still.matches && !document.hidden;
    if (odd === (runs && !odd)) return;
    odd = runs && !odd;
    session.emit("redraw");
  }, FLICKER_TIME);

  function hold(wanted) {
    if (held === wanted || !session.state.second) return;
    held = wanted;
    session.emit("redraw");
  }
  const release = ({ type, key }) => (type === "blur" || key.toLowerCase() === "x") && hold(false);
  for (const type of ["keyup", "blur"]) window.addEventListener(type, release);
  return {
    turn: (side) => (side < 2 && odd !== held ? 1 - side : side),
    key: (event) => {
      if (event.key !== "x" || event.ctrlKey || event.metaKey || event.altKey) return false;
      hold(true);
      return true;
    },
    stop: () => {
      clearInterval(timer);
      for (const type of ["keyup", "blur"]) window.removeEventListener(type, release);
    },
  };
}

/** Write over the picture which side it shows, and what the colours of the differences mean. */
function createCaptions(session, stage, picture) {
  const names = [0, 1].map(() => make("span", { class: "caption", "aria-hidden": "true" }));
  const bar = make("span", { class: "bar" });
  const top = make("span");
  const sum = make("span", { class: "sum", role: "status" });
  const scale = make("div", { class: "scale", hidden: true },
    make("span", { title: "Difference in colour, CIEDE2000; 1 is just visible" }, "ΔE 0"), bar, top, sum);
  stage.append(...names, scale);
  session.on("difference", ({ mean, upper, top: value, colours }) => {
    top.textContent = value;
    sum.textContent = `mean ${mean.toPrecision(3)}, 95 % below ${upper.toPrecision(3)}`;
    bar.style.backgroundImage = `linear-gradient(to right, ${colours.join(", ")})`;
  });
  session.on("drawn", () => {
    const comparison = findComparison(session.state);
    names.forEach((name, k) => {
      const part = comparison === "wipe" || comparison === "" ? null : picture.parts[k];
      name.hidden = !part || part.side === 2;
      if (name.hidden) return;
      const shown = picture.shown[part.side]?.name ?? "";
      name.textContent = comparison === "difference" ? "The ΔE map comes …" : shown;
      name.style.left = `${part.area.x + part.area.width / 2}px`;
    });
    scale.hidden = picture.parts[0]?.side !== 2;
  });
}
