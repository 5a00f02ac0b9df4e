// The stage: panes with one zoom and one centre for all, dragging, pinching, the slider, values under the cursor.

const stage = byId("stage");
const canvas = byId("canvas");
let cursor = null;
let marking = null;

/** The panes of the stage in device pixels, with what they show. */
const panes = () => {
  const ratio = window.devicePixelRatio || 1;
  const [width, height] = [Math.round(stage.clientWidth * ratio), Math.round(stage.clientHeight * ratio)];
  const list = entries(currentScene());
  const [a, b] = [entryOf(state.a) ?? list[0], entryOf(state.b) ?? list[0]];
  if (!a) return [];
  const place = (entry, x, y, w, h, clip = {}) => {
    const { width: columns, height: rows } = currentScene();
    // With the labels' room left free in tiles.
    const fit = Math.min(w / columns, h / rows);
    const scale = fit * state.zoom;
    const texels = 1 / scale;
    const [left, top] = [state.x * columns - (w / 2) * texels, state.y * rows - (h / 2) * texels];
    return { entry, reference: against(), x, y, width: w, height: h, left, top, texels, display: state.display, exposure: exposureOf(entry), whole: { x, y, width: w, height: h }, ...clip };
  };
  if (state.mode === "single") return [place(state.flipped ? b : a, 0, 0, width, height)];
  if (state.mode === "split") {
    const edge = Math.round(state.split * width);
    const [l, r] = state.flipped ? [b, a] : [a, b];
    const right = place(r, 0, 0, width, height);
    return [place(l, 0, 0, width, height, { width: edge }), { ...right, x: edge, width: width - edge, left: right.left + edge * right.texels }];
  }
  let columns = 1;
  const { width: w, height: h } = currentScene();
  // As many columns as make the pictures largest.
  const sizeWith = (n) => Math.min(width / n / w, height / Math.ceil(list.length / n) / h);
  for (let n = 2; n <= list.length; n++) if (sizeWith(n) > sizeWith(columns)) columns = n;
  const rows = Math.ceil(list.length / columns);
  const gap = Math.round(3 * ratio);
  return list.map((entry, i) => place(entry, Math.round(((i % columns) * width) / columns) + gap, Math.round((Math.floor(i / columns) * height) / rows) + gap,
    Math.floor(width / columns) - 2 * gap, Math.floor(height / rows) - 2 * gap));
};

const paneAt = (x, y) => panes().find((pane) => x >= pane.x && x < pane.x + pane.width && y >= pane.y && y < pane.y + pane.height);

/** Position in the picture, in pixels, of a point of the stage. */
const pictureAt = (pane, x, y) => [pane.left + (x - pane.x) * pane.texels, pane.top + (y - pane.y) * pane.texels];

const stagePoint = (event) => {
  const box = stage.getBoundingClientRect();
  const ratio = window.devicePixelRatio || 1;
  return [(event.clientX - box.left) * ratio, (event.clientY - box.top) * ratio];
};

const drawLabel = (context, pane, text, corner, ratio, colour) => {
  context.font = `600 ${12.5 * ratio}px system-ui, sans-serif`;
  const room = pane.width - 20 * ratio;
  if (room < 40 * ratio) return;
  let shown = text;
  while (shown.length > 4 && context.measureText(shown).width > room) shown = `${shown.slice(0, -2)}…`;
  const width = context.measureText(shown).width + 14 * ratio;
  const x = corner === "right" ? pane.x + pane.width - width - 6 * ratio : pane.x + 6 * ratio;
  const y = pane.y + 6 * ratio;
  context.fillStyle = "#000a";
  context.beginPath();
  context.roundRect(x, y, width, 22 * ratio, 5 * ratio);
  context.fill();
  context.fillStyle = colour;
  context.fillText(shown, x + 7 * ratio, y + 15.5 * ratio);
};

const labelOf = (entry) => {
  const error = entry.method?.figures.relmse?.median;
  return error === undefined ? entry.name : `${entry.name}  relMSE ${number(error)}`;
};

