// Shows the latest picture that Python has rendered, and tells Python that it is shown.

const RESIZE_DELAY = 150; // ms without a change after which Python hears of a new size

/**
 * Put the pictures on a stage; the settings "second" and "compare" say how there are several.
 *
 * `parts` are what is drawn, as `layOut` returns it, of which `place` is the first one's rectangle
 * [pixels of CSS]; `view` is how far it is enlarged, about which place. A picture has its own
 * proportions, so that a few pixels may lie beside the stage. `shown` says of the pictures left and
 * right their "name", and the settings that they "need", as Python does. `turns` exchanges the sides. Listeners to "drawn" receive the
 * picture.
 */
function createPicture(session, stage, turns) {
  const canvas = make("canvas", { class: "picture", "aria-hidden": "true" });
  const picture = {
    place: { x: 0, y: 0, width: 1, height: 1 }, parts: [], view: { zoom: 1, x: 0.5, y: 0.5 },
    described: null, shown: [null, null],
  };
  const latest = [null, null, null]; // for each side, and the differences, what createImageBitmap made
  const numbers = [-1, -1, -1];
  stage.append(canvas);

  picture.layOut = () => {
    const shown = findComparison(session.state) === "difference" && latest[2] ? 2 : 0;
    picture.parts = latest[0] ? layOut(stage, latest[0], session.state, picture.view, shown) : [];
    for (const part of picture.parts) part.side = turns.turn(part.side);
    if (latest[0]) picture.place = picture.parts[0].place;
  };

  picture.draw = () => {
    picture.layOut();
    const context = startDrawing(canvas);
    const sharp = picture.view.zoom >= SHARP_ZOOM;
    for (const part of picture.parts) {
      if (latest[part.side]) drawPart(context, latest[part.side], part, sharp);
    }
    session.emit("drawn", picture);
  };

  /** Show nothing at a side until its next picture comes. */
  function forget(side) {
    latest[side]?.close();
    latest[side] = null;
    if (side < 2) picture.shown[side] = null;
    if (side === 0) picture.described = null;
  }

  /** Decode a picture and draw it, unless a newer one is there already. */
  async function show(content, [bytes]) {
    const { number, side = 0, mime } = content;
    try {
      const bitmap = await createImageBitmap(new Blob([bytes], { type: mime }));
      if (number > numbers[side]) {
        forget(side);
        latest[side] = bitmap;
        numbers[side] = number;
        if (side < 2) {
          picture.described = content;
          picture.shown[side] = { name: content.name ?? "", needs: content.needs ?? {} };
        }
        picture.draw();
      } else bitmap.close();
    } finally {
      session.send({ type: "shown", number });
    }
  }

  /** Return where a pointer is in the picture: 0 to 1 from its top left. */
  picture.locate = (event) => {
    const { left, top } = stage.getBoundingClientRect();
    const [across, down] = [event.clientX - left, event.clientY - top];
    const under = picture.parts.findLast(({ area }) => across >= area.x);
    const { x, y, width, height } = under?.place || picture.place;
    return [(across - x) / width, (down - y) / height];
  };

  session.on("picture", show);
  session.on("difference", (content, bytes) => show({ ...content, side: 2 }, bytes));
  session.on("state", (names) => {
    if (names.has("background")) stage.style.backgroundColor = session.state.background;
    if (names.has("second") && !session.state.second) forget(1);
    if (findComparison(session.state) !== "difference") forget(2);
    if (["second", "wipe", "compare"].some((name) => names.has(name))) picture.draw();
  });
  session.on("open", ({ number }) => {
    for (const side of [0, 1, 2]) {
      if (numbers[side] > number) continue; // a picture of what was opened came first
      forget(side);
      numbers[side] = number;
    }
    picture.draw();
  });
  session.on("lost", () => numbers.fill(-1)); // another session of Python counts anew
  return picture;
}

/** Tell Python how large the stage is: first by `greet()`, later by "resize". */
function watchSize(session, stage, greet, draw) {
  let sent = null;
  let timer = 0;

  function tell() {
    const size = measurePixels(stage);
    if (sent && equal(size, sent)) return;
    if (sent) session.send({ type: "resize", ...size });
    else greet();
    sent = size;
  }
  const observer = new ResizeObserver(() => {
    if (!stage.clientWidth || !stage.clientHeight) return;
    draw();
    clearTimeout(timer);
    if (sent) timer = setTimeout(tell, RESIZE_DELAY);
    else tell();
  });
  observer.observe(stage);
  return () => {
    observer.disconnect();
    clearTimeout(timer);
  };
}

/** Tell Python whether anybody can see the picture, so that it need not render in vain. */
function watchVisibility(session, stage) {
  let inView = true;
  let told = true;
  function tell() {
    const visible = inView && !document.hidden;
    if (visible !== told) session.send({ type: "visible", visible });
    told = visible;
  }
  const observer = new IntersectionObserver(([entry]) => {
    inView = entry.isIntersecting;
    tell();
  });
  observer.observe(stage);
  document.addEventListener("visibilitychange", tell);
  return () => {
    observer.disconnect();
    document.removeEventListener("visibilitychange", tell);
  };
}
