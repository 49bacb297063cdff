// Moves the camera: by pointers, wheel and keys on the picture, and by buttons for the six axes.

const TURN = 0.4; // degrees for a pixel of a drag
const KEY_TURN = 5; // degrees for a press of an arrow key
const KEY_ZOOM = 1.1; // factor of the distance for a press of + or −
const KEY_PAN = 20; // pixels for a press of shift and an arrow key
const WHEEL_ZOOM = 0.001; // of the wheel's way, in the exponent

/** Return the six views along the axes: name, azimuth, elevation. */
function listViews(axes) {
  // At azimuth 0 the camera is in front: at +y of a patient (RAS), at −y of anything else
  if (axes === "RAS") {
    return [["L", 90, 0, "left"], ["R", -90, 0, "right"], ["A", 0, 0, "front"],
      ["P", 180, 0, "back"], ["S", 0, 90, "head"], ["I", 0, -90, "feet"]];
  }
  return [["−x", -90, 0], ["+x", 90, 0], ["−y", 0, 0], ["+y", 180, 0], ["−z", 0, -90], ["+z", 0, 90]];
}

/** Return the camera's moves, each of which gives the changes of the state that it means. */
function makeCameraMoves(session, picture) {
  const controlled = (name) => session.description?.controls.find((c) => c.name === name);

  /** Keep a value within the limits of its control. */
  function limit(name, value) {
    const { low = -Infinity, high = Infinity } = controlled(name) || {};
    return clamp(value, low, high);
  }

  function orbit(right, down) {
    const { state } = session;
    const azimuth = state["camera.azimuth"] - TURN * right;
    return {
      "camera.azimuth": roundNumber(azimuth - 360 * Math.round(azimuth / 360)),
      "camera.elevation": roundNumber(clamp(state["camera.elevation"] + TURN * down, -90, 90)),
    };
  }

  /** Move the target with the pointer, in the plane of the picture. */
  function pan(right, down) {
    const { state, description } = session;
    const turn = (state["camera.azimuth"] * Math.PI) / 180;
    const lift = (state["camera.elevation"] * Math.PI) / 180;
    const front = description?.volume?.axes === "RAS" ? 1 : -1;
    // Unit vectors to the right and upwards in the picture, see `camera_direction` in Python
    const across = [-front * Math.cos(turn), -front * Math.sin(turn), 0];
    const tilt = front * Math.sin(lift);
    const up = [tilt * Math.sin(turn), -tilt * Math.cos(turn), Math.cos(lift)];
    // The field of view is that of the picture's shorter side
    const shorter = Math.min(picture.place.width, picture.place.height);
    const half = state["camera.distance"] * Math.tan((state["camera.fov"] * Math.PI) / 360);
    const length = (2 * half) / shorter; // of a pixel, at the target
    return {
      "camera.target": state["camera.target"].map(
        (place, k) => place + length * (down * up[k] - right * across[k]),
      ),
    };
  }

  return {
    orbit,
    pan,
    zoom: (factor) => ({
      "camera.distance": limit("camera.distance", session.state["camera.distance"] * factor),
    }),
    widen: (factor) => ({ "camera.fov": limit("camera.fov", session.state["camera.fov"] * factor) }),
    look: (azimuth, elevation) => ({ "camera.azimuth": azimuth, "camera.elevation": elevation }),
    /** Return to the camera with which the page was opened. */
    home: () => Object.fromEntries(
      Object.entries(session.description.state).filter(([name]) => name.startsWith("camera.")),
    ),
  };
}

/** Return whether what is shown has a camera that this page may move. */
function hasCamera(session) {
  return "camera.azimuth" in session.state;
}