/** Values inside the pixels, once these are large enough. */
const drawValues = (context, pane, ratio) => {
  const scale = 1 / pane.texels;
  const picture = pictureNow(pane.display === "flip" && pane.entry.flip !== null ? pane.entry.flip : pane.entry.picture);
  if (scale < 52 * ratio || !picture) return;
  context.save();
  context.beginPath();
  context.rect(pane.x, pane.y, pane.width, pane.height);
  context.clip();
  context.font = `600 ${12 * ratio}px ui-monospace, Menlo, monospace`;
  context.textAlign = "center";
  const [x0, y0] = pictureAt(pane, pane.x, pane.y).map(Math.floor);
  const [x1, y1] = pictureAt(pane, pane.x + pane.width, pane.y + pane.height).map(Math.floor);
  const tints = picture.kind === "byte" ? ["#fff"] : ["#ffdcd6", "#d8ffd8", "#dbe6ff"];
  for (let y = Math.max(0, y0); y <= Math.min(picture.height - 1, y1); y++) {
    for (let x = Math.max(0, x0); x <= Math.min(picture.width - 1, x1); x++) {
      const left = pane.x + (x + 0.5 - pane.left) * scale;
      const top = pane.y + (y + 0.5 - pane.top) * scale;
      pixelAt(picture, x, y).forEach((value, c) => {
        context.lineWidth = 3 * ratio;
        context.strokeStyle = "#000c";
        const at = top + (tints.length === 1 ? 4 : (c - 0.7) * 15) * ratio;
        context.strokeText(number(value), left, at);
        context.fillStyle = tints[c];
        context.fillText(number(value), left, at);
      });
    }
  }
  context.restore();
};

const drawRegions = (context, pane, ratio) => {
  const box = pane.whole;
  context.save();
  context.beginPath();
  context.rect(pane.x, pane.y, pane.width, pane.height);
  context.clip();
  state.insets[state.scene].forEach((inset, i) => {
    context.strokeStyle = insetColour(i);
    context.lineWidth = 1.8 * ratio;
    context.strokeRect(pane.x + (inset.x - pane.left) / pane.texels, pane.y + (inset.y - pane.top) / pane.texels, inset.width / pane.texels, inset.height / pane.texels);
  });
  context.restore();
  return box;
};

const drawStage = () => {
  const scene = currentScene();
  stage.style.setProperty("--aspect", state.mode === "tiles" ? 2 : scene.height / scene.width);
  const ratio = window.devicePixelRatio || 1;
  const [width, height] = [Math.round(stage.clientWidth * ratio), Math.round(stage.clientHeight * ratio)];
  if (!width || !height) return;
  if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
  const context = canvas.getContext("2d");
  context.clearRect(0, 0, width, height);
  const list = panes();
  const complete = painter.paint(context, width, height, list);
  for (const pane of list) {
    drawValues(context, pane, ratio);
    drawRegions(context, pane, ratio);
    if (pane.display === "flip" && pane.entry.flip === null) drawLabel(context, { ...pane, y: pane.y + 30 * ratio }, pane.entry.index === REFERENCE ? "the reference itself" : "no map", "left", ratio, "#bbb");
  }
  list.forEach((pane, i) => drawLabel(context, pane, labelOf(pane.entry), state.mode === "split" && i === 1 ? "right" : "left", ratio, "#fff"));
  if (!complete) {
    context.fillStyle = "#bbb";
    context.font = `${13 * ratio}px system-ui, sans-serif`;
    context.fillText("decoding…", 12 * ratio, height - 14 * ratio);
  }
  stage.dataset.complete = complete;
  const handle = byId("split");
  handle.hidden = state.mode !== "split";
  handle.style.left = `${state.split * 100}%`;
  handle.setAttribute("aria-valuenow", Math.round(state.split * 100));
  drawReadout();
};

const drawReadout = () => {
  const readout = byId("readout");
  const pane = cursor && paneAt(...cursor);
  const [px, py] = pane ? pictureAt(pane, ...cursor).map(Math.floor) : [-1, -1];
  const { width, height } = currentScene();
  if (px < 0 || py < 0 || px >= width || py >= height) {
    const shown = Math.round(100 / (panes()[0]?.texels || 1) / (window.devicePixelRatio || 1));
    readout.replaceChildren(element("span", {}, `${width} × ${height} pixels, shown at ${shown} %`), element("span", {}, "drag to pan, wheel or pinch to zoom"));
    return;
  }
  const list = state.mode === "tiles" ? entries(currentScene()) : [...new Set([state.a, state.b, REFERENCE])].map(entryOf).filter(Boolean);
  const values = list.map((entry) => {
    const picture = pictureNow(entry.picture);
    const text = picture ? pixelAt(picture, px, py).map((v) => number(v)).join("  ") : "…";
    return element("span", {}, element("b", {}, `${entry.name} `), element("span", { class: "mono" }, text));
  });
  readout.replaceChildren(element("span", {}, element("b", {}, `x ${px}, y ${py}`)), ...values);
};

