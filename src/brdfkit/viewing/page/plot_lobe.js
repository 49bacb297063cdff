// The 3-D lobe: a surface whose distance from the centre is the BRDF; a drag turns it.

const LOBE_TURN = 0.5; // degrees for a pixel of a drag
const LOBE_REACH = 3; // degrees between the light of a selected sample and that of the plot
const LOBE_KEY_TURN = 5; // degrees for a press of an arrow key
const LOBE_VIEW = { azimuth: -60, elevation: 22, zoom: 1 };
const LIGHT_OF_LOBE = [-0.35, -0.5, 0.8]; // from where the surface is shaded

/** Return the view of a plot, which it keeps until it is reset. */
function viewOf(plot) {
  plot.view = plot.view || { ...LOBE_VIEW };
  return plot.view;
}

/** Return the function from places [x, y, z] in space, z along the normal, to [x, y, depth]. */
function makeProjection(plot) {
  const { azimuth, elevation, zoom } = viewOf(plot);
  const [a, e] = [(azimuth * Math.PI) / 180, (elevation * Math.PI) / 180];
  const size = zoom * Math.min(plot.width / 2.3, plot.height / 1.45);
  const [cx, cy] = [plot.width / 2, plot.height * 0.74];
  return ([x, y, z]) => {
    const [right, away] = [x * Math.cos(a) + y * Math.sin(a), -x * Math.sin(a) + y * Math.cos(a)];
    return [cx + size * right, cy - size * (z * Math.cos(e) + away * Math.sin(e)), away * Math.cos(e) - z * Math.sin(e)];
  };
}

/** Return the direction at angles [degrees]; the azimuth counts from the mirror direction, along x. */
function toDirection(theta, phi) {
  const [t, p] = [(theta * Math.PI) / 180, (phi * Math.PI) / 180];
  return [Math.sin(t) * Math.cos(p), Math.sin(t) * Math.sin(p), Math.cos(t)];
}

/** Return the quads of a lobe as the middle of their depths, their corners and their brightness. */
function listQuads(lobe, scale, project) {
  const places = lobe.values.map((row, i) => [...row].map((value, j) => {
    const radius = scale.place(value);
    return toDirection(lobe.theta_o[i], lobe.phi_o[j]).map((x) => radius * x);
  }));
  const flat = places.map((row) => row.map(project));
  const quads = [];
  for (let i = 0; i + 1 < places.length; i++) {
    for (let j = 0; j + 1 < places[0].length; j++) {
      const corners = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]];
      const normal = crossProduct(places, corners);
      const length = Math.hypot(...normal) || 1;
      const bright = Math.abs(normal.reduce((sum, x, k) => sum + x * LIGHT_OF_LOBE[k], 0)) / length;
      const shown = corners.map(([r, c]) => flat[r][c]);
      const depth = shown.reduce((sum, [, , own]) => sum + own, 0) / 4;
      quads.push({ depth, corners: shown, bright, known: lobe.known[i][j] && lobe.known[i + 1][j + 1] });
    }
  }
  return quads;
}