/** Let pointers on the stage move the camera: one orbits, or pans; two zoom and pan. */
function followPointers(session, stage, moves) {
  const pointers = new Map(); // id → [x, y]
  let pans = false;

  stage.addEventListener("pointerdown", (event) => {
    if (event.target.closest("button") || !hasCamera(session)) return;
    stage.setPointerCapture(event.pointerId);
    pans = event.shiftKey || event.button > 0;
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
    if (event.button === 1) event.preventDefault(); // no scrolling by the middle button
  });

  stage.addEventListener("pointermove", (event) => {
    const before = pointers.get(event.pointerId);
    if (!before) return;
    const [right, down] = [event.clientX - before[0], event.clientY - before[1]];
    if (!right && !down) return;
    const others = [...pointers].filter(([id]) => id !== event.pointerId);
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
    if (!others.length) {
      session.drag(pans ? moves.pan(right, down) : moves.orbit(right, down));
      return;
    }
    const [x, y] = others[0][1];
    const apart = (place) => Math.max(Math.hypot(place[0] - x, place[1] - y), 1);
    session.drag(moves.zoom(apart(before) / apart([event.clientX, event.clientY])));
    session.drag(moves.pan(right / 2, down / 2));
  });

  stage.addEventListener("lostpointercapture", (event) => {
    if (pointers.delete(event.pointerId) && !pointers.size) session.finish();
  });
  stage.addEventListener("contextmenu", (event) => event.preventDefault());
  stage.addEventListener("dblclick", (event) => {
    if (!event.target.closest("button") && hasCamera(session)) session.change(moves.home());
  });
  stage.addEventListener("wheel", (event) => {
    if (!hasCamera(session)) return;
    event.preventDefault();
    const way = event.deltaY * (event.deltaMode === WheelEvent.DOM_DELTA_PIXEL ? 1 : 16);
    const factor = Math.exp(WHEEL_ZOOM * way);
    session.nudge(event.ctrlKey ? moves.widen(factor) : moves.zoom(factor));
  }, { passive: false });
}

/** Return the function that moves the camera by a key, and says whether the key is one for it. */
function makeCameraKeys(session, moves) {
  return (event) => {
    const arrow = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    if (event.ctrlKey || event.metaKey || event.altKey || !hasCamera(session)) return false;
    if (arrow && event.shiftKey) session.nudge(moves.pan(KEY_PAN * arrow[0], KEY_PAN * arrow[1]));
    else if (arrow) session.nudge(moves.orbit(...arrow.map((way) => (KEY_TURN * way) / TURN)));
    else if (event.key === "+" || event.key === "=") session.nudge(moves.zoom(1 / KEY_ZOOM));
    else if (event.key === "-" || event.key === "_") session.nudge(moves.zoom(KEY_ZOOM));
    else if (event.key === "r") session.change(moves.home());
    else if ("123456".includes(event.key)) {
      const [, azimuth, elevation] = listViews(session.description.volume?.axes)[event.key - 1];
      session.change(moves.look(azimuth, elevation));
    } else return false;
    return true;
  };
}

/** Show the picture on the whole screen, or beside the panels again. */
function switchFullScreen(stage) {
  if (document.fullscreenElement) document.exitFullscreen();
  else if (document.fullscreenEnabled) stage.requestFullscreen();
}

/** Make the row of buttons for the views along the axes, the first view and the whole screen. */
function makeViewButtons(session, stage, moves) {
  const full = makeButton("⤢", () => switchFullScreen(stage), {
    "aria-label": "Picture on the whole screen", title: "Picture on the whole screen (f)",
  });
  const row = make("div", { class: "views", role: "group" });
  session.on("open", ({ volume }) => {
    const whole = document.fullscreenEnabled ? [full] : [];
    row.setAttribute("aria-label", hasCamera(session) ? "View from" : "View");
    if (!hasCamera(session)) return row.replaceChildren(...whole);
    const buttons = listViews(volume?.axes).map(([name, azimuth, elevation, side], k) => {
      const label = side ? `${name}: view from the patient's ${side}` : `${name}: view from this side`;
      const onclick = () => session.change(moves.look(azimuth, elevation));
      return makeButton(name, onclick, { "aria-label": label, title: `${label} (${k + 1})` });
    });
    const home = makeButton("⌂", () => session.change(moves.home()), {
      "aria-label": "View as at the start", title: "View as at the start (r)",
    });
    return row.replaceChildren(...buttons, home, ...whole);
  });
  return row;
}
