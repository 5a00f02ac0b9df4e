// Draws pictures with WebGL2 on float data: exposure, curve and errors are computed for every pixel shown.

const VERTEX = `#version 300 es
void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0); }`;

const FRAGMENT = `#version 300 es
precision highp float;
uniform sampler2D picture, reference, map;
uniform ivec2 size;
uniform vec2 origin, paneCorner;
uniform float texels, gain, limit, targetHeight;
uniform int display, curve;
uniform vec3 stops[7];
out vec4 colour;

float encode(float x) { return x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1.0 / 2.4) - 0.055; }
float bend(float x) {
  x = max(x, 0.0);
  if (curve == 1) return x / (1.0 + x);
  // x (x + c/2) / (x^2 + b x + c), with 0.18 -> 0.18 and 1 -> 0.8, as the program's .png.
  if (curve == 2) return x > 1e6 ? 1.0 : x * (x + 0.1186127) / (x * (x + 0.16104046) + 0.23722543);
  return min(x, 1.0);
}
vec3 ramp(float t) {
  float s = clamp(t, 0.0, 1.0) * 6.0;
  int i = min(int(s), 5);
  return mix(stops[i], stops[i + 1], s - float(i));
}
vec3 shown(ivec2 at) {
  vec3 value = texelFetch(picture, at, 0).rgb;
  if (display == 4) return ramp(texelFetch(map, at, 0).r);
  if (display == 0) {
    vec3 bent = value * gain;
    bent = vec3(bend(bent.r), bend(bent.g), bend(bent.b));
    return curve == 3 ? bent : vec3(encode(bent.r), encode(bent.g), encode(bent.b));
  }
  vec3 expected = texelFetch(reference, at, 0).rgb;
  vec3 d = value - expected;
  if (display == 1) return ramp(dot(d * d / (expected * expected + 1e-3), vec3(1.0 / 3.0)) / limit);
  if (display == 2) return ramp(dot(abs(d), vec3(1.0 / 3.0)) / limit);
  float s = clamp(dot(d, vec3(1.0 / 3.0)) / limit, -1.0, 1.0);
  vec3 end = s < 0.0 ? vec3(0.18, 0.50, 0.95) : vec3(0.96, 0.42, 0.12);
  return mix(vec3(0.10), end, abs(s));
}
void main() {
  vec2 here = vec2(gl_FragCoord.x, targetHeight - gl_FragCoord.y) - paneCorner;
  vec2 centre = origin + here * texels;
  if (any(lessThan(centre, vec2(0.0))) || any(greaterThanEqual(centre, vec2(size)))) { colour = vec4(0.0); return; }
  // Where a screen pixel covers several of the picture, their colours are averaged.
  int n = clamp(int(ceil(texels - 0.01)), 1, 6);
  vec3 sum = vec3(0.0);
  for (int j = 0; j < n; j++) for (int i = 0; i < n; i++) {
    vec2 at = centre + (vec2(i, j) + 0.5 - 0.5 * float(n)) * (texels / float(n));
    sum += shown(clamp(ivec2(floor(n == 1 ? centre : at)), ivec2(0), size - 1));
  }
  colour = vec4(sum / float(n * n), 1.0);
}`;

/** Black over violet, red and orange to pale yellow: lightness rises evenly. */
const RAMP = [[0.01, 0.01, 0.06], [0.22, 0.06, 0.38], [0.50, 0.11, 0.44], [0.79, 0.23, 0.32], [0.96, 0.45, 0.16], [0.98, 0.73, 0.25], [0.99, 0.98, 0.80]];
const rampStyle = () => `linear-gradient(90deg, ${RAMP.map((c) => `rgb(${c.map((v) => Math.round(v * 255)).join(" ")})`).join(", ")})`;
const SIGNED_STYLE = "linear-gradient(90deg, rgb(46 128 242), rgb(26 26 26), rgb(245 107 31))";

