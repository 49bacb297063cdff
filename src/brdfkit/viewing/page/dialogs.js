// Dialogs: a text to copy, the keys, and the form for files of voxels without a header.

/**
 * Return the sections of the help: the part of the page that each is about, "" for all; its title;
 * what keys and pointers do. `views` names the buttons of the views.
 */
const listKeys = (views) => [
  ["camera", "Picture", [
    ["drag, arrow keys", "orbit"],
    ["Shift + drag, right drag, Shift + arrow keys", "pan"],
    ["wheel, two fingers, + and −", "zoom"],
    ["Ctrl + wheel", "field of view"],
    ["1 … 6", `the views of the buttons ${views}`],
    ["double click, R", "camera as at the start, the button ⌂"],
    ["P", "paint: drag or Enter shows what is there, with Shift hides it"],
    ["C", "slices through the voxel under the pointer"],
  ]],
  ["light", "Picture", [
    ["drag, arrow keys", "turn the light, or move the lamp"],
    ["right drag, Shift + arrow keys", "see the shape from elsewhere"],
    ["R", "light and view as at the start"],
    ["wheel, + and −", "zoom both sides about the pointer; from 2× pixels are squares"],
    ["Shift + drag, middle drag", "move what is enlarged"],
    ["double click, 0", "the whole picture"],
    ["X held", "exchange both sides"],
  ]],
  ["", "Every picture", [
    ["W", "second picture and wipe"],
    ["F", "the whole screen, the button ⤢"],
    ["Space", "pause, go on"],
  ]],
  ["transfer", "Transfer function", [
    ["double click, Add", "new point or bump"],
    ["Page Up, Page Down, Home, End", "another handle"],
    ["drag, arrow keys", "move it; with Shift in large steps"],
    ["wheel, [ and ]", "width of a bump; with Shift its height"],
    ["Delete", "remove it"],
    ["Ctrl + wheel, + and −, 0", "fewer or more values, the whole range"],
    ["drag beside the handles, Shift + wheel", "other values"],
  ]],
  ["slices", "Slices", [
    ["drag, arrow keys", "move the cross"],
    ["wheel, Page Up and Page Down", "next slice"],
    ["Shift + drag, right drag", "contrast and brightness"],
  ]],
  ["plots", "Plots", [
    ["drag, click; arrow keys, Enter", "select, the arrows with a cursor"],
    ["wheel, + and −; 0, double click", "zoom; the whole plot"],
    ["Shift + drag, Shift + arrow keys", "move what is enlarged"],
    ["drag, arrow keys on the 3-D lobe", "turn it"],
    ["Escape", "select nothing"],
  ]],
  ["", "Panels", [
    ["double click on a name, Delete", "the default of a setting"],
  ]],
  ["", "Everywhere", [
    ["Ctrl + Z or U, Ctrl + Y", "undo, redo"],
    ["Escape", "cancel what takes long"],
    ["?", "this help"],
  ]],
];

/** Open a dialog inside of `root`; it is removed when it closes. */
function openDialog(root, title, ...content) {
  const heading = make("h2", {}, title);
  const properties = { "aria-label": title, onclose: () => dialog.remove() };
  const dialog = make("dialog", properties, heading, ...content);
  root.append(dialog);
  dialog.showModal();
  return dialog;
}

/** Make the row of buttons at the end of a dialog. */
function makeAnswers(...buttons) {
  return make("div", { class: "answers" }, ...buttons);
}

/**
 * Put a text on the clipboard, and return whether that is allowed.
 *
 * Where the browser forbids to write it, the box that shows it may be allowed to copy.
 */
async function copyText(text, box) {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    box.select();
    return document.execCommand("copy");
  }
}

/** Copy a text and show it, selected; the button copies it where the browser wants a click for it. */
function showText(root, { title, text }) {
  const rows = clamp(text.split("\n").length, 2, 18);
  const box = make("textarea", {
    value: text, readOnly: true, rows, spellcheck: false, "aria-label": title,
  });
  const copied = make("p", { class: "sum", role: "status" });
  const copy = makeButton("Copy", put, { hidden: true });
  const close = makeButton("Close", () => dialog.close(), { class: "main" });
  const dialog = openDialog(root, title, box, copied, makeAnswers(copy, close));
  box.focus();
  box.select();
  async function put() {
    copy.hidden = await copyText(text, box);
    copied.textContent = copy.hidden ? "It is on the clipboard." : "The browser did not copy it.";
  }
  put();
}

/** Show what keys, pointers and wheel do. */
function showHelp(session, root) {
  const views = listViews(session.description?.volume?.axes).map(([name]) => name).join(" ");
  const shown = listKeys(views).filter(([part]) => !part || uses(session, part));
  const parts = shown.map(([, title, rows]) => make("section", {},
    make("h3", {}, title),
    make("dl", {}, ...rows.map(([keys, meaning]) =>
      make("div", {}, make("dt", {}, keys), make("dd", {}, meaning))))));
  const close = makeButton("Close", () => dialog.close(), { class: "main" });
  const keys = make("div", { class: "keys" }, ...parts);
  const dialog = openDialog(root, "Keys and gestures", keys, makeAnswers(close));
  close.focus();
}

/** Ask how the voxels of a file without a header are stored, and answer Python. */
function askRaw(session, root, { name, bytes, guess, dtypes }) {
  const numbers = (label, values, properties) => values.map((value, k) => make("input", {
    type: "number", value, required: true, "aria-label": `${label} ${"xyz"[k]}`, ...properties,
  }));
  const size = numbers("Voxels along", guess.size, { min: 1, step: 1 });
  const spacing = numbers("Spacing along", guess.spacing, { min: 0, step: "any" });
  const offset = make("input", {
    type: "number", min: 0, step: 1, value: 0, required: true,
  });
  const dtype = make("select", {}, ...dtypes.map((type) => make("option", { value: type }, type)));
  dtype.value = guess.dtype;
  const sum = make("p", { class: "sum", role: "status" });
  const row = (label, inputs) => make("div", { class: "triple", role: "group", "aria-label": label },
    make("span", { class: "name" }, label), ...inputs);

  /** Say whether the numbers agree with the size of the file. */
  function check() {
    const each = Number(dtype.value.match(/\d+$/)?.[0] || 8) / 8; // "uint16" counts bits
    const needed = size.reduce((product, { value }) => product * value, each) + Number(offset.value);
    const write = (count) => Number(count).toLocaleString("en");
    const verdict = needed === bytes ? "as the file has" : `the file has ${write(bytes)}`;
    sum.textContent = `${write(needed)} bytes; ${verdict}.`;
    sum.classList.toggle("bad", needed !== bytes);
  }

  let answer = null;
  const form = make("form", { method: "dialog", oninput: check, onsubmit: () => {
    answer = {
      size: size.map(({ value }) => Number(value)), dtype: dtype.value,
      spacing: spacing.map(({ value }) => Number(value)), offset: Number(offset.value),
    };
  } },
  row("Voxels", size), row("Spacing", spacing), makeField("Type", dtype),
  makeField("Header", offset, "bytes"), sum,
  makeAnswers(make("button", { type: "submit", class: "main" }, "Open"),
    makeButton("Cancel", () => dialog.close())));
  const dialog = openDialog(root, `How are the voxels stored in ${name}?`, form);
  dialog.addEventListener("close", () => session.send({
    type: "raw", ...(answer || { size: null, dtype: null, spacing: null, offset: null }),
  }));
  check();
}
