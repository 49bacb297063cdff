// A handle on the ball: the place that the camera sees under the plots' angle θi, which a drag changes.

const PLOTS_OF_ONE_LIGHT = ["polar", "lobe"]; // whose θi the handle shows
const BALL_STEP = 1; // degrees for a press of an arrow key
const FIRST_WAY = 0.6; // rad below the right: which way from the ball's centre the handle lies at first

/** Put the handle on a stage. It is there while a ball and a plot of one direction of light are. */
function createBallHandle(session, stage, picture) {
  const handle = make("div", {
    class: "ball-handle", tabIndex: 0, role: "slider", hidden: true,
    title: "θi of the plots: the camera sees this place of the ball under θi. Drag it over the ball.",
    "aria-label": "θi of the plots, on the ball", "aria-valuemin": "0", "aria-valuemax": "89",
  });
  let way = FIRST_WAY;
  stage.append(handle);

  const findBall = () => picture.described?.overlay?.ball;

  function place() {
    const { state } = session;
    const ball = findBall();
    handle.hidden = !ball || !PLOTS_OF_ONE_LIGHT.some((name) => state[`plots.show.${name}`]);
    if (handle.hidden) return;
    const theta = state["plots.theta_i"];
    const from = Math.tan(Math.asin(ball.ratio * Math.sin((theta * Math.PI) / 180)));
    const { x, y, width, height } = picture.place;
    handle.style.left = `${x + width * (ball.x + ball.across * from * Math.cos(way))}px`;
    handle.style.top = `${y + height * (ball.y + ball.down * from * Math.sin(way))}px`;
    handle.setAttribute("aria-valuenow", Math.round(theta));
    handle.setAttribute("aria-valuetext", writeAngle(theta));
  }

  /** Return the angle [degrees] under which the camera sees the place of a pointer. */
  function readAngle(event) {
    const ball = findBall();
    const [u, v] = picture.locate(event);
    const [right, down] = [(u - ball.x) / ball.across, (v - ball.y) / ball.down];
    if (right || down) way = Math.atan2(down, right);
    const sine = Math.sin(Math.atan(Math.hypot(right, down))) / ball.ratio;
    return (Math.asin(Math.min(sine, 1)) * 180) / Math.PI;
  }

  const limit = (theta) => clamp(Math.round(2 * theta) / 2, 0, LARGEST_INCIDENCE);
  handle.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    event.stopPropagation(); // the light is not turned
    handle.setPointerCapture(event.pointerId);
  });
  handle.addEventListener("pointermove", (event) => {
    event.stopPropagation();
    if (handle.hasPointerCapture(event.pointerId) && findBall()) {
      session.drag({ "plots.theta_i": limit(readAngle(event)) });
    }
  });
  handle.addEventListener("lostpointercapture", session.finish);
  handle.addEventListener("keydown", (event) => {
    const step = { ArrowUp: 1, ArrowRight: 1, ArrowDown: -1, ArrowLeft: -1 }[event.key];
    if (!step) return;
    event.preventDefault();
    event.stopPropagation();
    session.nudge({ "plots.theta_i": limit(session.state["plots.theta_i"] + step * BALL_STEP) });
  });
  session.on("drawn", place);
  session.on("state", (names) => {
    if ([...names].some((name) => name.startsWith("plots."))) place();
  });
}