const painter = (() => {
  const canvas = document.createElement("canvas");
  const gl = canvas.getContext("webgl2", { alpha: true, antialias: false, premultipliedAlpha: false, preserveDrawingBuffer: true });
  if (!gl) return null;
  const compile = (type, source) => {
    const shader = gl.createShader(type);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    return shader;
  };
  let program, uniform, textures;
  const prepare = () => {
    program = gl.createProgram();
    gl.attachShader(program, compile(gl.VERTEX_SHADER, VERTEX));
    gl.attachShader(program, compile(gl.FRAGMENT_SHADER, FRAGMENT));
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
    gl.useProgram(program);
    uniform = (name) => gl.getUniformLocation(program, name);
    gl.bindVertexArray(gl.createVertexArray());
    ["picture", "reference", "map"].forEach((name, unit) => gl.uniform1i(uniform(name), unit));
    gl.uniform3fv(uniform("stops"), new Float32Array(RAMP.flat()));
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    textures = new Map();
  };
  prepare();
  canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
  canvas.addEventListener("webglcontextrestored", () => { prepare(); change(); });

  const textureOf = (index) => {
    const picture = pictureNow(index);
    if (!picture) return null;
    if (!textures.has(index)) {
      const texture = gl.createTexture();
      gl.activeTexture(gl.TEXTURE0);
      gl.bindTexture(gl.TEXTURE_2D, texture);
      const half = picture.kind === "half";
      gl.texImage2D(gl.TEXTURE_2D, 0, half ? gl.RGB16F : gl.R8, picture.width, picture.height, 0, half ? gl.RGB : gl.RED,
        half ? gl.HALF_FLOAT : gl.UNSIGNED_BYTE, picture.values);
      for (const [name, value] of [[gl.TEXTURE_MIN_FILTER, gl.NEAREST], [gl.TEXTURE_MAG_FILTER, gl.NEAREST],
        [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE], [gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE]]) gl.texParameteri(gl.TEXTURE_2D, name, value);
      textures.set(index, texture);
    }
    return textures.get(index);
  };

  const complete = (pane) => texturesOf(pane).every((texture) => texture !== null);
  const texturesOf = (pane) => {
    const compared = !["colour", "flip"].includes(pane.display);
    return [pane.entry.picture, compared ? pane.reference.picture : pane.entry.picture, pane.display === "flip" ? pane.entry.flip : pane.entry.picture].map(textureOf);
  };

  /**
   * Draws panes into the hidden canvas, width x height device pixels of it. A pane: { entry, reference, x, y, width, height (in the canvas),
   * left, top (of the picture, at the pane's corner), texels (pixels of the picture by one of the canvas), display, exposure }.
   * Answers whether all pictures were there.
   */
  const draw = (width, height, panes) => {
    if (canvas.width < width) canvas.width = width;
    if (canvas.height < height) canvas.height = height;
    gl.disable(gl.SCISSOR_TEST);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT);
    gl.enable(gl.SCISSOR_TEST);
    let all = true;
    for (const pane of panes) {
      const display = DISPLAYS.findIndex(([name]) => name === pane.display);
      if (pane.display === "flip" && pane.entry.flip === null) continue;
      const bound = texturesOf(pane);
      if (bound.includes(null)) {
        all = false;
        continue;
      }
      bound.forEach((texture, unit) => {
        gl.activeTexture(gl.TEXTURE0 + unit);
        gl.bindTexture(gl.TEXTURE_2D, texture);
      });
      const { width: columns, height: rows } = data.pictures[pane.entry.picture];
      gl.uniform2i(uniform("size"), columns, rows);
      gl.uniform2f(uniform("origin"), pane.left, pane.top);
      gl.uniform2f(uniform("paneCorner"), pane.x, pane.y);
      gl.uniform1f(uniform("texels"), pane.texels);
      gl.uniform1f(uniform("gain"), 2 ** pane.exposure);
      gl.uniform1f(uniform("limit"), 10 ** rangeNow());
      gl.uniform1f(uniform("targetHeight"), canvas.height);
      gl.uniform1i(uniform("display"), display);
      gl.uniform1i(uniform("curve"), TONES.findIndex(([name]) => name === state.tone));
      // GL counts rows from below.
      gl.viewport(0, 0, canvas.width, canvas.height);
      gl.scissor(Math.round(pane.x), canvas.height - Math.round(pane.y + pane.height), Math.round(pane.width), Math.round(pane.height));
      gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
    }
    return all;
  };

  /** Draws panes into a 2D canvas of this size. */
  const paint = (context, width, height, panes) => {
    const all = draw(width, height, panes);
    context.drawImage(canvas, 0, 0, width, height, 0, 0, width, height);
    return all;
  };

  /**
   * Draws regions of pictures, each over a whole 2D canvas: { canvas, entry, reference, display, exposure, region }. All are drawn
   * before any is copied, since the first copy waits for the drawing. Answers those that were complete.
   */
  const paintAll = (jobs) => {
    const done = [];
    let [x, y, height] = [0, 0, 0];
    const WIDTH = 2048;
    const HEIGHT = 2048;
    const panes = [];
    const copy = () => {
      if (!panes.length) return;
      draw(Math.max(...panes.map((pane) => pane.x + pane.width)), y + height, panes);
      for (const pane of panes) {
        const context = pane.job.canvas.getContext("2d");
        context.clearRect(0, 0, pane.width, pane.height);
        context.drawImage(canvas, pane.x, pane.y, pane.width, pane.height, 0, 0, pane.width, pane.height);
      }
      panes.length = 0;
      [x, y, height] = [0, 0, 0];
    };
    for (const job of jobs) {
      if (!complete(job)) continue;
      const [w, h] = [job.canvas.width, job.canvas.height];
      if (x > 0 && x + w > WIDTH) [x, y, height] = [0, y + height, 0];
      if (y > 0 && y + h > HEIGHT) copy();
      panes.push({ ...job, job, x, y, width: w, height: h, left: job.region.x, top: job.region.y, texels: job.region.width / w });
      [x, height] = [x + w, Math.max(height, h)];
      done.push(job);
    }
    copy();
    return done;
  };
  return { paint, paintAll };
})();
