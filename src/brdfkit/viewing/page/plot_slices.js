// Slices of BRDFs over θh and θd as pictures: the data, the models, and their ratios to the data.

const SLICE_MARGIN = { left: 40, right: 8, top: 18, bottom: 34, gap: 22 };
const LEGEND_ROOM = 40; // pixels right of the last panel of a kind
const FAINT = 0.35; // opacity of cells that were not measured
const THETA_H_TICKS = [[0, 1, 5, 20, 45, 90], [0, 20, 90]]; // on a wide axis, and on a narrow one
const NARROW_AXIS = 110; // pixels

/** The axes of a slice; θh is even in its square root. */
const SLICE_AXES = [
  { place: (value) => Math.sqrt(value / 90), ticks: THETA_H_TICKS[0].map((value) => [value, `${value}°`]), label: "θh" },
  { place: (value) => value / 90, ticks: [0, 30, 60, 90].map((value) => [value, `${value}°`]), label: "θd" },
];

/** Return the areas of the panels on the canvas. */
function placeSlices({ width, height, content }) {
  const { left, right, top, bottom, gap } = SLICE_MARGIN;
  const count = content.panels.length;
  const kinds = new Set(content.panels.map(({ kind }) => kind)).size;
  const room = width - left - right - kinds * LEGEND_ROOM - (count - 1) * gap;
  const side = Math.max(Math.min(room / count, height - top - bottom), 20);
  let x = left + Math.max((room - count * side) / 2, 0);
  return content.panels.map(({ kind }, k) => {
    const area = { x, y: top, width: side, height: Math.max(height - top - bottom, 20) };
    const last = content.panels[k + 1]?.kind !== kind;
    x += side + gap + (last ? LEGEND_ROOM : 0);
    return { ...area, last };
  });
}

/** Return the share 0 to 1 along its colours of a value of a panel. */
function shareOfColours(kind, value, { low, high, largest_ratio: ratio }) {
  const share = kind === "ratio"
    ? value / Math.log2(ratio) / 2 + 0.5 : Math.log(Math.max(value, low) / low) / Math.log(high / low);
  return clamp(share, 0, 1);
}

/** Return the three bytes of a colour map at a share of it. */
function mixColour(colours, share) {
  return colours[Math.round(share * (colours.length - 1))];
}

/** Make a canvas with a pixel for each cell of a panel, its first row at the bottom. */
function paintCells({ kind, values, known }, content) {
  const cells = document.createElement("canvas");
  [cells.width, cells.height] = [values[0].length, values.length];
  const context = cells.getContext("2d");
  const image = context.createImageData(cells.width, cells.height);
  const colours = content[`${kind}_colours`];
  for (let row = 0; row < cells.height; row++) {
    for (let column = 0; column < cells.width; column++) {
      const value = values[row][column];
      const at = 4 * ((cells.height - 1 - row) * cells.width + column);
      if (!Number.isFinite(value)) continue;
      image.data.set(mixColour(colours, shareOfColours(kind, value, content)), at);
      image.data[at + 3] = known[row][column] ? 255 : 255 * FAINT;
    }
  }
  context.putImageData(image, 0, 0);
  return cells;
}

/** Draw one panel, hatched where nothing was measured. */
function drawSlice(context, plot, panel, area, first) {
  const { content, colours, at } = plot;
  const [left, top] = at([area.x, area.y]);
  const [right, bottom] = at([area.x + area.width, area.y + area.height]);
  context.save();
  context.beginPath();
  context.rect(area.x, area.y, area.width, area.height);
  context.clip();
  context.fillStyle = makeHatch(context, colours("edge"));
  context.fillRect(area.x, area.y, area.width, area.height);
  context.imageSmoothingEnabled = false;
  panel.cells = panel.cells || paintCells(panel, content);
  context.drawImage(panel.cells, left, top, right - left, bottom - top);
  const [h, d] = ["theta_h", "theta_d"].map((name) => findRange(plot.session, name));
  if (h && d) {
    outlineRegion(context, plot, [[0, 0], [1, 0], [1, 1], [0, 1]].map(([i, j]) => placeOnSlice(plot, area, h[i], d[j])));
  } else {
    drawMarks(context, plot, listMarks(plot).map((mark) => placeOnSlice(plot, area, mark.theta_h, mark.theta_d)));
  }
  context.restore();
  const up = first ? SLICE_AXES[1] : { ...SLICE_AXES[1], ticks: [], label: "" };
  const ticks = THETA_H_TICKS[area.width < NARROW_AXIS ? 1 : 0].map((value) => [value, `${value}°`]);
  drawAxes(context, colours, area, at, [{ ...SLICE_AXES[0], ticks }, up], false);
  context.fillStyle = colours("ink");
  context.textAlign = "center";
  context.textBaseline = "bottom";
  context.fillText(shorten(context, panel.title, area.width), area.x + area.width / 2, area.y - 3);
}

/** Return the place of angles θh and θd [degrees] on a slice. */
function placeOnSlice({ at }, area, h, d) {
  return at([area.x + SLICE_AXES[0].place(h) * area.width, area.y + (1 - SLICE_AXES[1].place(d)) * area.height]);
}

