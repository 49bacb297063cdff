// The audit of a measured file: what it is, what is doubtful in it, and buttons that mend it.

const MENDS = "mend."; // before the names of the mends in the state

/** Return the names of the mends that a state sets, as a text. */
function listMends(state) {
  return Object.keys(state).filter((name) => name.startsWith(MENDS) && state[name]).join(" ");
}

/** Make a finding: its title, why, where, and the button that mends it. */
function makeFinding(session, { title, text, where, mend, label }) {
  return make("li", {},
    make("strong", {}, title),
    make("p", {}, `${text.charAt(0).toUpperCase()}${text.slice(1)}.`),
    ...(where ? [make("p", { class: "where" }, `At: ${where}`)] : []),
    ...(mend ? [makeButton(label, () => session.change({ [mend]: true }), { class: "main" })] : []));
}

/** Make what says whether the file is shown beside the mended one, with a button for the other. */
function makeFileSwitch(session) {
  const text = make("p");
  const button = makeButton("", () => {
    const isShown = session.state.second === "file";
    session.change(isShown ? { second: "model" } : { renderer: "measured", second: "file" });
  });
  const element = make("div", { class: "file-switch", hidden: true }, text, button);
  session.on("state", () => {
    const { state } = session;
    const isShown = state.second === "file";
    element.hidden = !listMends(state);
    text.textContent = isShown ? "Right of the wipe is the file as it says, not the model." : "";
    button.textContent = isShown ? `Show ${state.model} there` : "Show the file as it says";
  });
  return element;
}

/** Make the part of a panel with the audit, which Python computes when a picture of it is shown. */
function createAuditPanel(session) {
  const file = make("p", { class: "file" });
  const findings = make("ul");
  const verdict = make("p", { role: "status" });
  const element = make("div", { class: "audit", hidden: true }, file, verdict, findings, makeFileSwitch(session));
  let asked = true;
  let mends = "";

  /** Say that another state of the file is examined, of which nothing is known yet. */
  function begin() {
    asked = element.hidden;
    mends = listMends(session.state);
    verdict.textContent = mends ? "Examining the mended file …" : "Examining the file …";
    for (const button of findings.querySelectorAll("button")) button.disabled = true;
  }
  session.on("open", () => {
    element.hidden = !uses(session, "audit");
    file.textContent = "";
    findings.replaceChildren();
    begin();
  });
  session.on("state", () => listMends(session.state) !== mends && begin());
  session.on("preparing", (now) => {
    if (now || asked) return;
    asked = true;
    session.send({ type: "audit" });
  });
  session.on("audit", (content) => {
    if (!asked) return; // it is of the file as it was before
    file.replaceChildren(...content.file.flatMap((line) => [line, make("br")]));
    findings.replaceChildren(...content.findings.map((finding) => makeFinding(session, finding)));
    const count = content.findings.length;
    verdict.textContent = count === 0 ? "Nothing doubtful was found."
      : count === 1 ? "One thing is doubtful:" : `${count} things are doubtful:`;
  });
  return element;
}
