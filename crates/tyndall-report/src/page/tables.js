// The overview, the figures, the remarks and the commands.

const thumbs = [];
/** Width of a thumbnail, CSS pixels: all methods side by side if they can be. */
const thumbWidth = (columns) => {
  const room = byId("overview").clientWidth - (report.scenes.length > 1 ? 110 : 0);
  return innerWidth < 640 ? 128 : clamp(Math.floor(room / columns) - 14, 120, 260);
};

const buildGrid = () => {
  const grid = byId("grid");
  const names = [];
  for (const scene of report.scenes) for (const name of [...(scene.reference?.picture != null ? ["Reference"] : []), ...scene.methods.map((m) => m.name)]) if (!names.includes(name)) names.push(name);
  const many = report.scenes.length > 1;
  const measured = report.scenes.some((scene) => scene.reference);
  const ratio = window.devicePixelRatio || 1;
  const width = thumbWidth(names.length);
  grid.replaceChildren();
  if (measured || many) grid.append(element("thead", {}, element("tr", {}, many ? element("th", {}) : null, ...names.map((name) => element("th", { scope: "col" }, name)))));
  const body = element("tbody", {});
  report.scenes.forEach((scene, s) => {
    const height = Math.round((width * scene.height) / scene.width);
    const errors = scene.methods.map((m) => m.figures.relmse?.median ?? Infinity);
    const best = Math.min(...errors);
    const cell = (name) => {
      const entry = entries(scene).find((e) => e.name === name);
      const method = scene.methods.find((m) => m.name === name);
      if (!entry) {
        if (!method) return element("td", {});
        return element("td", {}, element("div", { class: "failed", style: { width: `${width}px`, height: `${height}px` }, title: method.failure }, "failed"));
      }
      const thumb = element("canvas", { width: width * ratio, height: height * ratio, style: { width: `${width}px`, height: `${height}px` } });
      const error = method?.figures.relmse;
      const flagged = method?.split?.significant ? element("span", { class: "flag", title: "differs from the reference by more than noise" }, "bias") : null;
      const caption = element("span", { class: "caption" },
        element("span", { class: error && error.median === best ? "best" : "" }, error ? `relMSE ${number(error.median)}` : entry.index === REFERENCE ? "measured against" : measured ? "" : name), flagged);
      const button = element("button", { type: "button", "aria-label": `${scene.name}, ${name}`, click: (event) => {
        chooseScene(s);
        if (event.shiftKey) change({ b: entry.index });
        else change({ a: entry.index, b: entry.index === state.b ? firstPair(scene).find((i) => i !== entry.index) ?? state.b : state.b });
        if (many) byId("viewer").scrollIntoView();
      } }, thumb, caption);
      thumbs.push({ scene: s, entry, thumb, button });
      return element("td", {}, button);
    };
    body.append(element("tr", {}, many ? element("th", { scope: "row" }, scene.name) : null, ...names.map(cell)));
  });
  grid.append(body);
};

const drawGrid = () => {
  const range = state.display === "colour" ? 0 : rangeNow();
  for (const { scene, entry, button } of thumbs) {
    const here = scene === state.scene;
    button.setAttribute("aria-current", here && entry?.index === state.a);
    button.classList.toggle("second", here && entry?.index === state.b && state.mode !== "tiles" && entry.index !== state.a);
  }
  const jobs = thumbs.filter((item) => item.entry).map((item) => {
    const { width, height } = report.scenes[item.scene];
    const reference = entries(report.scenes[item.scene]).find((e) => e.index === REFERENCE) ?? (report.grid ? against() : item.entry);
    const [display, exposure] = [displayOf(item.entry), state.even ? exposureOf(item.entry) : state.exposure[item.scene]];
    const signature = `${item.scene} ${exposure} ${state.tone} ${display} ${range} ${report.grid && display !== "colour" ? reference.index : ""}`;
    return { canvas: item.thumb, entry: item.entry, reference, display, exposure, region: { x: 0, y: 0, width, height }, item, signature };
  });
  // Each only when what it shows has changed.
  for (const job of painter.paintAll(jobs.filter((job) => job.item.drawn !== job.signature))) job.item.drawn = job.signature;
};

const MAIN_COLUMNS = ["relmse", "robust_relmse", "flip", "hdr_flip", "seconds", "efficiency", "samples", "memory"];
let sorting = null;
let drawnTable = "";

const partsBar = (split) => {
  const parts = [["bias", Math.max(split.bias_squared, 0)], ["noise", Math.max(split.variance, 0)], ["own", Math.max(split.reference, 0)]];
  const total = parts.reduce((sum, [, v]) => sum + v, 0) || 1;
  const title = `bias² ${number(split.bias_squared)} ± ${number(split.bias_error, 2)}, variance ${number(split.variance)}, reference ${number(split.reference)}`;
  return element("span", { class: "parts", title, role: "img", "aria-label": title }, ...parts.map(([name, v]) => element("i", { class: name, style: { width: `${(100 * v) / total}%` } })));
};

const splitCell = (method) => {
  if (!method.split) return element("td", {}, "–");
  const flag = method.split.significant ? element("span", { class: "flag spread", title: "more than four standard errors" }, `bias² ${number(method.split.bias_squared)}`)
    : element("span", { class: "spread" }, "within noise");
  return element("td", {}, partsBar(method.split), flag);
};

