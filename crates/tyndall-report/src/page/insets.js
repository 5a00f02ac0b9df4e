// Regions looked at closely: marked on the stage, shown for all pictures, saved as PNG.

const INSET_COLOURS = ["#ffb347", "#5ec8ff", "#7ee081", "#ff7eb6", "#c9a7ff", "#f2e35b"];
const insetColour = (i) => INSET_COLOURS[i % INSET_COLOURS.length];
/** Width of a crop in the row, CSS pixels. */
const CROP = 168;

const setMarking = (on) => {
  marking = on ? {} : null;
  byId("rubber").hidden = true;
  stage.classList.toggle("marking", on);
  byId("inset").setAttribute("aria-pressed", on);
};

const showRubber = () => {
  const ratio = window.devicePixelRatio || 1;
  const { from, to } = marking;
  const rubber = byId("rubber");
  rubber.hidden = false;
  const [x, y] = [Math.min(from[0], to[0]), Math.min(from[1], to[1])];
  rubber.style.left = `${x / ratio}px`;
  rubber.style.top = `${y / ratio}px`;
  rubber.style.width = `${Math.abs(to[0] - from[0]) / ratio}px`;
  rubber.style.height = `${Math.abs(to[1] - from[1]) / ratio}px`;
};

const finishMark = () => {
  const { from, to } = marking;
  const pane = paneAt(...from);
  setMarking(false);
  if (!pane) return;
  const { width, height } = currentScene();
  const corners = [pictureAt(pane, ...from), pictureAt(pane, ...to)];
  const span = (axis, size) => {
    const [low, high] = [corners[0][axis], corners[1][axis]].sort((p, q) => p - q);
    const start = clamp(Math.floor(low), 0, size - 1);
    return [start, clamp(Math.ceil(high), start + 1, size) - start];
  };
  const [[x, w], [y, h]] = [span(0, width), span(1, height)];
  if (w < 2 || h < 2) return;
  state.insets[state.scene].push({ x, y, width: w, height: h });
  change();
};

/** The region for all pictures side by side, as one canvas with names. */
const insetFigure = (insets, scale) => {
  const list = entries(currentScene());
  const { width, height } = currentScene();
  const [gap, head, crop] = [8 * scale, 22 * scale, CROP * scale];
  const heights = insets.map((inset) => Math.round((crop * inset.height) / inset.width));
  const rows = heights.reduce((sum, h) => sum + h + gap, 0) - gap;
  const lead = insets.length > 1 || state.insets[state.scene].length === 1 ? Math.round((rows * width) / height) : 0;
  const sheet = element("canvas", { width: Math.max(1, lead + (lead ? gap : 0) + list.length * (crop + gap) - gap), height: head + rows });
  const context = sheet.getContext("2d");
  context.fillStyle = "#ffffff";
  context.fillRect(0, 0, sheet.width, sheet.height);
  const paste = (entry, region, x, y, w, h, colour) => {
    const piece = element("canvas", { width: Math.max(1, Math.round(w)), height: Math.max(1, Math.round(h)) });
    painter.paintAll([{ canvas: piece, entry, reference: against(), display: displayOf(entry), exposure: exposureOf(entry), region }]);
    context.drawImage(piece, x, y);
    if (!colour) return;
    context.strokeStyle = colour;
    context.lineWidth = 3 * scale;
    context.strokeRect(x + 1.5 * scale, y + 1.5 * scale, piece.width - 3 * scale, piece.height - 3 * scale);
  };
  const write = (text, x) => {
    context.fillStyle = "#111";
    context.font = `600 ${13 * scale}px system-ui, sans-serif`;
    context.fillText(text, x, 15 * scale, crop);
  };
  if (lead) {
    const shown = entryOf(state.a) ?? list[0];
    paste(shown, { x: 0, y: 0, width, height }, 0, head, lead, rows);
    write(`${currentScene().name}: ${shown.name}`, 0);
    insets.forEach((inset, i) => {
      const k = lead / width;
      context.strokeStyle = insetColour(state.insets[state.scene].indexOf(inset));
      context.lineWidth = 3 * scale;
      context.strokeRect(inset.x * k, head + inset.y * k, inset.width * k, inset.height * k);
    });
  }
  list.forEach((entry, column) => {
    const x = lead + (lead ? gap : 0) + column * (crop + gap);
    write(entry.name, x);
    let y = head;
    insets.forEach((inset, i) => {
      paste(entry, inset, x, y, crop, heights[i], insetColour(state.insets[state.scene].indexOf(inset)));
      y += heights[i] + gap;
    });
  });
  return sheet;
};

const saveInsets = (insets, name) => insetFigure(insets, 2).toBlob((blob) => download(blob, `${name}.png`), "image/png");

/** Without a map of FLIP there are the colours. */
const displayOf = (entry) => (state.display === "flip" && entry.flip === null ? "colour" : state.display);

let drawnInsets = "";
let paintedInsets = "";
const drawInsets = () => {
  const list = entries(currentScene());
  const insets = state.insets[state.scene];
  const section = byId("insets");
  section.hidden = insets.length === 0;
  const signature = JSON.stringify([state.scene, insets]);
  if (signature !== drawnInsets) {
    drawnInsets = signature;
    byId("inset-rows").replaceChildren(...insets.map((inset, i) => {
      const crops = list.map((entry) => {
        const ratio = window.devicePixelRatio || 1;
        const height = Math.max(1, Math.round((CROP * inset.height) / inset.width));
        const piece = element("canvas", { width: CROP * ratio, height: height * ratio, style: { width: `${CROP}px`, height: `${height}px`, border: `2px solid ${insetColour(i)}` } });
        return element("figure", { "data-entry": entry.index }, element("figcaption", {}, entry.name), piece);
      });
      const tools = element("div", { class: "tools" },
        element("span", {}, `${inset.width} × ${inset.height} at ${inset.x}, ${inset.y}`),
        element("button", { type: "button", click: () => saveInsets([inset], fileName(currentScene().name, "inset", String(i + 1))) }, "Save PNG"),
        element("button", { type: "button", click: () => zoomTo(inset) }, "Look"),
        element("button", { type: "button", click: () => { insets.splice(i, 1); change(); } }, "Remove"));
      return element("div", { class: "inset-row" }, tools, ...crops);
    }));
  }
  const shown = JSON.stringify([signature, state.display, state.exposure, state.even, state.tone, state.display === "colour" ? 0 : rangeNow(), against()?.index, list.map((e) => Boolean(pictureNow(e.picture)))]);
  if (shown === paintedInsets) return;
  paintedInsets = shown;
  const rows = [...byId("inset-rows").querySelectorAll(".inset-row")];
  painter.paintAll(rows.flatMap((row, i) => [...row.querySelectorAll("figure")].map((figure) => {
    const entry = list.find((e) => String(e.index) === figure.dataset.entry);
    return { canvas: figure.querySelector("canvas"), entry, reference: against(), display: displayOf(entry), exposure: exposureOf(entry), region: insets[i] };
  })));
};

const zoomTo = (inset) => {
  const { width, height } = currentScene();
  const zoom = clamp(0.8 * Math.min(width / inset.width, height / inset.height), 1, 64);
  change({ zoom, x: (inset.x + inset.width / 2) / width, y: (inset.y + inset.height / 2) / height });
  byId("viewer").scrollIntoView();
};
