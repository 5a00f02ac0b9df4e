// Controls, keys, and putting it all together.

const KEYS = [
  ["Space", "show the other one (A or B)"], ["1 2 3", "layout: single, split, tiles"], ["← → ↑ ↓", "pan"], ["+ −", "zoom"], ["0", "whole picture"], ["P", "one pixel each"],
  ["A B", "next picture as A or B (⇧ previous)"], ["X", "swap A and B"], ["[ ]", "scene before or after"], [", .", "move the split"], ["E", "brighter (⇧ darker)"],
  ["O", "exposure from the picture"], ["D", "colours, errors, FLIP (⇧ back)"], ["C", "next curve"], ["I", "mark an inset"], ["W", "fill the window"], ["L", "copy a link to this view"], ["?", "these keys"],
  ...(report.grid ? [["U", "weighted or unweighted"], ["G", "every picture at its own exposure"], ["← → ↑ ↓", "in the grid: the next picture"]] : []),
];

const fill = (select, list) => select.replaceChildren(...list.map(([value, text]) => element("option", { value }, text)));

const step = (list, value, by) => list[(list.indexOf(value) + by + list.length) % list.length];
const stepEntry = (which, by) => change({ [which]: step(entries(currentScene()).map((e) => e.index), state[which], by), flipped: false });
const displays = () => DISPLAYS.filter(([name]) => (name !== "flip" || currentScene().methods.some((m) => m.flip !== null)) && (name === "colour" || name === "flip" || entries(currentScene()).length > 1));
const expose = (stops) => {
  state.exposure = state.exposure.map((old, i) => (i === state.scene || report.grid ? clamp(stops, -20, 20) : old));
  change();
};
const autoExpose = () => {
  const picture = pictureNow((entryOf(REFERENCE) ?? entryOf(state.a))?.picture);
  if (picture) expose(usualExposure(picture));
};
const toggleWide = () => {
  byId("wide").setAttribute("aria-pressed", document.body.classList.toggle("wide"));
  change();
};
const copyLink = async () => {
  writeAddress();
  try {
    await navigator.clipboard.writeText(location.href);
    byId("link").textContent = "Copied";
  } catch {
    byId("link").textContent = "In the address bar";
  }
  setTimeout(() => { byId("link").textContent = "Copy link"; }, 1500);
};
const saveView = () => canvas.toBlob((blob) => download(blob, `${fileName(currentScene().name, state.mode, state.display)}.png`), "image/png");

const drawControls = () => {
  const list = entries(currentScene());
  for (const which of ["a", "b"]) {
    const signature = list.map((e) => e.name).join("\n");
    if (byId(which).dataset.list !== signature) {
      byId(which).dataset.list = signature;
      fill(byId(which), list.map((e) => [e.index, e.name]));
    }
    byId(which).value = state[which];
    byId(which).closest(".field").hidden = list.length < 2;
  }
  byId("swap").hidden = byId("flip").hidden = list.length < 2;
  if (!displays().some(([name]) => name === state.display)) state.display = "colour";
  if (byId("display").length !== displays().length) fill(byId("display"), displays());
  byId("scene").value = state.scene;
  byId("display").value = state.display;
  byId("tone").value = state.tone;
  byId("flip").setAttribute("aria-pressed", state.flipped);
  const exposure = state.exposure[state.scene];
  byId("exposure").value = exposure;
  byId("exposure-value").textContent = `${exposure > 0 ? "+" : exposure < 0 ? "−" : ""}${Math.abs(exposure).toFixed(1)} EV`;
  byId("range").value = rangeNow();
  byId("range-value").textContent = number(state.display === "flip" ? 1 : 10 ** rangeNow(), 2);
  byId("scale").style.background = state.display === "signed" ? SIGNED_STYLE : rampStyle();
  byId("scale").nextElementSibling.textContent = state.display === "signed" ? `−${number(10 ** rangeNow(), 2)}` : "0";
  const colour = state.display === "colour";
  byId("exposure-field").hidden = byId("tone-field").hidden = byId("auto").hidden = !colour;
  byId("range-field").hidden = colour;
  byId("range").hidden = document.querySelector("[for=range]").hidden = state.display === "flip";
  document.querySelectorAll("#modes input").forEach((input) => { input.checked = input.value === state.mode; });
  byId("metric").value = state.metric;
};

