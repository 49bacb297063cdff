// Shows the latest picture that Python has rendered, and tells Python that it is shown.

const RESIZE_DELAY = 150; // ms without a change after which Python hears of a new size

/**
 * Put the picture on a stage; `second` names the setting that puts another one right of the wipe.
 *
 * `place` is the rectangle of the picture on the stage [pixels of CSS]; it has the picture's own
 * proportions. Listeners to "drawn" receive Python's description of the picture.
 */
function createPicture(session, stage) {
  const canvas = make("canvas", { class: "picture", "aria-hidden": "true" });
  const picture = { place: { x: 0, y: 0, width: 1, height: 1 }, described: null };
  const latest = [null, null]; // for each side, what createImageBitmap made
  const numbers = [-1, -1];
  stage.append(canvas);

  /** Fit a picture of some proportions into the stage. */
  function fit({ width, height }) {
    const scale = Math.min(stage.clientWidth / width, stage.clientHeight / height);
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
      fit(latest[0]);
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

  /** Decode a picture and draw it, unless a newer one is there already. */
  async function show(content, [bytes]) {
    const { number, side = 0, mime } = content;
    try {
      const bitmap = await createImageBitmap(new Blob([bytes], { type: mime }));
      if (number >= numbers[side]) {
        latest[side]?.close();
        latest[side] = bitmap;
        numbers[side] = number;
        picture.described = content;
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
    if (names.has("second") && !session.state.second) {
      latest[1]?.close();
      latest[1] = null;
    }
    if (names.has("second") || names.has("wipe")) picture.draw();
  });
  session.on("open", () => numbers.fill(-1));
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
