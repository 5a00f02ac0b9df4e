// Error over time on logarithmic axes, drawn as SVG.

const METHOD_COLOURS = 8;
const methodColour = (index) => `var(--m${index % METHOD_COLOURS})`;

/** Powers of ten and what lies between them. */
const ticks = (low, high) => {
  const marks = [];
  for (let e = Math.floor(low); e <= Math.ceil(high); e++) {
    for (let m = 1; m < 10; m++) {
      const at = e + Math.log10(m);
      if (at >= low - 1e-9 && at <= high + 1e-9) marks.push({ at, value: m * 10 ** e, major: m === 1, label: m === 1 || ((m === 2 || m === 5) && high - low < 1.6) });
    }
  }
  return marks;
};

const axisLabel = (value) => (value >= 0.001 && value < 10000 ? String(Number(value.toPrecision(1))) : value.toExponential(0).replace("e+", "e").replace("-", "−"));

const drawPlot = () => {
  const scene = currentScene();
  const chart = byId("chart");
  const curves = scene.methods.map((method, index) => ({
    index, method,
    points: method.curve.map((p) => ({ ...p, error: p.errors[state.metric] })).filter((p) => p.error > 0 && p.seconds > 0),
  })).filter((curve) => curve.points.length > 0);
  byId("plot").hidden = curves.length === 0;
  if (curves.length === 0) return;
  const width = Math.max(320, chart.clientWidth || 900);
  const narrow = width < 640;
  const height = narrow ? 340 : 440;
  const margin = { left: 62, right: narrow ? 18 : 130, top: 18, bottom: 46 };
  const all = curves.flatMap((curve) => curve.points);
  const range = (values) => {
    const [low, high] = [Math.log10(Math.min(...values)), Math.log10(Math.max(...values))];
    const pad = Math.max(0.06 * (high - low), 0.08);
    return [low - pad, high + pad];
  };
  const [x0, x1] = range(all.map((p) => p.seconds));
  const [y0, y1] = range(all.map((p) => p.error));
  const X = (v) => margin.left + ((Math.log10(v) - x0) / (x1 - x0)) * (width - margin.left - margin.right);
  const Y = (v) => height - margin.bottom - ((Math.log10(v) - y0) / (y1 - y0)) * (height - margin.top - margin.bottom);
  const [right, bottom] = [width - margin.right, height - margin.bottom];
  const quantity = report.quantities.find((q) => q.key === state.metric);
  const svg = element("svg", { viewBox: `0 0 ${width} ${height}`, height, role: "img", "aria-label": `${quantity.label} over time of ${scene.name}` });
  for (const tick of ticks(x0, x1)) {
    const x = X(tick.value);
    svg.append(element("line", { class: tick.major ? "major" : "minor", x1: x, x2: x, y1: margin.top, y2: bottom }));
    if (tick.label) svg.append(element("text", { x, y: bottom + 17, "text-anchor": "middle" }, axisLabel(tick.value)));
  }
  for (const tick of ticks(y0, y1)) {
    const y = Y(tick.value);
    svg.append(element("line", { class: tick.major ? "major" : "minor", x1: margin.left, x2: right, y1: y, y2: y }));
    if (tick.label) svg.append(element("text", { x: margin.left - 8, y: y + 4, "text-anchor": "end" }, axisLabel(tick.value)));
  }
  svg.append(element("rect", { class: "frame", x: margin.left, y: margin.top, width: right - margin.left, height: bottom - margin.top }));
  svg.append(element("text", { class: "title", x: (margin.left + right) / 2, y: height - 9, "text-anchor": "middle" }, "seconds since the start, loading included"));
  svg.append(element("text", { class: "title", x: 0, y: 0, transform: `translate(15 ${(margin.top + bottom) / 2}) rotate(-90)`, "text-anchor": "middle" }, quantity.label));

  const middle = 10 ** ((x0 + x1) / 2);
  const top = 10 ** (y1 - 0.04 * (y1 - y0));
  const slope = ["relmse", "robust_relmse"].includes(state.metric) ? -1 : -0.5;
  const decades = Math.min(0.5 * (x1 - x0), (0.6 * (y1 - y0)) / Math.abs(slope)) / 2;
  const [gx0, gx1, gy0, gy1] = [middle * 10 ** -decades, middle * 10 ** decades, top, top * 10 ** (2 * decades * slope)];
  svg.append(element("line", { class: "guide", x1: X(gx0), y1: Y(gy0), x2: X(gx1), y2: Y(gy1) }));
  svg.append(element("text", { x: X(gx0) + 6, y: Y(gy0) - 4 > margin.top + 10 ? Y(gy0) - 4 : Y(gy0) + 4, dx: 6 }, slope === -1 ? "slope −1: unbiased" : "slope −½: unbiased"));

  const tip = element("div", { id: "tip", hidden: true });
  const names = [];
  for (const { index, method, points } of curves) {
    const colour = methodColour(index);
    const group = element("g", { "data-method": index });
    group.append(element("polyline", { class: "curve", stroke: colour, points: points.map((p) => `${X(p.seconds)},${Y(p.error)}`).join(" ") }));
    for (const point of points) {
      const dot = element("circle", { cx: X(point.seconds), cy: Y(point.error), r: 3.6, fill: colour });
      const hit = element("circle", { cx: X(point.seconds), cy: Y(point.error), r: 13, fill: "transparent" });
      const show = () => {
        tip.hidden = false;
        tip.textContent = `${method.name}: ${number(point.error)} after ${number(point.seconds)} s, ${short(point.samples)} samples per pixel`;
        const at = clamp((X(point.seconds) / width) * chart.clientWidth, tip.offsetWidth / 2 + 4, chart.clientWidth - tip.offsetWidth / 2 - 4);
        tip.style.left = `${at}px`;
        tip.style.top = `${Y(point.error)}px`;
      };
      hit.addEventListener("pointerenter", show);
      hit.addEventListener("pointerleave", () => { tip.hidden = true; });
      group.append(dot, hit);
    }
    const last = points[points.length - 1];
    names.push({ index, name: method.name, x: X(last.seconds), y: Y(last.error) });
    svg.append(group);
  }
  // The names at the curves' ends, moved apart.
  names.sort((p, q) => p.y - q.y);
  names.forEach((name, i) => { name.at = Math.max(name.y, i ? names[i - 1].at + 15 : margin.top + 6); });
  const over = names.length ? names[names.length - 1].at - (bottom - 2) : 0;
  if (over > 0) names.reduceRight((limit, name) => { name.at = Math.min(name.at, limit); return name.at - 15; }, bottom - 2);
  if (!narrow) for (const name of names) {
    svg.append(element("text", { class: "name", x: right + 10, y: name.at + 4, style: { fill: methodColour(name.index) } }, name.name));
  }
  chart.replaceChildren(svg, tip);
  const dim = (index) => svg.querySelectorAll("g[data-method]").forEach((g) => g.classList.toggle("dim", index !== null && g.dataset.method !== String(index)));
  byId("legend").replaceChildren(...curves.map(({ index, method }) => {
    const fit = method.slope && state.metric === "relmse" ? `slope ${number(method.slope.slope)} ± ${number(method.slope.slope_error, 2)}` : "";
    return element("li", { pointerenter: () => dim(index), pointerleave: () => dim(null) },
      element("i", { style: { background: methodColour(index) } }), element("span", {}, method.name), element("span", { class: "quiet" }, fit));
  }));
  byId("plot-note").textContent = "Each curve is one render, looked at in passing; other renderers were started anew for every point. Slopes of relMSE are fitted over rendering time alone: −1 is the slope of noise, a flat end is bias or the noise of the reference.";
};