const buildControls = () => {
  byId("scene-field").hidden = report.scenes.length < 2 || Boolean(report.grid);
  fill(byId("scene"), report.scenes.map((scene, i) => [i, scene.name]));
  fill(byId("tone"), TONES);
  fill(byId("display"), displays());
  const curves = report.scenes.flatMap((s) => s.methods.flatMap((m) => m.curve)).flatMap((p) => Object.keys(p.errors));
  const metrics = report.quantities.filter((q) => curves.includes(q.key)).map((q) => [q.key, q.label]);
  fill(byId("metric"), metrics);
  if (!metrics.some(([key]) => key === state.metric)) state.metric = metrics[0]?.[0] ?? "relmse";
  byId("modes").replaceChildren(...MODES.map(([value, text, title]) => element("label", { title },
    element("input", { type: "radio", name: "mode", value, change: () => change({ mode: value }) }), text)));
  const listen = (id, type, action) => byId(id).addEventListener(type, action);
  listen("scene", "change", () => chooseScene(Number(byId("scene").value)));
  for (const which of ["a", "b"]) listen(which, "change", () => change({ [which]: Number(byId(which).value), flipped: false }));
  listen("display", "change", () => change({ display: byId("display").value }));
  listen("tone", "change", () => change({ tone: byId("tone").value }));
  listen("metric", "change", () => change({ metric: byId("metric").value }));
  listen("exposure", "input", () => expose(Number(byId("exposure").value)));
  listen("range", "input", () => change({ range: Number(byId("range").value) }));
  listen("all-columns", "change", () => change());
  const buttons = {
    swap: () => change({ a: state.b, b: state.a }), flip: () => change({ flipped: !state.flipped }), fit: () => change({ zoom: 1, x: 0.5, y: 0.5 }), actual: actualSize,
    wide: toggleWide, auto: autoExpose, inset: () => setMarking(marking === null), link: copyLink, save: saveView,
    export: () => saveInsets(state.insets[state.scene], fileName(currentScene().name, "insets")), "help-open": () => byId("help").showModal(),
    theme: () => setTheme(document.documentElement.classList.contains("dark") ? "light" : "dark"),
  };
  for (const [id, action] of Object.entries(buttons)) listen(id, "click", action);
  byId("keys").replaceChildren(...KEYS.flatMap(([keys, text]) => [element("dt", {}, ...keys.split(" ").map((key) => element("kbd", {}, key))), element("dd", {}, text)]));
};

