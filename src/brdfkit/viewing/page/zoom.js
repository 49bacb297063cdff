// Enlarges the picture of what has no camera to fly with: about the pointer, all sides in step.

const LARGEST_ZOOM = 32;
const ZOOM_STEP = 1.25; // for a press of + or −

/** Return a view of a picture that may be enlarged; `draw` shows it. */
function createZoom(session, stage, picture) {
  const view = picture.view;

  /** Keep the picture where it covers its area, or in the middle. */
  function limit() {
    const { area, place } = picture.parts[0];
    for (const [axis, side] of [["x", "width"], ["y", "height"]]) {
      const half = area[side] / (2 * place[side]);
      view[axis] = half < 0.5 ? clamp(view[axis], half, 1 - half) : 0.5;
    }
  }

  /** Enlarge by a factor about a place, which is a share of the picture. */
  function zoom(factor, [u, v]) {
    if (!picture.parts.length) return;
    const before = view.zoom;
    view.zoom = clamp(before * factor, 1, LARGEST_ZOOM);
    const share = before / view.zoom;
    [view.x, view.y] = [u + (view.x - u) * share, v + (view.y - v) * share];
    show();
  }

  function pan(right, down) {
    const { width, height } = picture.place;
    view.x -= right / width;
    view.y -= down / height;
    show();
  }

  function reset() {
    [view.zoom, view.x, view.y] = [1, 0.5, 0.5];
    picture.draw();
  }

  function show() {
    picture.layOut();
    limit();
    picture.draw();
  }

  const isOn = () => Boolean(session.description) && !hasCamera(session);
  let before = null; // the pointer's place, while it drags

  stage.addEventListener("pointerdown", (event) => {
    const pans = event.button === 1 || (event.button === 0 && event.shiftKey);
    if (!isOn() || !pans || event.target.closest("button, .notice")) return;
    event.preventDefault(); // no scrolling by the middle button
    event.stopImmediatePropagation();
    stage.setPointerCapture(event.pointerId);
    before = [event.clientX, event.clientY];
  }, true);
  stage.addEventListener("pointermove", (event) => {
    if (!before) return;
    pan(event.clientX - before[0], event.clientY - before[1]);
    before = [event.clientX, event.clientY];
  });
  stage.addEventListener("lostpointercapture", () => (before = null));
  stage.addEventListener("wheel", (event) => {
    if (!isOn()) return;
    event.preventDefault();
    const way = event.deltaY * (event.deltaMode === WheelEvent.DOM_DELTA_PIXEL ? 1 : 16);
    zoom(Math.exp(-WHEEL_ZOOM * 2 * way), picture.locate(event));
  }, { passive: false });
  stage.addEventListener("dblclick", (event) => {
    if (isOn() && !event.target.closest("button")) reset();
  });

  return (event) => {
    if (!isOn() || event.ctrlKey || event.metaKey || event.altKey) return false;
    const middle = [view.x, view.y];
    if (event.key === "+" || event.key === "=") zoom(ZOOM_STEP, middle);
    else if (event.key === "-" || event.key === "_") zoom(1 / ZOOM_STEP, middle);
    else if (event.key === "0") reset();
    else return false;
    return true;
  };
}
