// The list of pins: models that stay with their values, each with a colour, its error and its buttons.

/** Return the name that stands for a pin in the state. */
const namePin = ({ number }) => `pin${number}`;

/** Make the list of pins; `show(errors)` writes the errors of an "errors" message beside them. */
function createPins(session) {
  const list = make("ul", { class: "pins", "aria-label": "Pins", hidden: true });
  let errors = {}; // pin's name → text
  let colours = [];
  let asked = ""; // the pins whose errors Python was asked for, and the loss

  /** Show a pin left of the wipe and the model right of it, or what both sides show at first. */
  function switchLeft(name, isLeft) {
    const usual = (side) => session.description.controls.find((own) => own.name === side).default;
    const { second } = session.state;
    const beside = second && second !== name ? second : "model";
    session.change(isLeft ? { renderer: usual("renderer"), second: usual("second") } : { renderer: name, second: beside });
  }

  function makeEntry(pin) {
    const name = namePin(pin);
    const called = `pin ${pin.number}, ${pin.model}`;
    const alone = session.state.solo === name;
    const isLeft = session.state.renderer === name;
    const { pins } = session.state;
    const solo = makeButton("Solo", () => session.change({ solo: alone ? "" : name }), {
      "aria-pressed": String(alone), "aria-label": `Solo ${called}`, title: "Show only this curve in the plots",
    });
    return make("li", {},
      makeChip({ pin: name, colour: colours[pin.number - 1] }),
      make("span", { class: "name", title: pin.loss ? `${pin.model}, a fit by ${pin.loss}` : `${pin.model}, values by hand` },
        pin.model, make("small", {}, pin.loss ? "" : " by hand")),
      make("span", { class: "error" }, errors[name] || ""),
      makeButton("Show", () => session.send({ type: "show_pin", pin: name }), {
        "aria-label": `Show ${called}`, title: "Bring this model and its values back to the sliders",
      }),
      makeButton("◧", () => switchLeft(name, isLeft), {
        "aria-pressed": String(isLeft), "aria-label": `Left of the wipe: ${called}`,
        title: "Show this pin left of the wipe, beside the model",
      }),
      solo,
      makeButton("✕", () => session.change({ pins: pins.filter((own) => own !== pin) }), {
        "aria-label": `Remove ${called}`, title: "Remove this pin",
      }));
  }

  function fill() {
    const { pins = [] } = session.state;
    const focused = [...list.querySelectorAll("button")].findIndex((button) => button.matches(":focus"));
    list.hidden = !pins.length;
    list.replaceChildren(...pins.map(makeEntry));
    if (focused >= 0) [...list.querySelectorAll("button")].at(Math.min(focused, 4 * pins.length - 1))?.focus();
  }
  session.on("open", (content) => {
    colours = content.pin_colours || [];
    errors = {};
    asked = "";
  });
  session.on("state", (names) => {
    if (["pins", "solo", "renderer"].some((name) => names.has(name))) fill();
    const mends = Object.entries(session.state).filter(([name]) => name.startsWith(MENDS));
    const now = JSON.stringify([session.state.pins, session.state["fit.loss"], mends]);
    if (!uses(session, "fit") || now === asked) return;
    asked = now;
    session.send({ type: "errors" });
  });
  session.on("errors", ({ columns, rows, loss }) => {
    const column = columns.findIndex(([name]) => name === loss);
    errors = Object.fromEntries(rows.map(({ pin, cells }) => [pin, cells[column]]));
    fill();
  });
  return list;
}
