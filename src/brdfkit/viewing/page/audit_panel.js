// The audit of a measured file: what it is, what is doubtful in it, and buttons that mend it.

const MENDS = "mend."; // before the names of the mends in the state

/** Make a finding: its title, why, where, and the button that mends it and shows both. */
function makeFinding(session, { title, text, where, mend, label }) {
  const show = () => session.change({ [mend]: true, renderer: "measured", second: "file" });
  return make("li", {},
    make("strong", {}, title),
    make("p", {}, `${text.charAt(0).toUpperCase()}${text.slice(1)}.`),
    ...(where ? [make("p", { class: "where" }, `At: ${where}`)] : []),
    ...(mend ? [makeButton(label, show, { class: "main" })] : []));
}

/** Make the part of a panel with the audit, which Python computes after the first picture. */
function createAuditPanel(session) {
  const file = make("p", { class: "file" });
  const findings = make("ul");
  const verdict = make("p", { role: "status" });
  const element = make("div", { class: "audit", hidden: true }, file, verdict, findings);
  let asked = false;

  function ask() {
    asked = true;
    verdict.textContent = "The file is examined …";
    session.send({ type: "audit" });
  }
  session.on("open", () => {
    element.hidden = !uses(session, "audit");
    asked = element.hidden;
    file.textContent = verdict.textContent = "";
    findings.replaceChildren();
  });
  session.on("state", (names) => {
    if ([...names].some((name) => name.startsWith(MENDS))) asked = element.hidden;
  });
  session.on("progress", ({ samples }) => samples && !asked && ask());
  session.on("audit", (content) => {
    file.replaceChildren(...content.file.flatMap((line) => [line, make("br")]));
    findings.replaceChildren(...content.findings.map((finding) => makeFinding(session, finding)));
    const count = content.findings.length;
    verdict.textContent = count === 0 ? "Nothing doubtful was found."
      : count === 1 ? "One thing is doubtful:" : `${count} things are doubtful:`;
  });
  return element;
}
