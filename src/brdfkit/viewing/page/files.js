// Files: those that are dropped or chosen go to Python in pieces; those it sends are downloaded.

const CHUNK = 1 << 20; // bytes of a piece

/** Return the files of a drop, those in dropped folders, too: a scan is often a folder. */
async function listDropped(transfer) {
  const entries = [...transfer.items].map((item) => item.webkitGetAsEntry?.()).filter(Boolean);
  const loose = [...transfer.files];
  if (!entries.some((entry) => entry.isDirectory)) return loose;
  const found = [];
  for (const waiting = entries; waiting.length; ) {
    const entry = waiting.shift();
    if (entry.isFile) {
      found.push(await new Promise((resolve, reject) => entry.file(resolve, reject)));
    } else {
      const reader = entry.createReader();
      for (;;) { // a reader gives a folder's entries in portions
        const portion = await new Promise((resolve, reject) => reader.readEntries(resolve, reject));
        if (!portion.length) break;
        waiting.push(...portion);
      }
    }
  }
  return found;
}

/** Return a function that sends files to Python, one after the other. */
function createUploads(session) {
  let acknowledge = null; // resolves the promise of the piece that is under way
  let queue = Promise.resolve();
  session.on("uploaded", () => acknowledge?.(true));
  session.on("error", () => acknowledge?.(false));

  let opening = false; // whether Python works on the files; what else it works on goes on
  const end = () => {
    opening = false;
    session.emit("busy", { text: "" });
  };
  for (const type of ["history", "ask_raw"]) session.on(type, () => opening && end());
  session.on("error", end);

  /** Send a file in pieces; return whether Python took all of them. */
  async function send(file, details) {
    let offset = 0;
    do {
      const piece = await file.slice(offset, offset + CHUNK).arrayBuffer();
      const taken = new Promise((resolve) => (acknowledge = resolve));
      session.send({ type: "upload", ...details, name: file.name, size: file.size, offset }, [piece]);
      offset += piece.byteLength;
      if (offset >= file.size && details.index === details.count - 1) {
        // Python's answer to the last piece is what it made of the files
        opening = true;
        session.emit("busy", { text: `Opening ${file.name}`, fraction: null });
        return true;
      }
      if (!(await taken)) return false;
      session.emit("busy", { text: `Sending ${file.name}`, fraction: offset / file.size });
    } while (offset < file.size);
    return true;
  }

  async function sendAll(files) {
    try {
      for (const [index, file] of files.entries()) {
        if (!(await send(file, { count: files.length, index }))) break;
      }
    } catch (error) {
      session.emit("error", { text: `The file could not be read: ${error.message}` });
    } finally {
      acknowledge = null;
    }
  }

  return (files) => {
    if (files.length) queue = queue.then(() => sendAll([...files]));
  };
}

/** Let files be dropped anywhere on `element`, and chosen by a dialog; returns that dialog. */
function acceptFiles(session, element) {
  const upload = createUploads(session);
  let depth = 0; // enter and leave come for every child, too
  const holdsFiles = (event) => [...(event.dataTransfer?.types || [])].includes("Files");
  const mark = (change) => {
    depth = change === 0 ? 0 : Math.max(depth + change, 0);
    element.classList.toggle("dropping", depth > 0);
  };
  element.addEventListener("dragenter", (event) => holdsFiles(event) && mark(1));
  element.addEventListener("dragleave", (event) => holdsFiles(event) && mark(-1));
  element.addEventListener("dragover", (event) => holdsFiles(event) && event.preventDefault());
  element.addEventListener("drop", async (event) => {
    if (!holdsFiles(event)) return;
    event.preventDefault();
    mark(0);
    upload(await listDropped(event.dataTransfer));
  });

  function pick(accept) {
    const input = make("input", { type: "file", multiple: !accept, accept });
    input.addEventListener("change", () => upload(input.files));
    input.click();
  }
  session.on("pick", pick);
  return pick;
}

/** Save a file that Python sent. */
function download({ name, mime }, [bytes]) {
  const address = URL.createObjectURL(new Blob([bytes], { type: mime }));
  make("a", { href: address, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(address), 1000);
}
