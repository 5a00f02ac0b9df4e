// Small helpers: elements, numbers as text.

/** An element; attributes that are functions are listeners, `style` takes an object. */
const element = (tag, attributes = {}, ...children) => {
  const svg = ["svg", "g", "line", "path", "circle", "text", "rect", "polyline"].includes(tag);
  const node = svg ? document.createElementNS("http://www.w3.org/2000/svg", tag) : document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === "function") node.addEventListener(name, value);
    else if (name === "style") for (const [key, text] of Object.entries(value)) node.style.setProperty(key, text);
    else if (value === true) node.setAttribute(name, "");
    else if (value !== false && value !== undefined && value !== null) node.setAttribute(name, value);
  }
  node.append(...children.filter((child) => child !== undefined && child !== null && child !== ""));
  return node;
};

const byId = (id) => document.getElementById(id);
const clamp = (x, low, high) => Math.min(Math.max(x, low), high);

/** Three digits: 0.0123, 4.56, 78.9, 12 300, 1.2e-7. */
const number = (x, digits = 3) => {
  if (x === undefined || x === null || Number.isNaN(x)) return "–";
  if (!Number.isFinite(x)) return x > 0 ? "∞" : "−∞";
  if (x === 0) return "0";
  const size = Math.abs(x);
  if (size < 1e-3 || size >= 1e6) return x.toExponential(digits - 1).replace("-", "−").replace("e+", "e");
  const places = clamp(digits - 1 - Math.floor(Math.log10(size)), 0, 6);
  return x.toFixed(places).replace("-", "−");
};

/** With a prefix: 1.2 k, 3.4 M. */
const short = (x) => {
  for (const [scale, prefix] of [[1e12, "T"], [1e9, "G"], [1e6, "M"], [1e3, "k"]]) {
    if (Math.abs(x) >= scale) return `${number(x / scale)} ${prefix}`;
  }
  return number(x);
};

/** A figure with the unit of its quantity. */
const withUnit = (x, quantity) => {
  if (x === undefined || x === null) return "–";
  if (["B", "1/s"].includes(quantity.unit) && quantity.key !== "efficiency") return `${short(x)}${quantity.unit === "B" ? "B" : "/s"}`;
  if (["light_paths", "photons", "samples"].includes(quantity.key)) return short(x);
  if (quantity.unit === "s") return `${number(x)} s`;
  if (quantity.unit === "dB") return `${number(x)} dB`;
  return number(x);
};

/** Offers a file to save. */
const download = (blob, name) => {
  const link = element("a", { href: URL.createObjectURL(blob), download: name });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
};

const fileName = (...words) => words.join("-").toLowerCase().replace(/[^a-z0-9]+/g, "-").replace(/^-|-$/g, "");
