// Moves the light and the camera about a material, by a drag on the picture or by keys.

const LIGHT_TURN = 0.5; // degrees for a pixel of a drag
const LIGHT_KEY_TURN = 5; // degrees for a press of an arrow key
const STEEPEST_VIEW = 89; // degrees
const LIGHT_NAMES = ["light.turn", "light.lamp_azimuth", "light.lamp_elevation", "view.azimuth", "view.elevation"];

/** Return an angle between -180 and 180 [degrees]. */
function wrapAngle(angle) {
  return roundNumber(angle - 360 * Math.round(angle / 360));
}

/** Return whether the light is a lamp at a place. */
function hasLamp({ state }) {
  return state["light.environment"] === "lamp";
}

/** Return the change that moves the light with a pointer, by angles [degrees] to the right and down. */
function moveLight(session, right, down) {
  const { state } = session;
  if (!hasLamp(session)) return { "light.turn": wrapAngle(state["light.turn"] + right) };
  return {
    "light.lamp_azimuth": wrapAngle(state["light.lamp_azimuth"] + right),
    "light.lamp_elevation": roundNumber(clamp(state["light.lamp_elevation"] - down, -90, 90)),
  };
}

/** Return the change that moves the camera about the shape, by angles [degrees]. */
function moveView(session, right, down) {
  const { state } = session;
  const elevation = clamp(state["view.elevation"] + down, -STEEPEST_VIEW, STEEPEST_VIEW);
  return {
    "view.azimuth": wrapAngle(state["view.azimuth"] - right),
    "view.elevation": roundNumber(elevation),
  };
}

/** Let a drag on the stage move the light, and the right button the camera, where they are of use. */
function turnLight(session, stage) {
  let before = null; // the pointer's place, while it drags
  let move = moveLight;

  stage.addEventListener("pointerdown", (event) => {
    const { button, target } = event;
    if (!uses(session, "light") || button === 1 || target.closest("button")) return;
    stage.setPointerCapture(event.pointerId);
    before = [event.clientX, event.clientY];
    move = button === 2 ? moveView : moveLight;
  });
  stage.addEventListener("pointermove", (event) => {
    if (before === null) return;
    const [right, down] = [event.clientX - before[0], event.clientY - before[1]];
    if (!right && !down) return;
    session.drag(move(session, LIGHT_TURN * right, LIGHT_TURN * down));
    before = [event.clientX, event.clientY];
  });
  stage.addEventListener("lostpointercapture", () => {
    if (before === null) return;
    before = null;
    session.finish();
  });
}

/** Return the function that moves light and camera by a key, and says whether the key is one for it. */
function makeLightKeys(session) {
  return (event) => {
    const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    if (!uses(session, "light") || event.ctrlKey || event.metaKey || event.altKey) return false;
    if (way) {
      const move = event.shiftKey ? moveView : moveLight;
      session.nudge(move(session, ...way.map((sign) => sign * LIGHT_KEY_TURN)));
    } else if (event.key === "r") {
      const first = session.description.state;
      session.change(Object.fromEntries(LIGHT_NAMES.map((name) => [name, first[name]])));
    } else return false;
    return true;
  };
}

/** Mark where the lamp shines on the shape from straight above; hollow where that is behind it. */
function createLampMark(session, stage, picture) {
  const mark = make("span", { class: "lamp", hidden: true, "aria-hidden": "true" });
  stage.append(mark);
  session.on("drawn", () => {
    const place = picture.described?.overlay?.lamp;
    mark.hidden = !place || !hasLamp(session);
    if (mark.hidden) return;
    const [x, y, isSeen] = place;
    mark.classList.toggle("behind", !isSeen);
    mark.style.left = `${picture.place.x + x * picture.place.width}px`;
    mark.style.top = `${picture.place.y + y * picture.place.height}px`;
  });
}
