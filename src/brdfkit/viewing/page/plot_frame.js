// The frame of a plot: its title, settings and buttons, zoom, pointer and keys.

const PLOT_ZOOM = 1.25; // for a press of a button or key
const LARGEST_PLOT_ZOOM = 40;
const PLOT_PAN = 24; // pixels for a press of an arrow key with shift
const CURSOR_STEP = 8; // pixels for a press of an arrow key
const CLICK = 4; // pixels that a pointer may move in a click

/** Return the zoom of a plot: `at` takes places of the whole plot to the canvas, `back` the reverse. */
function createPlotZoom(redraw) {
  const zoom = { factor: 1, x: 0, y: 0 };
  zoom.at = ([x, y]) => [zoom.factor * x + zoom.x, zoom.factor * y + zoom.y];
  zoom.back = ([x, y]) => [(x - zoom.x) / zoom.factor, (y - zoom.y) / zoom.factor];
  zoom.by = (factor, [x, y]) => {
    const next = clamp(zoom.factor * factor, 1, LARGEST_PLOT_ZOOM);
    const [ox, oy] = zoom.back([x, y]);
    Object.assign(zoom, { factor: next, x: x - next * ox, y: y - next * oy });
    if (next === 1) Object.assign(zoom, { x: 0, y: 0 });
    redraw();
  };
  zoom.pan = (x, y) => {
    if (zoom.factor === 1) return;
    zoom.x += x;
    zoom.y += y;
    redraw();
  };
  zoom.reset = () => {
    Object.assign(zoom, { factor: 1, x: 0, y: 0 });
    redraw();
  };
  return zoom;
}

/**
 * Make the frame of a plot.
 *
 * `kind` has the plot's functions, of which only `draw` is needed. `draw(context, plot)` draws;
 * `read(place, plot)` returns words on a place; `grab(place, plot)` returns a function of later
 * places if a drag that begins there moves something, such as the light; `select(from, to, plot)`
 * returns the change of the state that selects a rectangle; `rows(plot)` the numbers for a file.
 * Places are [x, y] on the canvas; `plot.at` and `plot.back` zoom.
 */
function createPlotFrame(session, { name, label }, kind) {
  const canvas = make("canvas", { role: "img", "aria-label": label });
  const surface = make("div", {
    class: "surface", tabIndex: 0, role: "application",
    "aria-label": `${label}; arrow keys move the cursor, Enter selects, + − 0 zoom`,
  }, canvas);
  const readout = make("p", { class: "readout" });
  const settings = make("div", { class: "settings" });
  const zoom = createPlotZoom(draw);
  const plot = {
    session, name, canvas, zoom, at: zoom.at, back: zoom.back, content: null, curves: [], cursor: null,
    rectangle: null, selection: null, width: 0, height: 0,
    colours: readColours(canvas), draw: () => draw(),
  };
  const middle = () => [plot.width / 2, plot.height / 2];
  const buttons = make("div", { class: "plot-buttons" },
    makeButton("−", () => zoomBy(1 / PLOT_ZOOM, middle()), { title: "Zoom out (−)", "aria-label": `${label}: zoom out` }),
    makeButton("+", () => zoomBy(PLOT_ZOOM, middle()), { title: "Zoom in (+, wheel)", "aria-label": `${label}: zoom in` }),
    makeButton("⌂", reset, { title: "The whole plot (0, double click)", "aria-label": `${label}: the whole plot` }),
    makePlotMenu(plot, label, kind));
  const element = make("section", { class: `plot-frame plot-${name}`, "aria-label": label, hidden: true },
    make("header", {}, make("h3", {}, label), settings, buttons), surface, readout);
  let frame = 0;

  function zoomBy(factor, place) {
    if (kind.zoom) kind.zoom(factor, plot);
    else zoom.by(factor, kind.home?.(place, plot) ?? place);
    draw();
  }

  function reset() {
    kind.reset?.(plot);
    zoom.reset();
  }

  /** Draw in the next frame of the screen; many wishes are one. */
  function draw() {
    frame = frame || requestAnimationFrame(() => {
      frame = 0;
      paint();
    });
  }

  function paint() {
    if (!plot.content || element.hidden || !canvas.clientWidth) return;
    const context = startDrawing(canvas);
    [plot.width, plot.height] = [canvas.clientWidth, canvas.clientHeight];
    context.font = readFont(canvas, 11);
    plot.colours = readColours(canvas);
    if (plot.content.failed) {
      writeInMiddle(context, plot, plot.content.text);
      return;
    }
    kind.draw(context, plot);
    if (plot.rectangle) drawRectangle(context, plot);
    if (plot.cursor) drawCursor(context, plot);
  }

  plot.show = (content) => {
    [plot.content, plot.curves] = [content, content.curves];
    canvas.setAttribute("aria-label", content.text);
    if (!plot.cursor) readout.textContent = content.note || "";
    draw();
  };
  plot.say = (place) => {
    readout.textContent = (place && !plot.content?.failed && kind.read?.(place, plot)) || plot.content?.note || "";
  };
  followPlotPointer(plot, surface, kind, zoomBy, reset);
  followPlotKeys(plot, surface, kind, zoomBy, reset);
  const observer = new ResizeObserver(() => paint());
  observer.observe(surface);
  session.on("theme", draw);
  return {
    element, settings, plot,
    stop: () => {
      cancelAnimationFrame(frame);
      observer.disconnect();
    },
  };
}

