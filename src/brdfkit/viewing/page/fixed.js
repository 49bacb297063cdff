// The buttons beside the sliders that fix a parameter, so that a fit keeps its value.

/** Put a button "fix" at each shape parameter where something can be fitted; `find` gives a control's parts. */
function offerFixing(session, find) {
  const FIXED = "fit.fixed";
  let buttons = new Map(); // of a parameter's name

  function build({ shapes = [] }) {
    buttons = new Map();
    if (!uses(session, "fit")) return;
    for (const name of shapes) {
      const parts = find(name);
      if (!parts) continue;
      const label = parts.row.querySelector(".name").textContent;
      const own = name.replace("model.", "");
      const button = makeButton("fix", () => {
        const fixed = session.state[FIXED];
        session.change({ [FIXED]: fixed.includes(own) ? fixed.filter((other) => other !== own) : [...fixed, own] });
      }, { class: "fix", "aria-label": `Fix ${label}`, title: "A fit keeps this value" });
      parts.row.querySelector(".extras").append(button);
      buttons.set(own, button);
    }
  }
  for (const type of ["open", "controls"]) session.on(type, build);
  session.on("state", (names) => {
    if (!names.has(FIXED)) return;
    for (const [name, button] of buttons) {
      button.setAttribute("aria-pressed", String(session.state[FIXED].includes(name)));
    }
  });
}
