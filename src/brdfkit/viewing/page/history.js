// Undo, redo and reset, and the state in the page's address.

const ADDRESS_DELAY = 300; // ms without a change after which the address follows the state

/** Return the state with the name of what it shows, the subject, or null before any is known. */
function nameState({ state, description }) {
  return description && { ...state, subject: description.subject };
}

/** Return the state that an address such as `…#state=eyJ…` carries, null without one. */
function readAddress(hash) {
  const coded = new URLSearchParams(hash.replace(/^#/, "")).get("state");
  if (!coded) return null;
  try {
    const letters = atob(coded.replace(/-/g, "+").replace(/_/g, "/"));
    const bytes = Uint8Array.from(letters, (letter) => letter.charCodeAt(0));
    return JSON.parse(new TextDecoder().decode(bytes));
  } catch {
    return "damaged"; // which Python says, because it is no state
  }
}

/** Return the end of an address that carries a state: base64url of its JSON. */
function writeAddress(state) {
  let letters = "";
  for (const byte of new TextEncoder().encode(JSON.stringify(state))) letters += String.fromCharCode(byte);
  const coded = btoa(letters).replace(/\+/g, "-").replace(/\//g, "_").replace(/=+$/, "");
  return `#state=${coded}`;
}

/** Keep the address equal to the state; only the server's page owns its address. */
function keepAddress(session) {
  let timer = 0;
  session.on("state", () => {
    clearTimeout(timer);
    timer = setTimeout(() => history.replaceState(null, "", writeAddress(nameState(session))), ADDRESS_DELAY);
  });
  return () => clearTimeout(timer);
}

/** Make the buttons Undo, Redo and Reset. */
function makeHistoryButtons(session) {
  const undo = makeButton("Undo", () => session.command("undo"), { title: "Ctrl+Z", disabled: true });
  const redo = makeButton("Redo", () => session.command("redo"), { title: "Ctrl+Y", disabled: true });
  const reset = makeButton("Reset", () => session.command("reset"), {
    title: "All settings as at the start",
  });
  session.on("history", ({ can_undo, can_redo }) => {
    undo.disabled = !can_undo;
    redo.disabled = !can_redo;
  });
  return [undo, redo, reset];
}

/** Undo and redo by the usual keys wherever the focus is, except where words are typed. */
function listenForUndo(session, element) {
  element.addEventListener("keydown", (event) => {
    const { target } = event;
    const takesWords = takesText(target) && target.role !== "spinbutton";
    if (!(event.ctrlKey || event.metaKey) || event.altKey || takesWords) return;
    const key = event.key.toLowerCase();
    const type = key === "y" || (key === "z" && event.shiftKey) ? "redo" : key === "z" ? "undo" : "";
    if (!type) return;
    event.preventDefault();
    session.command(type);
  });
}