/** Return the cross product of the diagonals of a quad. */
function crossProduct(places, [a, b, c, d]) {
  const at = ([i, j]) => places[i][j];
  const minus = (p, q) => p.map((x, k) => x - q[k]);
  const [u, v] = [minus(at(c), at(a)), minus(at(d), at(b))];
  return [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
}

/** Draw the surface as a ring, the plane of incidence, the normal and the light. */
function drawGround(context, plot, project) {
  const { colours, content } = plot;
  context.lineWidth = 1;
  context.strokeStyle = colours("edge");
  strokeLine(context, Array.from({ length: 73 }, (_, k) => project(toDirection(90, 5 * k))));
  context.strokeStyle = colours("line");
  strokeLine(context, Array.from({ length: 37 }, (_, k) => project(toDirection(5 * k - 90, 0))));
  strokeLine(context, [project([0, 0, 0]), project([0, 0, 1])]);
  strokeLine(context, [project([-1, 0, 0]), project([1, 0, 0])]);
  const light = project(toDirection(content.theta_i, 180));
  context.strokeStyle = context.fillStyle = colours("ink");
  context.lineWidth = 1.5;
  strokeLine(context, [light, project([0, 0, 0])]);
  fillDots(context, [light], 4);
  context.fillStyle = colours("soft");
  context.textAlign = "center";
  context.textBaseline = "bottom";
  context.fillText("light", light[0], light[1] - 6);
}

/** Mix a colour such as "#2a86d1" with black or white, by a brightness of 0 to 1. */
function shadeColour(colour, bright, opacity) {
  const parts = [1, 3, 5].map((k) => parseInt(colour.slice(k, k + 2), 16));
  const share = 0.45 + 0.75 * bright;
  return `rgb(${parts.map((part) => Math.round(Math.min(part * share, 255))).join(" ")} / ${opacity})`;
}

/** Return the places of the selected samples whose light comes from about where the plot's does. */
function placeSolidMarks(plot, scale, project) {
  const { content, session } = plot;
  const cosine = (degrees) => (session.state["plots.cosine"] ? Math.cos((degrees * Math.PI) / 180) : 1);
  return listMarks(plot).filter(({ theta_i: theta }) => Math.abs(theta - content.theta_i) <= LOBE_REACH)
    .map(({ theta_o: theta, view, plane, value }) => {
      const radius = scale.place(value * cosine(theta));
      return project(toDirection(theta, view < 0 ? 180 - plane : plane).map((x) => radius * x));
    });
}

const LOBE = {
  draw(context, plot) {
    const { content, curves, session } = plot;
    const scale = makeValueScale(session.state["plots.scale"], content.lobes.flatMap(({ values }) => values));
    const project = makeProjection(plot);
    drawGround(context, plot, project);
    const several = curves.length > 1;
    // One over the other, the shown model last, so that each can be seen
    const quads = orderCurves(curves).filter((number) => !curves[number].twin).flatMap((number) => (
      listQuads(content.lobes[number], scale, project).sort((a, b) => b.depth - a.depth)
        .map((quad) => ({ ...quad, curve: curves[number] }))));
    context.lineWidth = 0.7;
    for (const { corners, bright, known, curve } of quads) {
      context.beginPath();
      corners.forEach(([x, y], k) => (k ? context.lineTo(x, y) : context.moveTo(x, y)));
      context.closePath();
      // Several lobes are meshes, so that each shows through the others
      if (!several && known) {
        context.fillStyle = shadeColour(curve.colour, bright, 0.95);
        context.fill();
      }
      context.strokeStyle = shadeColour(curve.colour, several ? 0.5 : bright, known ? (several ? 0.75 : 0.5) : 0.15);
      context.stroke();
    }
    drawMarks(context, plot, placeSolidMarks(plot, scale, project));
  },
  read: (_, { content }) => (content ? "drag or arrow keys turn, wheel zooms; faint: not measured" : ""),
  grab(place, plot) {
    const view = viewOf(plot);
    let last = place;
    return (now) => {
      view.azimuth -= LOBE_TURN * (now[0] - last[0]);
      view.elevation = clamp(view.elevation + LOBE_TURN * (now[1] - last[1]), -10, 90);
      last = now;
      plot.draw();
    };
  },
  turn([right, down], plot) {
    const view = viewOf(plot);
    view.azimuth -= LOBE_KEY_TURN * right;
    view.elevation = clamp(view.elevation + LOBE_KEY_TURN * down, -10, 90);
  },
  zoom(factor, plot) {
    const view = viewOf(plot);
    view.zoom = clamp(view.zoom * factor, 0.3, 20);
  },
  reset(plot) {
    plot.view = { ...LOBE_VIEW };
  },
  rows({ content: { lobes }, curves }) {
    const table = [["material", "theta_o", "phi_o", "known", "value"]];
    lobes.forEach((lobe, number) => lobe.theta_o.forEach((theta, i) => lobe.phi_o.forEach((phi, j) => (
      table.push([curves[number].name, theta, phi, lobe.known[i][j], lobe.values[i][j]])))));
    return table;
  },
};
