// What is shown, kept in the address so that a link keeps the view.

const data = JSON.parse(byId("data").textContent);
const report = data.report;
const REFERENCE = -1;
const MODES = [["single", "Single", "One picture, flip to the other"], ["split", "Split", "A and B with a slider"], ["tiles", "Tiles", "All side by side"]];
const DISPLAYS = [["colour", "Colours"], ["relative", "Relative squared error"], ["absolute", "Absolute error"], ["signed", "Signed error"], ["flip", "FLIP map"]];
const TONES = [["srgb", "sRGB, clipped"], ["reinhard", "Reinhard"], ["filmic", "Filmic"], ["linear", "None (linear)"]];

/** Pictures of a scene: the reference, if there is one, and the methods that have one. */
const entries = (scene) => {
  const methods = scene.methods.map((method, index) => ({ index, name: method.name, picture: method.picture, flip: method.flip, method }));
  const reference = scene.reference && scene.reference.picture !== null
    ? [{ index: REFERENCE, name: "Reference", picture: scene.reference.picture, flip: null, method: null }] : [];
  return [...reference, ...methods.filter((entry) => entry.picture !== null)];
};

const firstPair = (scene) => {
  if (report.grid) return report.grid.first;
  const list = entries(scene).map((entry) => entry.index);
  const rank = (index) => scene.methods[index].figures.relmse?.median ?? Infinity;
  const best = list.filter((index) => index >= 0).sort((x, y) => rank(x) - rank(y));
  const a = best[0] ?? REFERENCE;
  return [a, list.includes(REFERENCE) && a !== REFERENCE ? REFERENCE : best[1] ?? a];
};

const state = {
  scene: 0, mode: "split", a: 0, b: 0, flipped: false, split: 0.5, display: "colour", tone: "srgb", range: null,
  exposure: report.scenes.map(() => report.grid?.exposure ?? 0), even: false, zoom: 1, x: 0.5, y: 0.5, metric: "relmse",
  insets: report.scenes.map((scene) => scene.insets.map((inset) => ({ ...inset }))),
};

const currentScene = () => report.scenes[state.scene];
const entryOf = (index) => entries(currentScene()).find((entry) => entry.index === index);
/** What errors are measured against: the reference, or B where there is none. */
const against = () => entryOf(REFERENCE) ?? entryOf(state.b);

const defaults = () => [state.a, state.b] = report.scenes.length ? firstPair(currentScene()) : [0, 0];

const nameOf = (index) => (index === REFERENCE ? "reference" : currentScene().methods[index]?.name ?? "");
const indexOf = (name) => {
  if (name === "reference" && entryOf(REFERENCE)) return REFERENCE;
  return entries(currentScene()).find((entry) => entry.index >= 0 && entry.name === name)?.index;
};

const writeAddress = () => {
  const round = (x) => Number(x.toFixed(4));
  const fields = {
    scene: currentScene()?.name, mode: state.mode, a: nameOf(state.a), b: nameOf(state.b), show: state.display, curve: state.tone,
    zoom: round(state.zoom), at: `${round(state.x)},${round(state.y)}`, split: round(state.split),
    exposure: state.exposure.map(round).join(","), error: state.metric,
    insets: state.insets.map((list) => list.map((i) => [i.x, i.y, i.width, i.height].join(",")).join(";")).join("|"),
  };
  if (state.flipped) fields.flip = 1;
  if (state.even) fields.even = 1;
  if (state.range !== null) fields.range = round(state.range);
  history.replaceState(null, "", `#${new URLSearchParams(fields)}`);
};

const readAddress = () => {
  const fields = new URLSearchParams(location.hash.slice(1));
  const among = (list, key, old) => (list.some(([name]) => name === fields.get(key)) ? fields.get(key) : old);
  const finite = (text, low, high, old) => {
    const value = text === null || text === "" ? NaN : Number(text);
    return Number.isFinite(value) ? clamp(value, low, high) : old;
  };
  const scene = report.scenes.findIndex((s) => s.name === fields.get("scene"));
  if (scene >= 0) {
    state.scene = scene;
    defaults();
  }
  state.mode = among(MODES, "mode", state.mode);
  state.display = among(DISPLAYS, "show", state.display);
  state.tone = among(TONES, "curve", state.tone);
  state.metric = fields.get("error") ?? state.metric;
  state.a = indexOf(fields.get("a")) ?? state.a;
  state.b = indexOf(fields.get("b")) ?? state.b;
  state.flipped = fields.get("flip") === "1";
  state.even = fields.get("even") === "1";
  state.range = finite(fields.get("range"), -4, 3, null);
  state.zoom = finite(fields.get("zoom"), 0.1, 400, state.zoom);
  state.split = finite(fields.get("split"), 0, 1, state.split);
  const at = (fields.get("at") ?? "").split(",");
  state.x = finite(at[0] ?? null, -1, 2, state.x);
  state.y = finite(at[1] ?? null, -1, 2, state.y);
  const exposures = (fields.get("exposure") ?? "").split(",");
  state.exposure = state.exposure.map((old, i) => finite(exposures[i] ?? null, -20, 20, old));
  if (fields.has("insets")) {
    const lists = fields.get("insets").split("|");
    state.insets = state.insets.map((old, i) => (lists[i] ?? "").split(";").map((text) => text.split(",").map(Number))
      .filter((v) => v.length === 4 && v.every(Number.isInteger) && v[0] >= 0 && v[1] >= 0 && v[2] > 0 && v[3] > 0
        && v[0] + v[2] <= report.scenes[i].width && v[1] + v[3] <= report.scenes[i].height)
      .map(([x, y, width, height]) => ({ x, y, width, height })));
  }
};

const listeners = [];
const onChange = (listener) => listeners.push(listener);
let scheduled = false;
let addressTimer = 0;
/** Changes what is shown; everything is drawn again in the next frame. */
const change = (fields = {}) => {
  Object.assign(state, fields);
  clearTimeout(addressTimer);
  addressTimer = setTimeout(writeAddress, 150);
  if (scheduled) return;
  scheduled = true;
  requestAnimationFrame(() => {
    scheduled = false;
    listeners.forEach((listener) => listener());
  });
};
const chooseScene = (index) => {
  if (index === state.scene) return;
  const names = [nameOf(state.a), nameOf(state.b)];
  state.scene = index;
  defaults();
  const pair = { a: indexOf(names[0]) ?? state.a, b: indexOf(names[1]) ?? state.b };
  // Techniques are looked at in the same place, with weights and without.
  change(report.grid ? pair : { ...pair, zoom: 1, x: 0.5, y: 0.5, flipped: false });
};
