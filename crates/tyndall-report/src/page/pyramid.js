// The grid of techniques: a pyramid of joins and one for each kind of merges, with a row for each length of paths.

const WEIGHTED = 0;

const ownExposures = new Map();
/** The exposure for all pictures, or each picture's own, so that faint ones show. */
const exposureOf = (entry) => {
  const picture = state.even ? pictureNow(entry.picture) : null;
  if (!picture) return state.exposure[state.scene];
  if (!ownExposures.has(entry.picture)) ownExposures.set(entry.picture, usualExposure(picture, 20));
  return ownExposures.get(entry.picture);
};

const percent = (x) => {
  if (x === null) return "";
  if (x > 0 && x < 0.0005) return "< 0.1 %";
  return x > 9.99 ? `× ${number(x, 2)}` : `${x === 0 ? "0" : number(100 * x, x < 0.0995 ? 2 : 3)} %`;
};

const toggleWeights = () => report.grid && chooseScene(1 - state.scene);
const toggleEven = () => report.grid && change({ even: !state.even });

/** A cell that shows a technique of the scene chosen. */
const pyramidCell = (cell, width, ratio) => {
  const scene = currentScene();
  const height = Math.max(1, Math.round((width * scene.height) / scene.width));
  const method = scene.methods[cell.method];
  const thumb = element("canvas", { width: Math.round(width * ratio), height: Math.round(height * ratio), style: { width: `${width}px`, height: `${height}px` } });
  const share = element("span", {});
  const button = element("button", { type: "button", style: { width: `${width + 4}px` }, title: `${method.name}: ${method.description}`, "aria-label": `${method.name}: ${method.description}`, click: (event) => {
    if (event.shiftKey) change({ b: cell.method });
    else change({ a: cell.method, b: cell.method === state.b ? state.a : state.b });
  } }, thumb, element("span", { class: "caption" }, element("span", { class: "mark" }, cell.label), share));
  thumbs.push({ get scene() { return state.scene; }, get entry() { return entryOf(cell.method); }, thumb, button, share, cell });
  return button;
};

const buildPyramid = () => {
  const { pyramids, note } = report.grid;
  const ratio = window.devicePixelRatio || 1;
  const room = byId("overview").clientWidth;
  // The joins take all of the width, merges half of it where there is enough.
  const build = ({ heading, share, rows }, i) => {
    const most = Math.max(...rows.map((row) => row.cells.length));
    const width = innerWidth < 640 ? 84 : clamp(Math.floor(((i ? room / 2 - 20 : room) - 74) / most) - 8, 72, 168);
    const line = (row) => element("div", { class: "line" },
      element("div", { class: "name", title: "part of the picture's light" }, element("b", {}, row.name), element("span", { class: "share" }, percent(row.share))),
      element("div", { class: "cells" }, ...row.cells.map((cell) => pyramidCell(cell, width, ratio))));
    return element("figure", { class: "pyramid" }, element("figcaption", {}, heading, " ", element("span", { class: "share" }, i ? percent(share) : "")),
      element("div", { class: "scroller" }, element("div", { class: "lines" }, ...rows.map(line))));
  };
  byId("pyramids").replaceChildren(...pyramids.map(build));
  byId("pyramids").addEventListener("keydown", moveInPyramid);
  byId("grid-scroller").hidden = true;
  byId("pyramids").hidden = false;

  byId("pyramid-bar").hidden = byId("pyramid-note").hidden = false;
  byId("weights").replaceChildren(...[["Weighted", "What each adds: together they are the picture"], ["Unweighted", "What each would show if it were the only one"]].map(([text, title], i) =>
    element("label", { title: `${title} (U)` }, element("input", { type: "radio", name: "weights", value: i, change: () => chooseScene(i) }), text)));
  byId("even").addEventListener("click", toggleEven);
  byId("grid-exposure").addEventListener("input", () => expose(Number(byId("grid-exposure").value)));
  byId("pyramid-note").dataset.note = note;
};

/** Arrows go from picture to picture. */
const moveInPyramid = (event) => {
  const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
  const from = thumbs.find((item) => item.button === document.activeElement);
  if (!way || !from || event.ctrlKey || event.metaKey || event.altKey) return;
  event.preventDefault();
  event.stopPropagation();
  const middle = (item) => {
    const box = item.button.getBoundingClientRect();
    return [box.left + box.width / 2, box.top + box.height / 2];
  };
  const [x, y] = middle(from);
  const { width, height } = from.button.getBoundingClientRect();
  const found = thumbs.filter((item) => !item.button.hidden).map((item) => {
    const [dx, dy] = [middle(item)[0] - x, middle(item)[1] - y];
    // Along the way first, then as little aside as can be.
    return way[0] ? { item, along: dx * way[0], far: Math.abs(dy) < height / 2 ? dx * way[0] : Infinity }
      : { item, along: dy * way[1], far: Math.round((dy * way[1]) / height) * 1e4 + Math.abs(dx) };
  }).filter(({ along, far }) => along > (way[0] ? width : height) / 2 && far < Infinity).sort((p, q) => p.far - q.far)[0];
  if (!found) return;
  found.item.button.focus();
  change({ a: found.item.cell.method, b: found.item.cell.method === state.b ? state.a : state.b });
};

const drawPyramid = () => {
  if (!report.grid) return;
  for (const { button, share, cell } of thumbs) {
    button.hidden = !entryOf(cell.method);
    share.textContent = percent(cell.shares[state.scene]);
    share.title = state.scene === WEIGHTED ? "part of the picture's light" : "light that it claims, in parts of all light of its depth; noisy where it is rarely lucky";
  }
  document.querySelectorAll("#weights input").forEach((input) => { input.checked = Number(input.value) === state.scene; });
  byId("even").setAttribute("aria-pressed", Boolean(state.even));
  byId("grid-exposure").value = state.exposure[state.scene];
  byId("grid-exposure").disabled = Boolean(state.even);
  byId("grid-exposure-value").textContent = state.even ? "own" : byId("exposure-value").textContent;
  const text = state.scene === WEIGHTED ? "Each technique with its weights: all pictures together are the picture at the top. The share is that of its light."
    : "Each technique as if it were the only one: those of a depth that can find all its paths have one expectation, and differ by noise. The share is that of the light of this depth.";
  byId("pyramid-note").textContent = `${text} ${byId("pyramid-note").dataset.note}`;
};