/** Return a text that is at most so wide, cut at its end. */
function shorten(context, text, width) {
  let shown = text;
  while (shown.length > 2 && context.measureText(shown).width > width) shown = `${shown.slice(0, -2)}…`;
  return shown;
}

/** Draw the colours of a kind of panels with their ends, right of an area. */
function drawColourScale(context, plot, kind, area) {
  const { content, colours } = plot;
  const map = content[`${kind}_colours`];
  const x = area.x + area.width + 8;
  const height = area.height / map.length;
  map.forEach((colour, k) => {
    context.fillStyle = `rgb(${colour.map(Math.round).join(" ")})`;
    context.fillRect(x, area.y + area.height - (k + 1) * height, 9, height + 0.5);
  });
  context.fillStyle = colours("soft");
  context.textAlign = "left";
  const ratio = content.largest_ratio;
  const ends = kind === "ratio"
    ? [[`${ratio} ×`, 0], [`1`, 0.5], [`1/${ratio}`, 1]]
    : [[writeValue(content.high), 0], [writeValue(content.low), 1]];
  for (const [text, share] of ends) {
    context.textBaseline = share === 0 ? "top" : share === 1 ? "bottom" : "middle";
    context.fillText(text, x + 12, area.y + share * area.height);
  }
}

/** Return the panel at a place, and the angles θh and θd [degrees] there, or null. */
function readSlice(place, plot) {
  const areas = placeSlices(plot);
  const k = areas.findIndex(({ x, y, width, height }) => (
    place[0] >= x && place[0] <= x + width && place[1] >= y && place[1] <= y + height));
  if (k < 0) return null;
  const { x, y, width, height } = areas[k];
  const [px, py] = plot.backIn(place, areas[k]);
  const [across, up] = [clamp((px - x) / width, 0, 1), clamp(1 - (py - y) / height, 0, 1)];
  return { k, across, up, theta_h: 90 * across ** 2, theta_d: 90 * up };
}

const SLICES = {
  /** All panels zoom alike: each about its own corner. */
  draw(context, plot) {
    const areas = placeSlices(plot);
    plot.backIn = (place, area) => {
      const [x, y] = plot.back([place[0] - area.x + areas[0].x, place[1]]);
      return [x + area.x - areas[0].x, y];
    };
    plot.content.panels.forEach((panel, k) => {
      const shift = areas[k].x - areas[0].x;
      const at = ([x, y]) => {
        const [px, py] = plot.zoom.at([x - shift, y]);
        return [px + shift, py];
      };
      drawSlice(context, { ...plot, at }, panel, areas[k], k === 0);
      if (areas[k].last) drawColourScale(context, plot, panel.kind, areas[k]);
    });
  },
  /** The place in the first panel that is zoomed like one in any panel. */
  home(place, plot) {
    const areas = placeSlices(plot);
    const own = areas.find(({ x, width }) => place[0] <= x + width) || areas[0];
    return [place[0] - own.x + areas[0].x, place[1]];
  },
  read(place, plot) {
    const found = readSlice(place, plot);
    if (!found) return "";
    const { theta_h: h, theta_d: d, across, up } = found;
    const texts = plot.content.panels.map(({ title, kind, values, known }) => {
      const row = Math.min(Math.floor(up * values.length), values.length - 1);
      const column = Math.min(Math.floor(across * values[0].length), values[0].length - 1);
      const value = values[row][column];
      if (!Number.isFinite(value)) return `${title} below the surface`;
      const text = kind === "ratio" ? `${writeValue(2 ** value)}` : writeValue(value);
      return `${title} ${text}${known[row][column] ? "" : " (not measured)"}`;
    });
    return `θh ${writeAngle(h)}, θd ${writeAngle(d)}: ${texts.join(" · ")}`;
  },
  select(from, to, plot) {
    const [start, end] = [readSlice(from, plot), readSlice(to, plot)];
    if (!start || !end) return null;
    // A click is at least the cell of a table of MERL's
    const h = [Math.min(start.across, end.across) - 0.008, Math.max(start.across, end.across) + 0.008];
    const d = [Math.min(start.theta_d, end.theta_d) - 0.75, Math.max(start.theta_d, end.theta_d) + 0.75];
    const [low, high] = h.map((share) => 90 * clamp(share, 0, 1) ** 2);
    return selectRanges([["theta_h", low, high], ["theta_d", Math.max(d[0], 0), Math.min(d[1], 90)]]);
  },
  rows({ content: { panels } }) {
    const [rows, columns] = [panels[0].values.length, panels[0].values[0].length];
    const table = [["theta_h", "theta_d", "known", ...panels.map(({ title, kind }) => `"${kind === "ratio" ? "log2 of " : ""}${title}"`)]];
    for (let row = 0; row < rows; row++) {
      for (let column = 0; column < columns; column++) {
        const share = (column + 0.5) / columns;
        table.push([90 * share ** 2, (90 * (row + 0.5)) / rows, panels[0].known[row][column],
          ...panels.map(({ values }) => values[row][column])]);
      }
    }
    return table;
  },
};