/** Write in the middle of a plot why it is empty. */
function writeInMiddle(context, { width, height, colours }, text) {
  context.fillStyle = colours("soft");
  context.textAlign = "center";
  context.fillText(shorten(context, text, width - 16), width / 2, height / 2);
}

/** Return the place of a pointer on the canvas of a plot. */
function placeOf(event, { canvas }) {
  const { left, top } = canvas.getBoundingClientRect();
  return [event.clientX - left, event.clientY - top];
}

/** Let pointers zoom, pan, move what can be grabbed, and select. */
function followPlotPointer(plot, surface, kind, zoomBy, reset) {
  let move = null; // what the drag that is under way does
  const pinch = new Map(); // pointers of a touch, by id

  function begin(event) {
    const place = placeOf(event, plot);
    if (event.button === 1 || event.shiftKey) {
      let last = place;
      return (now) => {
        plot.zoom.pan(now[0] - last[0], now[1] - last[1]);
        last = now;
      };
    }
    const grabbed = kind.grab?.(place, plot);
    if (grabbed) return grabbed;
    if (!kind.select) return null;
    const select = (now) => {
      plot.rectangle = [place, now];
      plot.draw();
    };
    select.selects = true;
    return select;
  }

  surface.addEventListener("pointerdown", (event) => {
    if (event.button > 1 || !plot.content || plot.content.failed) return;
    surface.setPointerCapture(event.pointerId);
    pinch.set(event.pointerId, placeOf(event, plot));
    move = pinch.size > 1 ? null : begin(event);
    if (event.button === 1) event.preventDefault();
  });
  surface.addEventListener("pointermove", (event) => {
    const place = placeOf(event, plot);
    if (pinch.size === 2 && pinch.has(event.pointerId)) {
      const spread = () => Math.hypot(...[0, 1].map((k) => [...pinch.values()][0][k] - [...pinch.values()][1][k]));
      const before = spread();
      pinch.set(event.pointerId, place);
      if (before > 0) zoomBy(spread() / before, place);
      return;
    }
    if (move && pinch.has(event.pointerId)) move(place);
    const grabs = plot.content && !plot.content.failed && kind.canGrab?.(place, plot);
    surface.style.cursor = move || grabs ? "grab" : "";
    plot.say(place);
  });
  const end = (event) => {
    pinch.delete(event.pointerId);
    const done = move;
    move = null;
    if (!done) return;
    if (!done.selects) plot.session.finish();
    else if (plot.rectangle) {
      const [from, to] = plot.rectangle;
      const clicked = Math.hypot(to[0] - from[0], to[1] - from[1]) < CLICK;
      plot.rectangle = null;
      selectPlaces(plot, kind, from, clicked ? from : to);
    }
  };
  surface.addEventListener("lostpointercapture", end);
  surface.addEventListener("pointerleave", () => plot.say(plot.cursor));
  surface.addEventListener("dblclick", reset);
  surface.addEventListener("wheel", (event) => {
    event.preventDefault();
    zoomBy(Math.exp(-0.0015 * event.deltaY), placeOf(event, plot));
  }, { passive: false });
}