/** Zooms about a point of the stage. */
const zoomAbout = (factor, point) => {
  const pane = (point && paneAt(...point)) ?? panes()[0];
  if (!pane) return;
  const zoom = clamp(state.zoom * factor, 0.25, 256);
  const { whole } = pane;
  const [dx, dy] = point ? [point[0] - whole.x - whole.width / 2, point[1] - whole.y - whole.height / 2] : [0, 0];
  const moved = pane.texels * (1 - state.zoom / zoom);
  const { width, height } = currentScene();
  change({ zoom, x: clamp(state.x + (dx * moved) / width, 0, 1), y: clamp(state.y + (dy * moved) / height, 0, 1) });
};

const panBy = (dx, dy) => {
  const { texels } = panes()[0] ?? { texels: 1 };
  const { width, height } = currentScene();
  change({ x: clamp(state.x - (dx * texels) / width, 0, 1), y: clamp(state.y - (dy * texels) / height, 0, 1) });
};

/** One pixel of the picture by one of the screen. */
const actualSize = () => {
  const pane = panes()[0];
  if (pane) change({ zoom: clamp(state.zoom * pane.texels * Math.max(1, Math.round(window.devicePixelRatio || 1)), 0.25, 256) });
};

const listenToStage = () => {
  const pointers = new Map();
  let span = 0;
  stage.addEventListener("pointerdown", (event) => {
    if (event.target.id === "split" || event.button > 0) return;
    stage.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, stagePoint(event));
    if (marking !== null && pointers.size === 1) marking = { from: stagePoint(event), to: stagePoint(event) };
    stage.classList.add("dragging");
  });
  stage.addEventListener("pointermove", (event) => {
    const point = stagePoint(event);
    cursor = point;
    const last = pointers.get(event.pointerId);
    if (!last) return drawReadout();
    pointers.set(event.pointerId, point);
    if (marking !== null) {
      marking.to = point;
      return showRubber();
    }
    if (pointers.size === 1) panBy(point[0] - last[0], point[1] - last[1]);
    if (pointers.size === 2) {
      const [p, q] = [...pointers.values()];
      const now = Math.hypot(p[0] - q[0], p[1] - q[1]);
      if (span > 0) zoomAbout(now / span, [(p[0] + q[0]) / 2, (p[1] + q[1]) / 2]);
      span = now;
      panBy((point[0] - last[0]) / 2, (point[1] - last[1]) / 2);
    }
  });
  const end = (event) => {
    if (!pointers.delete(event.pointerId)) return;
    span = 0;
    if (pointers.size === 0) stage.classList.remove("dragging");
    if (marking !== null && marking.from) finishMark();
  };
  stage.addEventListener("pointerup", end);
  stage.addEventListener("pointercancel", end);
  stage.addEventListener("pointerleave", () => {
    cursor = null;
    drawReadout();
  });
  stage.addEventListener("wheel", (event) => {
    event.preventDefault();
    const step = event.deltaMode === 1 ? event.deltaY * 20 : event.deltaY;
    zoomAbout(Math.exp(-clamp(step, -400, 400) * (event.ctrlKey ? 0.01 : 0.003)), stagePoint(event));
  }, { passive: false });
  stage.addEventListener("dblclick", (event) => event.target.id !== "split" && zoomAbout(2, stagePoint(event)));

  const handle = byId("split");
  const move = (event) => {
    const box = stage.getBoundingClientRect();
    change({ split: clamp((event.clientX - box.left) / box.width, 0, 1) });
  };
  handle.addEventListener("pointerdown", (event) => {
    handle.setPointerCapture(event.pointerId);
    event.preventDefault();
    handle.focus();
  });
  handle.addEventListener("pointermove", (event) => handle.hasPointerCapture(event.pointerId) && move(event));
  handle.addEventListener("keydown", (event) => {
    const step = { ArrowLeft: -0.02, ArrowRight: 0.02, Home: -1, End: 1 }[event.key];
    if (step === undefined) return;
    event.preventDefault();
    event.stopPropagation();
    change({ split: clamp(state.split + step, 0, 1) });
  });
  new ResizeObserver(() => change()).observe(stage);
};
