// Turns the light about a material, by a drag on the picture or by the arrow keys.

const LIGHT_TURN = 0.5; // degrees for a pixel of a drag
const LIGHT_KEY_TURN = 5; // degrees for a press of an arrow key

/** Return the change that turns the light by an angle [degrees], as what is shown in it moves. */
function turnBy(session, degrees) {
  const turn = session.state["light.turn"] + degrees;
  return { "light.turn": roundNumber(turn - 360 * Math.round(turn / 360)) };
}

/** Let a drag on the stage turn the light, where that is what the picture is for. */
function turnLight(session, stage) {
  let before = null; // the pointer's place, while it drags

  stage.addEventListener("pointerdown", (event) => {
    if (!uses(session, "light") || event.button !== 0 || event.target.closest("button")) return;
    stage.setPointerCapture(event.pointerId);
    before = event.clientX;
  });
  stage.addEventListener("pointermove", (event) => {
    if (before === null || event.clientX === before) return;
    session.drag(turnBy(session, LIGHT_TURN * (event.clientX - before)));
    before = event.clientX;
  });
  stage.addEventListener("lostpointercapture", () => {
    if (before === null) return;
    before = null;
    session.finish();
  });
}

/** Return the function that turns the light by a key, and says whether the key is one for it. */
function makeLightKeys(session) {
  return (event) => {
    const way = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (!uses(session, "light") || event.ctrlKey || event.metaKey || event.altKey) return false;
    if (way) session.nudge(turnBy(session, way * LIGHT_KEY_TURN));
    else if (event.key === "r") {
      session.change({ "light.turn": session.description.state["light.turn"] });
    } else return false;
    return true;
  };
}
