// Decoding of the pictures: base 64, deflate, differences of neighbours by plane (see pictures.rs).

const bytesOf = (text) => {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; i++) bytes[i] = binary.charCodeAt(i);
  return bytes;
};

const inflate = async (bytes) => {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
};

const undoDifferences = (bytes, plane) => {
  for (let start = 0; start < bytes.length; start += plane) {
    for (let i = start + 1; i < start + plane; i++) bytes[i] += bytes[i - 1];
  }
};

const decoded = new Map();
/** A picture by its number: { width, height, kind, values }; halves are RGB by pixel. */
const decode = async (index) => {
  const { width, height, kind } = data.pictures[index];
  const holder = byId(`picture-${index}`);
  const bytes = await inflate(bytesOf(holder.textContent));
  const plane = width * height;
  undoDifferences(bytes, plane);
  if (kind === "byte") return { width, height, kind, values: bytes };
  const values = new Uint16Array(3 * plane);
  for (let channel = 0; channel < 3; channel++) {
    const high = channel * plane;
    const low = (channel + 3) * plane;
    for (let i = 0; i < plane; i++) values[3 * i + channel] = (bytes[high + i] << 8) | bytes[low + i];
  }
  return { width, height, kind, values };
};

/** The picture if it is decoded; else nothing now, and a change when it is. */
const pictureNow = (index) => {
  if (index === null || index === undefined) return null;
  const found = decoded.get(index);
  if (found) return found.values ? found : null;
  const pending = decode(index).then((picture) => {
    decoded.set(index, picture);
    change();
  }, (error) => complain(`Picture ${index} cannot be decoded: ${error.message}`));
  decoded.set(index, pending);
  return null;
};

const complain = (text) => {
  byId("notice").hidden = false;
  byId("notice").textContent = text;
};

const halfToNumber = (bits) => {
  const sign = bits & 0x8000 ? -1 : 1;
  const exponent = (bits >> 10) & 31;
  const fraction = bits & 1023;
  if (exponent === 0) return sign * fraction * 2 ** -24;
  if (exponent === 31) return fraction ? NaN : sign * Infinity;
  return sign * (1 + fraction / 1024) * 2 ** (exponent - 15);
};

/** Red, green and blue of a pixel, or its one value. */
const pixelAt = (picture, x, y) => {
  const i = y * picture.width + x;
  if (picture.kind === "byte") return [picture.values[i] / 255];
  return [0, 1, 2].map((c) => halfToNumber(picture.values[3 * i + c]));
};

const ranges = new Map();
/** The end of the error's scale, a power of ten: as set, or so that a few percent of the pixels of all pictures are beyond. */
const rangeNow = () => {
  if (state.range !== null) return state.range;
  const key = `${state.scene} ${state.display} ${entryOf(REFERENCE) ? "" : state.b}`;
  if (ranges.has(key)) return ranges.get(key);
  const reference = pictureNow(against()?.picture);
  const others = entries(currentScene()).filter((entry) => entry !== against()).map((entry) => pictureNow(entry.picture));
  if (!reference || others.includes(null)) return 0;
  const errors = others.flatMap((picture) => {
    const list = [];
    const all = picture.width * picture.height;
    for (let i = 0; i < all; i += Math.max(1, Math.floor(all / 4000))) {
      const [x, y] = [i % picture.width, Math.floor(i / picture.width)];
      const expected = pixelAt(reference, x, y);
      const difference = pixelAt(picture, x, y).map((v, c) => v - expected[c]);
      const mean = (f) => difference.reduce((sum, d, c) => sum + f(d, expected[c]), 0) / 3;
      list.push(state.display === "relative" ? mean((d, r) => (d * d) / (r * r + 1e-3)) : mean((d) => Math.abs(d)));
    }
    return list;
  }).sort((p, q) => p - q);
  const bright = errors[Math.floor(0.93 * errors.length)];
  const range = bright > 0 ? clamp(Math.round(10 * Math.log10(bright)) / 10, -4, 3) : 0;
  ranges.set(key, range);
  return range;
};

/** The exposure at which the picture's bright parts are just not clipped. */
const usualExposure = (picture, most = 10) => {
  const step = Math.max(1, Math.floor((picture.width * picture.height) / 20000));
  const values = [];
  for (let i = 0; i < picture.width * picture.height; i += step) {
    values.push(Math.max(...pixelAt(picture, i % picture.width, Math.floor(i / picture.width))));
  }
  values.sort((a, b) => a - b);
  const bright = values[Math.floor(values.length * 0.97)] || values.at(-1);
  return bright > 0 ? clamp(Math.round(-10 * Math.log2(bright / 0.9)) / 10, -most, most) : 0;
};
