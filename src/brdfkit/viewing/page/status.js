// The status line, and the notices that stand over the picture until the next action.

// Types of messages to Python that are no action of the user's, or none that an error is about
const NO_ACTIONS = new Set([
  "hello", "shown", "probe", "probe_slice", "resize", "visible", "pause", "cancel", "audit", "errors",
]);

/** Write the size of a volume: 256 × 256 × 128 voxels of 0.8 × 0.8 × 1.6 mm. */
function writeVolume({ size, spacing, unit }) {
  const by = (numbers) => numbers.map(writeNumber).join(" × ");
  const voxels = `${by(size)} voxels`;
  if (!spacing) return voxels;
  const same = spacing.every((length) => length === spacing[0]);
  return `${voxels} of ${same ? writeNumber(spacing[0]) : by(spacing)} ${unit || ""}`.trim();
}

/** Make the status line. Only its message is announced: samples and values change all the time. */
function createStatus(session) {
  const message = make("span", { class: "message", role: "status", "aria-live": "polite" });
  const bar = make("progress", { hidden: true, "aria-label": "Progress", max: 1 });
  const cancel = makeButton("Cancel", () => session.send({ type: "cancel" }), {
    title: "Escape", hidden: true,
  });
  const [size, samples, value] = ["size", "samples", "value"].map((name) => make("span", { class: name }));
  let busy = "";
  let phase = "";
  let statistics = "";
  let preparing = false; // then the statistics are of another picture

  function say() {
    const text = busy || phase;
    // Saying the same again would be announced again
    if (message.textContent !== text) message.textContent = text;
  }

  session.on("open", ({ volume }) => {
    size.textContent = volume ? writeVolume(volume) : "";
    value.textContent = "";
  });
  session.on("progress", ({ samples: count, per_second, noise, paused, converged }) => {
    const rate = per_second ? `${writeNumber(per_second)}/s` : "";
    statistics = [`${writeNumber(count)} ${count === 1 ? "sample" : "samples"}`, rate, noise]
      .filter(Boolean).join(" · ");
    phase = paused ? "paused" : converged ? "converged" : "";
    if (!preparing) samples.textContent = statistics;
    say();
  });
  session.on("preparing", (now) => {
    if (now === preparing) return;
    preparing = now;
    if (now) statistics = phase = "";
    samples.textContent = statistics;
    say();
  });
  let asks = false; // not after the pointer has left, when an answer may still come
  session.on("sent", ({ type }) => (asks = asks || type.startsWith("probe")));
  session.on("left", () => {
    asks = false;
    value.textContent = "";
  });
  session.on("probe", ({ text }) => asks && (value.textContent = text || ""));
  session.on("busy", ({ text, fraction, can_cancel }) => {
    busy = text || "";
    bar.hidden = !busy;
    cancel.hidden = !(busy && can_cancel);
    if (typeof fraction === "number") bar.value = fraction;
    else bar.removeAttribute("value");
    say();
  });
  session.on("cancel", () => cancel.hidden || cancel.click());
  return make("div", { class: "status" }, size, samples, message, bar, cancel, value);
}

/** Put notices on the stage: errors, until the next action, and the loss of the connection. */
function createNotices(session, stage) {
  const notices = make("div", { class: "notices" });
  stage.append(notices);
  // The camera does not follow pointers on a notice
  for (const type of ["pointerdown", "dblclick"]) {
    notices.addEventListener(type, (event) => event.stopPropagation());
  }

  function show(text, ...buttons) {
    const notice = make("div", { class: "notice", role: "alert" }, make("p", {}, text), ...buttons);
    notices.replaceChildren(notice);
  }
  function close() {
    notices.replaceChildren();
    stage.focus(); // which the button had, and would lose
  }
  let passes = false; // at the next action
  session.on("error", ({ text }) => {
    show(text, makeButton("Close", close));
    passes = true;
  });
  session.on("sent", ({ type, moving }) => {
    if (passes && !moving && !NO_ACTIONS.has(type)) notices.replaceChildren();
  });
  session.on("open", () => notices.replaceChildren());
  session.on("lost", () => {
    const { reconnect } = session.model;
    const buttons = reconnect ? [makeButton("Reconnect", () => reconnect(), { class: "main" })] : [];
    show("The connection to Python is lost.", ...buttons);
    passes = false;
  });
}
