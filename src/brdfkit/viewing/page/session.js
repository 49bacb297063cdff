// The page's side of the conversation with Python: messages, the state, and what is being dragged.

const PAUSE = 350; // ms without a change after which turning a wheel or holding a key has ended

/** Return the bytes of a buffer, which a carrier gives as an ArrayBuffer or as a view of one. */
function toBytes(buffer) {
  if (buffer instanceof ArrayBuffer) return new Uint8Array(buffer);
  return new Uint8Array(buffer.buffer, buffer.byteOffset, buffer.byteLength);
}

/** Return whether what is shown uses a part of the page, such as "slices". */
function uses(session, part) {
  return Boolean(session.description?.parts?.includes(part));
}

/**
 * Start a session on an anywidget model.
 *
 * `state` holds the value of each name; `description` is Python's last "open" message, with the
 * controls of a later "controls" message. Parts of
 * the page listen with `on(type, listener)` to the messages of Python by their type, and to
 * "state", which carries the set of names that have changed, whoever changed them. "sent" carries
 * each message to Python.
 */
function createSession(model) {
  const session = { model, state: {}, description: null };
  const listeners = new Map();

  session.on = (type, listener) => {
    listeners.set(type, [...(listeners.get(type) || []), listener]);
  };
  session.emit = (type, ...details) => {
    for (const listener of listeners.get(type) || []) listener(...details);
  };
  session.sent = 0; // the number of the last message
  session.send = (content, buffers) => {
    session.sent += 1;
    model.send({ ...content, message: session.sent }, undefined, buffers);
    session.emit("sent", content);
  };
  const edits = createEdits(session);

  function receive(content, buffers = []) {
    const bytes = buffers.map(toBytes);
    if (content.type === "open") {
      session.description = content;
      session.state = { ...content.state };
      edits.forget();
      session.emit("open", content, bytes);
      session.emit("history", content);
      session.emit("state", new Set(Object.keys(session.state)));
    } else if (content.type === "controls") {
      session.description = { ...session.description, ...content };
      session.state = { ...content.state };
      edits.forget();
      session.emit("controls", content);
      session.emit("state", new Set(Object.keys(session.state)));
    } else if (content.type === "state") {
      edits.accept(content);
      session.emit("history", content);
    } else {
      session.emit(content.type, content, bytes);
    }
  }

  model.on("msg:custom", receive);
  session.stop = () => {
    edits.stop();
    model.off?.("msg:custom", receive);
    listeners.clear();
  };
  return session;
}

/**
 * Add the ways of changing the state to a session.
 *
 * - `change(changes)`: at once, one step of undo;
 * - `drag(changes)`, repeatedly, then `finish()`: the steps between are sent once a frame;
 * - `nudge(changes)`: as `drag`, and finishes by itself after a pause (wheel, held key, typing);
 * - `command(type)`: let Python change the state, as by "undo".
 *
 * Python says with each state which message it answers. What it said before it had the last change
 * or command is old, and is not shown.
 */
function createEdits(session) {
  let unsent = {}; // changes since the last message
  let gesture = {}; // all changes of the drag that is under way
  let frame = 0;
  let pause = 0;
  let awaited = 0; // the number of the last change or command

  function apply(changes) {
    Object.assign(session.state, changes);
    session.emit("state", new Set(Object.keys(changes)));
  }

  function sendUnsent() {
    frame = 0;
    if (Object.keys(unsent).length) session.send({ type: "set", changes: unsent, moving: true });
    unsent = {};
  }

  function sendAndAwait(content) {
    session.send(content);
    awaited = session.sent;
  }

  session.drag = (changes) => {
    clearTimeout(pause);
    Object.assign(unsent, changes);
    Object.assign(gesture, changes);
    frame = frame || requestAnimationFrame(sendUnsent);
    apply(changes);
  };

  session.finish = () => {
    clearTimeout(pause);
    cancelAnimationFrame(frame);
    frame = 0;
    const changes = gesture;
    gesture = {};
    unsent = {};
    if (Object.keys(changes).length) sendAndAwait({ type: "set", changes, moving: false });
  };

  session.nudge = (changes) => {
    session.drag(changes);
    pause = setTimeout(session.finish, PAUSE);
  };

  session.change = (changes) => {
    session.finish();
    session.drag(changes);
    session.finish();
  };

  session.command = (type) => {
    session.finish();
    sendAndAwait({ type });
  };

  return {
    accept({ state, answered }) {
      if (answered < awaited) return;
      const isNew = ([name, value]) => !(name in gesture) && !equal(value, session.state[name]);
      const changes = Object.fromEntries(Object.entries(state).filter(isNew));
      if (Object.keys(changes).length) apply(changes);
    },
    forget() {
      [unsent, gesture, awaited] = [{}, {}, 0];
    },
    stop() {
      cancelAnimationFrame(frame);
      clearTimeout(pause);
    },
  };
}
