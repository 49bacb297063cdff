// The server's page: a model of anywidget's kind over one WebSocket, for the viewer to run on.

import viewer from "./viewer.js";

/**
 * Connect to the server beside this page, and return the model.
 *
 * A message is JSON; if bytes belong to it, its "bytes" lists how many, and each of them follows
 * as a binary message. Besides anywidget's "msg:custom", the model tells of "lost" and "found".
 */
function connectModel() {
  const listeners = new Map();
  let socket = null;
  let everOpen = false;

  const heard = (type) => listeners.get(type) || [];
  function emit(type, ...details) {
    for (const listener of heard(type)) listener(...details);
  }

  function reconnect() {
    const address = new URL("session", location.href);
    address.protocol = address.protocol.replace("http", "ws");
    address.hash = "";
    socket = new WebSocket(address);
    socket.binaryType = "arraybuffer";
    let content = null;
    let buffers = [];
    socket.addEventListener("message", ({ data }) => {
      if (typeof data === "string") [content, buffers] = [JSON.parse(data), []];
      else buffers.push(data);
      const expected = Array.isArray(content.bytes) ? content.bytes.length : 0;
      if (buffers.length === expected) emit("msg:custom", content, buffers);
    });
    socket.addEventListener("open", () => {
      waiting.splice(0).forEach(([message, pieces]) => send(message, pieces));
      if (everOpen) emit("found");
      everOpen = true;
    });
    socket.addEventListener("close", () => emit("lost"));
  }

  const waiting = []; // what is said before the first connection is open
  function send(message, pieces = []) {
    if (socket.readyState === WebSocket.CONNECTING) {
      waiting.push([message, pieces]);
    } else if (socket.readyState === WebSocket.OPEN) {
      const bytes = pieces.map(({ byteLength }) => byteLength);
      socket.send(JSON.stringify(pieces.length ? { ...message, bytes } : message));
      pieces.forEach((piece) => socket.send(piece));
    }
  }

  reconnect();
  return {
    address: true,
    reconnect,
    send: (content, _, buffers) => send(content, buffers),
    on: (type, listener) => listeners.set(type, [...heard(type), listener]),
    off: (type, listener) => listeners.set(type, heard(type).filter((own) => own !== listener)),
  };
}

const model = connectModel();
model.on("msg:custom", ({ type, title }) => {
  if (type === "open" && title) document.title = `${title} · brdfkit view`;
});
viewer.render({ model, el: document.querySelector("main") });