const listenToKeys = () => document.addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey || byId("help").open) return;
  if (event.target.matches("select, input:not([type=range]):not([type=radio]):not([type=checkbox])")) return;
  const arrows = event.target.matches("input[type=range], input[type=radio]");
  const by = event.shiftKey ? -1 : 1;
  const far = 40 * (window.devicePixelRatio || 1);
  const near = { ArrowLeft: [far, 0], ArrowRight: [-far, 0], ArrowUp: [0, far], ArrowDown: [0, -far] }[event.key];
  // Arrows scroll the page unless the stage is what is used.
  if (near && !arrows && (document.activeElement === stage || document.body.classList.contains("wide"))) {
    event.preventDefault();
    return panBy(...near);
  }
  const names = displays().map(([name]) => name);
  const actions = {
    " ": () => change({ flipped: !state.flipped }), f: () => change({ flipped: !state.flipped }),
    1: () => change({ mode: "single" }), 2: () => change({ mode: "split" }), 3: () => change({ mode: "tiles" }),
    "+": () => zoomAbout(1.25), "=": () => zoomAbout(1.25), "-": () => zoomAbout(0.8), 0: () => change({ zoom: 1, x: 0.5, y: 0.5 }), p: actualSize,
    a: () => stepEntry("a", by), b: () => stepEntry("b", by), x: () => change({ a: state.b, b: state.a }),
    "[": () => chooseScene(Math.max(0, state.scene - 1)), "]": () => chooseScene(Math.min(report.scenes.length - 1, state.scene + 1)),
    ",": () => change({ split: clamp(state.split - 0.02, 0, 1) }), ".": () => change({ split: clamp(state.split + 0.02, 0, 1) }),
    e: () => expose(state.exposure[state.scene] + 0.5 * by), o: autoExpose, d: () => change({ display: step(names, state.display, by) }),
    c: () => change({ tone: step(TONES.map(([name]) => name), state.tone, by) }), i: () => setMarking(marking === null), w: toggleWide, u: toggleWeights, g: toggleEven, l: copyLink, "?": () => byId("help").showModal(),
    escape: () => { setMarking(false); if (document.body.classList.contains("wide")) toggleWide(); },
  };
  const action = actions[event.key.toLowerCase()];
  if (!action || (event.key === " " && event.target.matches("button, summary, a, input"))) return;
  event.preventDefault();
  action();
});

const setTheme = (name) => {
  document.documentElement.classList.toggle("dark", name === "dark");
  try {
    localStorage.setItem("tyndall-theme", name);
  } catch { /* pages opened from disk may not keep anything */ }
};

const start = () => {
  let theme = null;
  try {
    theme = localStorage.getItem("tyndall-theme");
  } catch { /* as above */ }
  setTheme(theme ?? (matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light"));
  const count = Math.max(0, ...report.scenes.map((scene) => scene.methods.length));
  const measured = report.scenes.some((scene) => scene.reference);
  byId("title").textContent = report.title;
  const several = (n, word) => `${n} ${word}${n === 1 ? "" : "s"}`;
  const parts = report.grid ? [report.budget] : measured
    ? [`${several(report.scenes.length, "scene")} × ${several(count, "method")}`, report.budget, report.repeats > 1 ? `median of ${report.repeats} repeats` : "one render each", `${several(report.machine.threads, "thread")}${report.machine.processor ? ` on ${report.machine.processor}` : ""}`]
    : [several(report.scenes.reduce((sum, scene) => sum + scene.methods.length, 0), "picture")];
  byId("subtitle").textContent = parts.filter(Boolean).join("  ·  ");
  byId("footer").textContent = [report.program, report.machine.system, report.created].filter(Boolean).join("  ·  ");
  if (!report.scenes.length) return complain("There is nothing to show.");
  if (!painter) return complain("This browser has no WebGL2, which the pictures need.");
  defaults();
  if (entries(currentScene()).length < 2) state.mode = "single";
  readAddress();
  (report.grid ? buildPyramid : buildGrid)();
  buildControls();
  buildCommands();
  listenToStage();
  listenToKeys();
  const guarded = (part) => () => {
    try {
      part();
    } catch (error) {
      console.error(error);
      complain(`Something went wrong: ${error.message}`);
    }
  };
  [drawControls, drawPyramid, drawStage, drawGrid, drawInsets, drawFigures].forEach((part) => onChange(guarded(part)));
  let drawnPlot = "";
  const plotIfNew = () => {
    const signature = JSON.stringify([state.scene, state.metric, byId("chart").clientWidth]);
    if (signature !== drawnPlot) drawPlot();
    drawnPlot = JSON.stringify([state.scene, state.metric, byId("chart").clientWidth]);
  };
  onChange(guarded(plotIfNew));
  addEventListener("resize", () => change());
  addEventListener("hashchange", () => { readAddress(); change(); });
  change();
  // For those who drive the page from outside.
  window.tyndall = { state, change, ready: () => stage.dataset.complete === "true", entries: () => entries(currentScene()).map((e) => e.name) };
};

start();
