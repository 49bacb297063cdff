// Shows the latest picture that Python has rendered, and tells Python that it is shown.

const RESIZE_DELAY = 150; // ms without a change after which Python hears of a new size

/**
 * Put the picture on a stage; `second` names the setting that puts another one right of the wipe.
 *
 * `place` is the rectangle of the picture on the stage [pixels of CSS], which it covers; it has the
 * picture's own proportions, so that a few pixels may lie beside the stage. `renderers` are those
 * of the pictures that are shown left and right. Listeners to "drawn" receive the picture.
 */
function createPicture(session, stage) {
  const canvas = make("canvas", { class: "picture", "aria-hidden": "true" });
  const picture = {
    place: { x: 0, y: 0, width: 1, height: 1 }, described: null, renderers: [undefined, undefined],
  };
  const latest = [null, null]; // for each side, what createImageBitmap made
  const numbers = [-1, -1];
  stage.append(canvas);

  /** Cover the stage with a picture of some proportions. */
  function cover({ width, height }) {
    const scale = Math.max(stage.clientWidth / width, stage.clientHeight / height);
    picture.place = {
      x: (stage.clientWidth - scale * width) / 2,
      y: (stage.clientHeight - scale * height) / 2,
      width: scale * width,
      height: scale * height,
    };
  }

  picture.draw = () => {
    const context = startDrawing(canvas);
    if (latest[0]) {
      cover(latest[0]);
      const { x, y, width, height } = picture.place;
      context.imageSmoothingQuality = "high";
      context.drawImage(latest[0], x, y, width, height);
      if (latest[1] && session.state.second) {
        const edge = x + session.state.wipe * width;
        context.save();
        context.beginPath();
        context.rect(edge, y, x + width - edge, height);
        context.clip();
        context.drawImage(latest[1], x, y, width, height);
        context.restore();
      }
    }
    session.emit("drawn", picture);
  };

  /** Show nothing at a side until its next picture comes. */
  function forget(side) {
    latest[side]?.close();
    latest[side] = null;
    picture.renderers[side] = undefined;
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
        picture.described = content;
        picture.renderers[side] = content.overlay?.renderers?.[side] ?? "";
        picture.draw();
      } else bitmap.close();
    } finally {
      session.send({ type: "shown", number });
    }
  }

  /** Return where a pointer is in the picture: 0 to 1 from its top left. */
  picture.locate = (event) => {
    const { left, top } = stage.getBoundingClientRect();
    const { x, y, width, height } = picture.place;
    return [(event.clientX - left - x) / width, (event.clientY - top - y) / height];
  };

  session.on("picture", show);
  session.on("state", (names) => {
    if (names.has("background")) stage.style.backgroundColor = session.state.background;
    if (names.has("second") && !session.state.second) forget(1);
    if (names.has("second") || names.has("wipe")) picture.draw();
  });
  session.on("open", ({ number }) => {
    for (const side of [0, 1]) {
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