/** Select what lies between two places. */
function selectPlaces(plot, kind, from, to) {
  const changes = kind.select?.(from, to, plot);
  if (changes) plot.session.change(changes);
  plot.canvas.closest(".plot-frame").scrollIntoView({ block: "nearest" }); // which the list of numbers may move
  plot.draw();
}

/** Let the arrow keys move a cursor, Enter select, and + − 0 zoom. */
function followPlotKeys(plot, surface, kind, zoomBy, reset) {
  let corner = null; // where a rectangle of the keyboard began
  surface.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || !plot.content || plot.content.failed) return;
    const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    const cursor = plot.cursor || [plot.width / 2, plot.height / 2];
    if (way && kind.turn) kind.turn(way, plot);
    else if (way && event.shiftKey) plot.zoom.pan(-PLOT_PAN * way[0], -PLOT_PAN * way[1]);
    else if (way) {
      plot.cursor = [
        clamp(cursor[0] + CURSOR_STEP * way[0], 0, plot.width), clamp(cursor[1] + CURSOR_STEP * way[1], 0, plot.height),
      ];
      plot.rectangle = corner && [corner, plot.cursor];
    } else if (event.key === "Escape" && plot.session.state["plots.selection"]?.length) {
      plot.session.change({ "plots.selection": [] });
    } else if (event.key === "Enter" && kind.select && plot.cursor) {
      if (corner) selectPlaces(plot, kind, corner, cursor);
      corner = corner ? null : cursor;
      plot.rectangle = corner && [corner, cursor];
    } else if (event.key === "+" || event.key === "=") zoomBy(PLOT_ZOOM, cursor);
    else if (event.key === "-") zoomBy(1 / PLOT_ZOOM, cursor);
    else if (event.key === "0") reset();
    else return;
    event.preventDefault();
    plot.say(plot.cursor);
    plot.draw();
  });
  surface.addEventListener("blur", () => {
    [plot.cursor, corner, plot.rectangle] = [null, null, null];
    plot.draw();
  });
}

/** Draw the rectangle that is being selected. */
function drawRectangle(context, { rectangle: [[x0, y0], [x1, y1]], colours }) {
  context.strokeStyle = colours("accent");
  context.lineWidth = 1;
  context.setLineDash([4, 3]);
  context.strokeRect(Math.min(x0, x1), Math.min(y0, y1), Math.abs(x1 - x0), Math.abs(y1 - y0));
  context.setLineDash([]);
}

/** Draw the cross of the keyboard. */
function drawCursor(context, { cursor: [x, y], colours }) {
  context.strokeStyle = colours("accent");
  context.lineWidth = 2;
  strokeLine(context, [[x - 7, y], [x + 7, y]]);
  strokeLine(context, [[x, y - 7], [x, y + 7]]);
}

/** Make the menu that saves a plot as a picture, or its numbers as CSV. */
function makePlotMenu(plot, label, kind) {
  const menu = makeMenu("");
  menu.element.classList.add("plot-save");
  menu.button.setAttribute("aria-label", `${label}: save`);
  menu.button.title = "Save the plot";
  const named = (suffix) => `${plot.session.description?.title || "material"}-${plot.name}.${suffix}`;
  const csv = makeButton("Numbers (CSV)", () => {
    if (!plot.content || plot.content.failed) return;
    const text = kind.rows(plot).map((row) => row.join(",")).join("\n");
    download({ name: named("csv"), mime: "text/csv" }, [new TextEncoder().encode(`${text}\n`)]);
  });
  const png = makeButton("Picture (PNG)", () => plot.canvas.toBlob((blob) => {
    download({ name: named("png"), mime: "image/png" }, [blob]);
  }));
  menu.fill(...(kind.rows ? [png, csv] : [png]));
  return menu.element;
}