const drawFigures = () => {
  const scene = currentScene();
  const every = byId("all-columns").checked;
  const signature = JSON.stringify([state.scene, every, sorting]);
  byId("figures").hidden = !scene.methods.some((m) => m.runs.length);
  if (signature === drawnTable || byId("figures").hidden) return;
  drawnTable = signature;
  const columns = report.quantities.filter((q) => scene.methods.some((m) => m.figures[q.key]) && (every || MAIN_COLUMNS.includes(q.key)));
  const median = (method, key) => method.figures[key]?.median;
  const order = scene.methods.map((method, index) => ({ method, index }));
  if (sorting) order.sort((p, q) => sorting.sign * ((median(p.method, sorting.key) ?? Infinity) - (median(q.method, sorting.key) ?? Infinity)));
  const best = (q) => {
    const values = scene.methods.map((m) => median(m, q.key)).filter((v) => v !== undefined);
    // Nobody is the best of equals.
    if (Math.max(...values) < 1.02 * Math.min(...values)) return null;
    return q.better === null || values.length < 2 ? null : q.better === "low" ? Math.min(...values) : Math.max(...values);
  };
  const heading = (q) => {
    const turn = () => { sorting = { key: q.key, sign: sorting?.key === q.key ? -sorting.sign : q.better === "high" ? -1 : 1 }; change(); };
    const sorted = sorting?.key === q.key ? (sorting.sign > 0 ? "ascending" : "descending") : "none";
    return element("th", { scope: "col", title: q.meaning, "aria-sort": sorted }, element("button", { type: "button", click: turn }, q.label, sorted === "none" ? "" : sorted === "ascending" ? " ↑" : " ↓"));
  };
  const cell = (q, figure) => {
    if (!figure) return element("td", {}, "–");
    const spread = figure.values.length > 1 && figure.high > figure.low ? element("span", { class: "spread", title: "smallest and largest of the repeats" }, `${withUnit(figure.low, q)} … ${withUnit(figure.high, q)}`) : null;
    return element("td", { class: figure.median === best(q) ? "best" : "" }, withUnit(figure.median, q), spread);
  };
  const row = ({ method, index }) => {
    const name = element("td", { title: method.description }, element("span", { class: "dot", style: { background: methodColour(index) } }), method.name);
    if (method.failure) return element("tr", {}, name, element("td", { class: "failure", colspan: columns.length + 1 }, `failed: ${method.failure}`));
    return element("tr", {}, name, ...columns.map((q) => cell(q, method.figures[q.key])), splitCell(method));
  };
  byId("table").replaceChildren(
    element("thead", {}, element("tr", {}, element("th", { scope: "col" }, "method"), ...columns.map(heading), element("th", { scope: "col", title: "parts of relMSE: bias², noise of one render, noise of the reference" }, "bias · noise"))),
    element("tbody", {}, ...order.map(row)));
  drawRemarks(scene);
};

const drawRemarks = (scene) => {
  const remarks = [];
  const reference = scene.reference;
  if (reference) {
    const own = reference.own_error !== null ? `, its own relMSE ${number(reference.own_error)}${reference.aim !== null ? ` (aimed at ${number(reference.aim)}, a tenth of the best contender's)` : ""}` : "";
    const spent = reference.samples !== null ? `, ${short(reference.samples)} samples per pixel in ${number(reference.seconds)} s` : "";
    remarks.push(element("li", {}, element("b", {}, "Reference: "), `${reference.source.replaceAll("`", "")}${spent}${own}.`));
    if (reference.agreement) {
      const t = reference.agreement;
      remarks.push(element("li", { class: t.agree ? "" : "flag" }, `Its independent halves ${t.agree ? "agree" : "do NOT agree"}: mean z² ${number(t.mean_square)} (1 expected), ${number(100 * t.beyond_three)} % of the pixels beyond 3σ, z of the means ${number(t.of_means)}.`));
    }
    reference.warnings.forEach((text) => remarks.push(element("li", { class: "flag" }, text.replaceAll("`", ""))));
  }
  for (const method of scene.methods) {
    if (method.split?.significant) remarks.push(element("li", {}, element("b", {}, `${method.name}: `), `differs from the reference by more than noise (bias² ${number(method.split.bias_squared)} ± ${number(method.split.bias_error, 2)}, ${method.split.renders > 1 ? `from ${method.split.renders} repeats` : "from the render's own variance"}): it is biased, or it has not found all of the light.`));
    if (method.agreement) remarks.push(element("li", { class: method.agreement.agree ? "" : "flag" }, element("b", {}, `${method.name}: `), `two seeds ${method.agreement.agree ? "agree" : "do NOT agree"} (mean z² ${number(method.agreement.mean_square)}, z of the means ${number(method.agreement.of_means)}).`));
    method.warnings.forEach((text) => remarks.push(element("li", {}, element("b", {}, `${method.name}: `), text)));
  }
  if (scene.equal_error !== null) remarks.push(element("li", {}, `Equal error is relMSE ${number(scene.equal_error)}, to which every method of this scene came; see all columns for the time that it took.`));
  byId("remarks").replaceChildren(element("ul", { class: "small" }, ...remarks));
};

const buildCommands = () => {
  byId("commands").hidden = !report.command;
  const blocks = [element("p", { class: "quiet small" }, report.grid ? "This page:" : "The whole comparison:"), element("pre", {}, report.command)];
  for (const scene of report.grid ? [] : report.scenes) {
    const lines = scene.methods.flatMap((method) => [`# ${method.name}: ${method.description}`, ...method.runs.map((run) => run.command), ""]);
    const reference = scene.reference?.commands.length ? ["# reference", ...scene.reference.commands, ""] : [];
    const variables = scene.variables.length ? ` (${scene.variables.map(([name, value]) => `${name}=${value}`).join(", ")})` : "";
    blocks.push(element("details", {}, element("summary", {}, `${scene.name}${variables}`), element("pre", {}, [...lines, ...reference].join("\n").trim())));
  }
  byId("command-list").replaceChildren(...blocks);
};
