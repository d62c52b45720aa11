'use strict';
// A path in space, its error magnified. Everything that is drawn stands in the page: #data (JSON) and #places (numbers).
(async () => {
  const $ = id => document.getElementById(id);
  const data = JSON.parse($('data').textContent);
  const root = document.documentElement;
  const calm = matchMedia('(prefers-reduced-motion: reduce)');
  const dark = matchMedia('(prefers-color-scheme: dark)');

  // ---------------------------------------------------------------- words
  let language = data.language;
  const word = key => data.words[language][key] ?? key;
  const say = (key, values) => word(key).replace(/\{(\w+)\}/g, (all, name) => (typeof values[name] === 'number' ? um(values[name]) : values[name] ?? all));
  const digits = (value, count) => {
    let text = Math.abs(value).toFixed(count);
    if (value < 0 && Number(text) !== 0) text = '\u2212' + text;
    return language === 'ru' ? text.replace('.', ',') : text;
  };
  const um = value => digits(value, Math.abs(value) >= 99.95 ? 0 : Math.abs(value) >= 9.995 ? 1 : 2);
  const times = value => String(value >= 10 ? Math.round(value) : Math.round(value * 10) / 10)
    .replace(/\B(?=(\d{3})+(?!\d))/g, '\u202f') + '\u00d7';

  // ---------------------------------------------------------------- shaders
  // First of all: the graphics process compiles them while the numbers are read here.
  const n = data.places, MANY = 8000;
  const canvas = $('canvas');
  const gl = canvas.getContext('webgl2', { antialias: n < MANY, alpha: true, premultipliedAlpha: true });
  root.dataset.webgl = gl ? 'yes' : 'no';
  const links = gl && (() => {
    const ROW = 2048; // places in a row of a texture; a power of two
    const GIVEN = `#version 300 es
      precision highp float;
      precision highp sampler2D;
      uniform sampler2D places, shifts; // X, Y, Z, and 1 where nothing leads here; X, Y, Z, and 1 where it is not known
      uniform mat3 turn; uniform vec3 target; uniform vec2 half_size; uniform float zoom, by, width, depth, front, upto; uniform bool ribbon;
      out float amount; out float late;`;
    // Two triangles for every two places that follow one another, made in the shader: drawing them as instances is slow
    // where there is no graphics card, and expanding them here takes memory.
    const WIDE = GIVEN + `
      void main() {
        int segment = gl_VertexID / 6, k = gl_VertexID % 6;
        vec2 corner = vec2(k == 1 || k == 3 || k == 4 ? 1.0 : 0.0, k == 2 || k == 4 || k == 5 ? 1.0 : -1.0);
        ivec2 one = ivec2(segment & ROW - 1, segment / ROW), two = ivec2(segment + 1 & ROW - 1, (segment + 1) / ROW);
        vec4 p0 = texelFetch(places, one, 0), p1 = texelFetch(places, two, 0), d0 = texelFetch(shifts, one, 0), d1 = texelFetch(shifts, two, 0);
        vec3 a = turn * (p0.xyz + d0.xyz * by - target), b = turn * (p1.xyz + d1.xyz * by - target);
        if (ribbon && corner.y < 0.0) { a = turn * (p0.xyz - target); b = turn * (p1.xyz - target); }
        vec2 from = a.xy * zoom, to = b.xy * zoom, way = to - from;
        float far = length(way);
        way = far > 1e-4 ? way / far : vec2(1.0, 0.0);
        vec2 aside = vec2(-way.y, way.x) * corner.y + way * (corner.x * 2.0 - 1.0) * 0.5;
        vec2 place = mix(from, to, corner.x) + (ribbon ? vec2(0.0) : aside * width * 0.5);
        gl_Position = vec4(place / half_size, -mix(a.z, b.z, corner.x) * depth - front, 1.0);
        amount = mix(length(d0.xyz), length(d1.xyz), corner.x);
        late = float(segment) + corner.x > upto ? 1.0 : 0.0;
        if (p1.w > 0.5 || d0.w > 0.5 || d1.w > 0.5) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
      }`.replaceAll('ROW', ROW);
    // One pixel wide: a twelfth of the work, for many places while they move.
    const THIN = GIVEN + `
      void main() {
        ivec2 one = ivec2(gl_VertexID & ROW - 1, gl_VertexID / ROW);
        vec4 d = texelFetch(shifts, one, 0);
        vec3 p = turn * (texelFetch(places, one, 0).xyz + d.xyz * by - target);
        gl_Position = vec4(p.xy * zoom / half_size, -p.z * depth - front, 1.0);
        amount = length(d.xyz);
        late = float(gl_VertexID) > upto ? 1.0 : 0.0;
      }`.replaceAll('ROW', ROW);
    const INK = `#version 300 es
      precision highp float;
      in float amount; in float late;
      uniform vec3 low, high; uniform float most, alpha;
      out vec4 ink;
      void main() {
        float a = alpha * (late > 0.5 ? 0.13 : 1.0);
        ink = vec4(mix(low, high, clamp(amount / most, 0.0, 1.0)) * a, a);
      }`;
    const linked = space => {
      const program = gl.createProgram();
      for (const [type, text] of [[gl.VERTEX_SHADER, space], [gl.FRAGMENT_SHADER, INK]]) {
        const shader = gl.createShader(type);
        gl.shaderSource(shader, text);
        gl.compileShader(shader);
        gl.attachShader(program, shader);
      }
      gl.linkProgram(program);
      return program;
    };
    const made = { ROW, wide: linked(WIDE), thin: n < MANY ? null : linked(THIN) };
    gl.flush();
    return made;
  })();

  // ---------------------------------------------------------------- numbers
  // Rows of differences, seven bits a byte, negative ones folded between: see encode.rs.
  const unpacked = text => {
    if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
    const packed = atob(text), bytes = new Uint8Array(packed.length);
    for (let k = 0; k < bytes.length; k++) bytes[k] = packed.charCodeAt(k);
    return bytes;
  };
  const bytes = unpacked($('places').textContent.trim());
  let byte = 0;
  const next = () => {
    let b = bytes[byte++];
    if (b < 128) return b;
    let value = b & 127, scale = 128;
    do { b = bytes[byte++]; value += (b & 127) * scale; scale *= 128; } while (b & 128);
    return value;
  };
  const unfold = v => (v % 2 ? -(v + 1) / 2 : v / 2);
  const line = new Float64Array(n), begins = new Float32Array(n), unknown = new Float32Array(n);
  for (let i = 0, at = 0; i < n; i++) {
    const v = next();
    begins[i] = v & 1;
    unknown[i] = v & 2 ? 1 : 0;
    line[i] = at += unfold(Math.floor(v / 4));
  }
  let row = 1;
  const numbers = (into, offset, stride, step) => {
    if (data.rows[row++] === '0') return;
    for (let i = offset, end = offset + n * stride, at = 0; i < end; i += stride) {
      // Most have one byte or two.
      const a = bytes[byte], b = bytes[byte + 1];
      if (a < 128) {
        at += (a >> 1) ^ -(a & 1);
        byte++;
      } else if (b < 128) {
        const v = (a & 127) | (b << 7);
        at += (v >> 1) ^ -(v & 1);
        byte += 2;
      } else at += unfold(next());
      into[i] = at * step;
    }
  };
  const vectors = (make, step) => {
    const all = new make(3 * n);
    for (let axis = 0; axis < 3; axis++) numbers(all, axis, 3, step);
    return all;
  };
  const at = vectors(Float64Array, data.place_um / 1000);
  if (gl) {
    // A draw of nothing: what is made ready for the first one, is so while the rest of the numbers is read.
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, 1, 1, 0, gl.RGBA, gl.FLOAT, new Float32Array(4));
    for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, filter, gl.NEAREST);
    gl.useProgram(links.thin || links.wide);
    gl.drawArrays(links.thin ? gl.LINES : gl.TRIANGLES, 0, links.thin ? 2 : 3);
    gl.flush();
  }
  const off = [0, 1].map(() => {
    const all = new Float32Array(n);
    numbers(all, 0, 1, data.displaced_um);
    return all;
  });
  const before = vectors(Float32Array, data.displaced_um), after = vectors(Float32Array, data.displaced_um);
  const real = Float32Array.from(before); // by the causes that are switched on

  const norm = (x, y, z) => Math.sqrt(x * x + y * y + z * z); // Math.hypot is many times slower
  const size = (v, i) => norm(v[3 * i], v[3 * i + 1], v[3 * i + 2]);
  const worst = v => {
    let [most, at] = [-1, 0];
    for (let i = 0; i < n; i++) { const s = size(v, i); if (s > most) [most, at] = [s, i]; }
    return at;
  };
  const largest = v => size(v, worst(v));
  let largestReal = largest(real);
  const scaleUm = largestReal || 1;

  // The box and its middle.
  const low = [0, 1, 2].map(a => { let m = Infinity; for (let i = 0; i < n; i++) m = Math.min(m, at[3 * i + a]); return m; });
  const high = [0, 1, 2].map(a => { let m = -Infinity; for (let i = 0; i < n; i++) m = Math.max(m, at[3 * i + a]); return m; });
  const middle = low.map((v, a) => (v + high[a]) / 2);
  const reach = Math.hypot(...low.map((v, a) => high[a] - v)) / 2 || 1;

  // ---------------------------------------------------------------- state
  const VIEWS = { corner: [45, 35.264], top: [0, 90], front: [0, 0], side: [90, 0] };
  const RAD = Math.PI / 180;
  const state = {
    yaw: 45 * RAD, rise: 35.264 * RAD, zoom: 1, target: [0, 0, 0], // px a mm; target from the middle of the box
    by: data.magnification, shown: { commanded: true, real: true, corrected: data.has_after }, here: worst(before),
    cut: false, playing: 0, swinging: 0, grown: 1,
  };
  const view = $('view'), overlay = $('overlay');
  let width = 1, height = 1;
  const turn = () => {
    const [s, c, t, d] = [Math.sin(state.yaw), Math.cos(state.yaw), Math.sin(state.rise), Math.cos(state.rise)];
    return [[c, s, 0], [-s * t, c * t, d], [s * d, -c * d, t]]; // right, up, towards the eye
  };
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const magnified = () => state.by * state.grown * 1e-3; // mm drawn for a µm
  /** Pixels from the upper left corner, and depth, of a place that is displaced. */
  const project = (axes, i, shift, by) => {
    const p = [0, 1, 2].map(a => at[3 * i + a] - middle[a] - state.target[a] + (shift ? shift[3 * i + a] * by : 0));
    return [width / 2 + dot(axes[0], p) * state.zoom, height / 2 - dot(axes[1], p) * state.zoom, dot(axes[2], p)];
  };
  const flat = (axes, p) => {
    const q = p.map((v, a) => v - middle[a] - state.target[a]);
    return [width / 2 + dot(axes[0], q) * state.zoom, height / 2 - dot(axes[1], q) * state.zoom];
  };
  const fit = () => {
    const axes = turn(), half = [0, 0];
    for (let k = 0; k < 8; k++) {
      const p = [0, 1, 2].map(a => (k >> a & 1 ? 1 : -1) * ((high[a] - low[a]) / 2 + largestReal * state.by * 1e-3 * 0.25));
      for (const a of [0, 1]) half[a] = Math.max(half[a], Math.abs(dot(axes[a], p)));
    }
    state.target = [0, 0, 0];
    state.zoom = Math.min((width / 2 - 40) / (half[0] || 1), (height / 2 - 34) / (half[1] || 1));
  };

  /** A drawing of fewer places, which the graphics process has no part in. */
  const sketched = most => {
    const step = Math.max(1, Math.ceil(n / most)), few = [];
    for (let i = 0, k = 0; i < n; i++, k++) {
      if (begins[i] || i === n - 1 || begins[i + 1]) k = 0;
      if (k % step === 0) few.push(i);
    }
    const paths = ['real', 'corrected', 'commanded'].map(name => {
      const path = document.createElementNS('http://www.w3.org/2000/svg', 'path');
      path.setAttribute('class', 'way ' + name);
      overlay.prepend(path);
      return [name, path];
    });
    return {
      changed() {},
      remove() { for (const [, path] of paths) path.remove(); },
      draw(axes) {
        for (const [name, path] of paths) {
          const shift = name === 'real' ? real : name === 'corrected' ? after : null;
          let d = '', open = false;
          if (state.shown[name]) for (const i of few) {
            if (state.cut && i > state.here) break;
            const lost = name === 'corrected' && unknown[i];
            const [x, y] = project(axes, i, shift, magnified());
            if (!lost) d += (begins[i] || !open ? 'M' : 'L') + x.toFixed(1) + ' ' + y.toFixed(1);
            open = !lost;
          }
          path.setAttribute('d', d);
        }
      },
    };
  };
  /** True where the drawing has another size than it had. */
  const resized = () => {
    const bounds = view.getBoundingClientRect();
    if (bounds.width === width && bounds.height === height) return false;
    [width, height] = [Math.max(1, bounds.width), Math.max(1, bounds.height)];
    overlay.setAttribute('viewBox', '0 0 ' + width + ' ' + height);
    return true;
  };

  // ---------------------------------------------------------------- the first frame
  // Of few places, before the rest of the numbers is read: the graphics process is still making its shaders ready, and a
  // canvas that it draws to would keep every frame waiting.
  root.classList.add('live');
  canvas.hidden = true;
  if (!calm.matches) state.grown = 0; // The error grows to its magnified size, once.
  resized();
  fit();
  let preview = sketched(1500);
  preview.draw(turn());
  const frame = () => new Promise(done => requestAnimationFrame(done));
  await frame();
  await frame(); // That one has been shown.
  root.dataset.drawn = Math.round(performance.now());

  // ---------------------------------------------------------------- the rest of the numbers
  const causes = data.causes.map((cause, index) => ({ ...cause, index, on: true, by: vectors(Float32Array, data.displaced_um) }));
  const blocks = new Map();
  data.lines.reduce((sum, step, k) => (blocks.set(sum + step, data.blocks[k]), sum + step), 0);
  const largestAfter = largest(after);
  for (const cause of causes) cause.largest = largest(cause.by);
  causes.sort((a, b) => b.largest - a.largest);
  // How far the path is along at each place (only where something leads there).
  const along = new Float64Array(n);
  for (let i = 1; i < n; i++) {
    const step = begins[i] ? 0 : norm(at[3 * i] - at[3 * i - 3], at[3 * i + 1] - at[3 * i - 2], at[3 * i + 2] - at[3 * i - 1]);
    along[i] = along[i - 1] + step;
  }

  // ---------------------------------------------------------------- drawing
  const colour = name => getComputedStyle(root).getPropertyValue('--' + name).trim();
  const rgb = name => {
    const h = colour(name).slice(1);
    return [0, 2, 4].map(k => parseInt(h.slice(k, k + 2), 16) / 255);
  };
  /** Draws lines of a width in pixels, and ribbons between a path and what is made of it. */
  const painter = gl && (() => {
    const ROW = links.ROW;
    const NAMES = ['places', 'shifts', 'turn', 'target', 'half_size', 'zoom', 'by', 'width', 'depth', 'front', 'upto', 'ribbon', 'low', 'high', 'most', 'alpha'];
    /** A program in use, and where its values go. */
    const pen = program => {
      if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
      const u = Object.fromEntries(NAMES.map(k => [k, gl.getUniformLocation(program, k)]));
      gl.useProgram(program);
      gl.uniform1i(u.shifts, 1);
      return { program, u };
    };
    const pens = { thin: links.thin && pen(links.thin), wide: pen(links.wide) };
    /** A texture of a vector and a mark for each place. */
    const texture = (vectors, marks, made = gl.createTexture()) => {
      const count = marks.length, rows = Math.ceil(count / ROW), all = new Float32Array(4 * ROW * rows);
      for (let i = 0; i < count; i++) {
        for (let axis = 0; axis < 3; axis++) all[4 * i + axis] = vectors[3 * i + axis];
        all[4 * i + 3] = marks[i];
      }
      gl.bindTexture(gl.TEXTURE_2D, made);
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, ROW, rows, 0, gl.RGBA, gl.FLOAT, all);
      for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, filter, gl.NEAREST);
      return made;
    };
    const here = new Float32Array(3 * n);
    for (let i = 0; i < 3 * n; i++) here[i] = at[i] - middle[i % 3];
    const none = new Float32Array(n);
    const places = texture(here, begins);
    const path = {
      real: { places, shifts: texture(real, none), count: n - 1 },
      corrected: { places, shifts: texture(after, unknown), count: n - 1 },
    };
    const edges = [];
    for (let k = 0; k < 8; k++) for (const a of [1, 2, 4]) if (!(k & a)) for (const c of [k, k | a]) edges.push(...[0, 1, 2].map(x => (c >> x & 1 ? high[x] : low[x]) - middle[x]));
    const corner = edges.length / 3;
    const box = {
      places: texture(edges, Float32Array.from({ length: corner }, (_, k) => (k + 1) % 2)),
      shifts: texture(new Float32Array(3 * corner), new Float32Array(corner)), count: corner - 1,
    };
    /** Pairs of places between which a thin line is drawn. */
    const pairs = (first, count, broken) => {
      const all = new Uint32Array(2 * count);
      let k = 0;
      for (let i = first; i < first + count; i++) if (!broken(i)) { all[k++] = i - 1; all[k++] = i; }
      const made = gl.createBuffer();
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, made);
      gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, all.subarray(0, k), gl.STATIC_DRAW);
      return { made, count: k };
    };
    if (pens.thin) {
      path.real.pairs = pairs(1, n - 1, i => begins[i]);
      box.pairs = pairs(1, corner - 1, k => k % 2 === 0);
      path.corrected.pairs = unknown.some(Boolean) ? pairs(1, n - 1, i => begins[i] || unknown[i - 1] || unknown[i]) : path.real.pairs;
    }

    const stroke = (chain, o) => {
      const { u } = o.pen;
      [chain.places, chain.shifts].forEach((bound, unit) => { gl.activeTexture(gl.TEXTURE0 + unit); gl.bindTexture(gl.TEXTURE_2D, bound); });
      gl.uniform1i(u.ribbon, o.ribbon ? 1 : 0);
      gl.uniform1f(u.by, o.by || 0);
      gl.uniform1f(u.width, (o.width || 1) * o.ratio);
      gl.uniform1f(u.front, o.front || 0);
      gl.uniform3fv(u.low, o.low);
      gl.uniform3fv(u.high, o.high || o.low);
      gl.uniform1f(u.most, scaleUm);
      gl.uniform1f(u.alpha, o.alpha || 1);
      gl.uniform1f(u.upto, o.upto);
      gl.depthMask(!o.ribbon);
      if (o.pen === pens.thin) {
        gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, chain.pairs.made);
        gl.drawElements(gl.LINES, chain.pairs.count, gl.UNSIGNED_INT, 0);
      } else gl.drawArrays(gl.TRIANGLES, 0, 6 * chain.count);
      gl.depthMask(true);
    };
    return {
      changed() {
        texture(real, none, path.real.shifts);
      },
      /** * `quick` – in lines of one pixel, where there are many */
      draw(axes, quick) {
        const ratio = Math.min(devicePixelRatio || 1, 2);
        const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)];
        if (canvas.width !== w || canvas.height !== h) [canvas.width, canvas.height] = [w, h];
        gl.viewport(0, 0, w, h);
        gl.clearColor(0, 0, 0, 0);
        gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
        const by = magnified(), upto = state.cut ? state.here : n;
        const pen = quick && pens.thin || pens.wide, { u } = pen;
        gl.useProgram(pen.program);
        gl.uniformMatrix3fv(u.turn, true, axes.flat());
        gl.uniform3fv(u.target, state.target);
        gl.uniform2f(u.half_size, w / 2, h / 2);
        gl.uniform1f(u.zoom, state.zoom * ratio);
        gl.uniform1f(u.depth, 1 / (4 * reach + 4 * largestReal * by));
        const common = { ratio, by, upto, pen };
        stroke(box, { ...common, upto: n, width: 1, low: rgb('line'), by: 0 });
        const few = n < MANY, bold = width < 560 ? 0.6 : 1;
        // The programmed path is a broad band on which the corrected one lies as a line, as far as it does.
        if (state.shown.commanded) stroke(path.real, { ...common, by: 0, width: (few ? (data.kind === 'map' ? 2.6 : 5) : 2.4) * bold, low: rgb('commanded'), front: 0.0004 });
        if (state.shown.corrected) stroke(path.corrected, { ...common, width: (few ? 1.8 : 1.2) * bold, low: rgb('after'), front: 0.0012 });
        if (state.shown.real) stroke(path.real, { ...common, width: (few ? 2.4 : 1.3) * bold, low: rgb('before-low'), high: rgb('before'), front: 0.0008 });
        if (state.shown.real && state.shown.commanded && few) stroke(path.real, { ...common, ribbon: true, low: rgb('before'), alpha: 0.15 });
      },
    };
  })();

  // Without WebGL it stays.
  const sketch = gl ? null : sketched(4000);

  const put = (id, attributes) => { for (const name in attributes) $(id).setAttribute(name, attributes[name]); };
  /** Names along the box, the place that is looked at, and what makes its displacement, as a chain. */
  const mark = axes => {
    const ends = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [1, 1, 1]].map(c => flat(axes, c.map((v, a) => (v ? high[a] : low[a]))));
    const centre = flat(axes, middle);
    ['x', 'y', 'z'].forEach((name, a) => {
      const [from, to] = [ends[a], ends[a + 1]], mid = [(from[0] + to[0]) / 2, (from[1] + to[1]) / 2];
      const seen = Math.hypot(to[0] - from[0], to[1] - from[1]) > 56;
      const away = Math.hypot(mid[0] - centre[0], mid[1] - centre[1]) || 1;
      const [dx, dy] = [(mid[0] - centre[0]) / away * 24, (mid[1] - centre[1]) / away * 18];
      for (const [id, p, text] of [[name + '0', from.map((v, k) => v + 0.06 * (to[k] - v)), digits(low[a], 0)], [name + '1', from.map((v, k) => v + 0.94 * (to[k] - v)), digits(high[a], 0)], [name, mid, name.toUpperCase() + ', ' + word('mm')]]) {
        put(id, { x: p[0] + dx, y: p[1] + dy + 4, visibility: seen ? 'visible' : 'hidden' });
        $(id).textContent = text;
      }
    });
    const i = state.here, by = magnified();
    const foot = project(axes, i), tip = project(axes, i, real, by);
    put('foot', { cx: foot[0], cy: foot[1], visibility: 'visible' });
    put('tip', { cx: tip[0], cy: tip[1], visibility: 'visible' });
    const left = project(axes, i, after, by);
    put('left', { cx: left[0], cy: left[1], visibility: state.shown.corrected && !unknown[i] ? 'visible' : 'hidden' });
    let from = [foot[0], foot[1]];
    for (const cause of causes) {
      const shift = [0, 1, 2].map(a => (cause.on ? cause.by[3 * i + a] * by : 0));
      const to = [from[0] + dot(axes[0], shift) * state.zoom, from[1] - dot(axes[1], shift) * state.zoom];
      cause.arm.setAttribute('d', 'M' + from.map(v => v.toFixed(1)).join(' ') + 'L' + to.map(v => v.toFixed(1)).join(' '));
      from = to;
    }
    put('whole', { d: 'M' + foot[0].toFixed(1) + ' ' + foot[1].toFixed(1) + 'L' + tip[0].toFixed(1) + ' ' + tip[1].toFixed(1) });
  };

  /** Says how many ms the frame took that is being drawn. `data-drawn`, when the first was shown, and `data-whole`, when the
   * first with all places was, in ms since the page was asked for, are for tests. */
  const finished = say => {
    const begun = performance.now(), note = () => say(performance.now() - begun);
    if (!gl) return note();
    // Behind this frame's commands.
    Promise.resolve().then(() => {
      const fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
      gl.flush();
      const wait = () => (gl.clientWaitSync(fence, 0, 0) === gl.TIMEOUT_EXPIRED ? setTimeout(wait, 4) : note());
      wait();
    });
  };
  // Of many places thin lines while something moves, and what they are at rest a moment later; unless that is quick, too.
  const REST_MS = 200, QUICK_MS = 40;
  let asked = false, still = false, slow = Boolean(gl) && n >= MANY, resting = 0;
  const ask = () => {
    if (asked) return;
    asked = true;
    requestAnimationFrame(now => {
      asked = false;
      move(now);
      const axes = turn(), quick = slow && !still;
      if (slow && still) finished(took => { slow = took > QUICK_MS; });
      (painter || sketch).draw(axes, quick);
      mark(axes);
      if (preview) {
        const first = preview;
        preview = null;
        canvas.hidden = false;
        finished(() => {
          first.remove();
          root.dataset.whole = Math.round(performance.now());
        });
      }
      clearTimeout(resting);
      if (quick) resting = setTimeout(() => { still = true; ask(); }, REST_MS);
    });
  };
  const draw = () => { still = false; ask(); };

  // ---------------------------------------------------------------- what moves
  const SECONDS = 24;
  let last = 0, swung = 0;
  const move = now => {
    const passed = Math.min((now - last) / 1000, 0.1);
    last = now;
    if (state.grown < 1) state.grown = Math.min(1, state.grown + passed / 0.9);
    if (state.swinging) {
      swung += passed;
      state.grown = 0.5 - 0.5 * Math.cos(swung * 2.2 + Math.PI);
    }
    if (state.playing) {
      const end = along[n - 1] || 1;
      state.playing = Math.min(end, state.playing + (passed / SECONDS) * end);
      let low = 0, high = n - 1;
      while (low < high) { const m = (low + high) >> 1; if (along[m] < state.playing) low = m + 1; else high = m; }
      look(low, true);
      if (state.playing >= end) play(false);
    }
    if (state.playing || state.swinging || state.grown < 1) draw();
  };
  const press = (id, on) => $(id).setAttribute('aria-pressed', on);
  const play = on => {
    state.playing = on ? (state.here >= n - 1 ? 1e-9 : along[state.here] || 1e-9) : 0;
    state.cut = on || state.cut;
    $('cut').checked = state.cut;
    press('play', on);
    draw();
  };
  const swing = on => {
    [state.swinging, state.grown, swung] = [on, 1, 0];
    press('swing', on);
    draw();
  };

  // ---------------------------------------------------------------- what is said
  const name = cause => say('cause_' + cause.kind, { symbol: cause[language] ?? cause.symbol });
  const triple = (v, i, show) => [0, 1, 2].map(a => show(v[3 * i + a]));
  let spoken = 0;
  const look = (i, quiet) => {
    state.here = Math.max(0, Math.min(n - 1, i));
    $('at').value = state.here;
    tell(quiet);
    draw();
  };
  /** The place that is looked at. */
  const tell = quiet => {
    const i = state.here, text = blocks.get(line[i]);
    const file = data.files[Math.floor(line[i] / 2 ** 32) - 1];
    const title = say('line_' + data.kind, { line: String(line[i] % 2 ** 32) }) + (file ? ' \u00b7 ' + file : '');
    $('line').textContent = title;
    $('block').textContent = text ?? '';
    $('block').hidden = text === undefined;
    $('place').textContent = ['X', 'Y', 'Z'].map((a, k) => a + '\u00a0' + digits(at[3 * i + k], 3)).join('  ') + '\u00a0' + word('mm');
    const fill = (id, v, gone) => [...triple(v, i, um), um(size(v, i))].forEach((text, k) => { $(id + k).textContent = gone ? '\u2014' : text; });
    fill('r', real, false);
    fill('a', after, unknown[i]);
    const has = off[0][i] || off[1][i];
    $('off').hidden = !has;
    $('off').textContent = say('off_' + data.kind, { before: um(off[0][i]), after: unknown[i] ? '\u2014' : um(off[1][i]) });
    $('at_now').textContent = text === undefined ? String(i + 1) + ' / ' + n : title;
    $('at').setAttribute('aria-valuetext', title + (text === undefined ? '' : ': ' + text));
    const whole = size(before, i);
    for (const cause of causes) {
      const amount = size(cause.by, i);
      let with_it = 0;
      for (let a = 0; a < 3; a++) with_it += cause.by[3 * i + a] * before[3 * i + a];
      const against = whole > 0 && with_it < -0.05 * whole * amount;
      cause.amount.textContent = (against ? '\u2212' : '') + um(amount);
      cause.bar.style.width = 100 * Math.min(1, amount / scaleUm) + '%';
      cause.bar.classList.toggle('against', against);
    }
    const most = causes.map(cause => [size(cause.by, i), cause]).filter(([amount]) => amount >= 0.005).sort((a, b) => b[0] - a[0]).slice(0, 3);
    $('makers').textContent = most.length ? say('makers', { list: most.map(([amount, cause]) => name(cause) + ' ' + um(amount) + '\u00a0' + word('um')).join(', ') }) : causes.length ? word('makers_none') : '';
    clearTimeout(spoken);
    if (!quiet) spoken = setTimeout(() => { $('spoken').textContent = [title, text, say('spoken', { real: um(size(real, i)), after: unknown[i] ? '\u2014' : um(size(after, i)) }), $('makers').textContent].filter(Boolean).join('. '); }, 250);
  };
  /** The whole. */
  const summarise = () => {
    const gone = causes.filter(cause => !cause.on).map(name);
    $('seen').textContent = say(gone.length ? 'seen_without' : 'seen', { times: times(state.by), largest: um(largestReal), causes: gone.join(', ') });
    // Of a whole path the comparison knows what lies between the places that are drawn, too.
    const known = (own, of) => data.kind === 'check' ? data.values[of] ?? own : own;
    $('real_most').textContent = say('most', { largest: um(gone.length ? largestReal : known(largestReal, 'before')) });
    $('after_most').textContent = say('most', { largest: um(known(largestAfter, 'after')) });
    $('after_most').dataset.drawn = largestAfter;
    $('mag_now').textContent = times(state.by);
    $('key_most').textContent = um(scaleUm) + ' ' + word('um');
  };
  const apply = () => {
    for (let k = 0; k < 3 * n; k++) real[k] = before[k];
    for (const cause of causes) if (!cause.on) for (let k = 0; k < 3 * n; k++) real[k] -= cause.by[k];
    largestReal = largest(real);
    (painter || sketch).changed();
    summarise();
    tell(true);
    draw();
  };

  // ---------------------------------------------------------------- the list of causes
  const list = $('causes');
  causes.forEach((cause, k) => {
    const item = document.createElement('li'), label = document.createElement('label');
    const make = (tag, kind) => { const made = document.createElement(tag); made.className = kind; return made; };
    const box = document.createElement('input');
    [box.type, box.checked, box.id] = ['checkbox', true, 'cause' + cause.index];
    box.dataset.symbol = cause.symbol;
    box.addEventListener('change', () => { cause.on = box.checked; apply(); });
    cause.title = make('span', 'name');
    cause.amount = make('span', 'n');
    cause.bar = make('span', 'bar c' + Math.min(k, 6));
    label.append(box, cause.title, cause.amount);
    item.append(label, cause.bar);
    list.append(item);
    cause.arm = document.createElementNS('http://www.w3.org/2000/svg', 'path');
    cause.arm.setAttribute('class', 'arm c' + Math.min(k, 6));
    $('arms').append(cause.arm);
    cause.box = box;
  });
  const all = on => { for (const cause of causes) cause.on = cause.box.checked = on; apply(); };
  $('all').addEventListener('click', () => all(true));
  $('none').addEventListener('click', () => all(false));
  if (data.kind === 'diagnosis') for (const id of ['play', 'cut']) $(id).closest('button, label').hidden = true;
  $('causes_part').hidden = causes.length === 0;

  const translate = () => {
    root.lang = language;
    for (const element of document.querySelectorAll('[data-t]')) element.textContent = say(element.dataset.t, data.values);
    for (const element of document.querySelectorAll('[data-label]')) element.setAttribute('aria-label', word(element.dataset.label));
    for (const cause of causes) cause.title.textContent = name(cause);
    for (const id of ['en', 'ru']) press(id, id === language);
    document.title = say('title_' + data.kind, data.values);
    summarise();
    tell(true);
  };

  // ---------------------------------------------------------------- hands
  const orbit = (dx, dy) => {
    state.yaw -= dx;
    state.rise = Math.max(-Math.PI / 2, Math.min(Math.PI / 2, state.rise + dy));
    draw();
  };
  const pan = (dx, dy) => {
    const [right, up] = turn();
    state.target = state.target.map((v, a) => v - (right[a] * dx - up[a] * dy) / state.zoom);
    draw();
  };
  const zoom = (by, x = width / 2, y = height / 2) => {
    const limit = [0.2, 5000].map(k => k * Math.min(width, height) / (2 * reach));
    const now = Math.max(limit[0], Math.min(limit[1], state.zoom * by)), share = 1 - state.zoom / now;
    pan(-(x - width / 2) * share, -(y - height / 2) * share); // what lies under the pointer stays there
    state.zoom = now;
    draw();
  };
  const stand = where => {
    [state.yaw, state.rise] = VIEWS[where].map(v => v * RAD);
    fit();
    draw();
  };
  /** The place nearest to a pointer; of a stretch the end to which it leads. */
  const pick = (x, y) => {
    const axes = turn(), by = magnified(), reached = 22;
    let best = reached, found = -1, lastReal, lastNominal;
    for (let i = 0; i < n; i++) {
      const nominal = project(axes, i), moved = project(axes, i, real, by);
      for (const [p, q, shown] of [[nominal, lastNominal, state.shown.commanded], [moved, lastReal, state.shown.real]]) {
        if (!shown) continue;
        let far = Math.hypot(p[0] - x, p[1] - y);
        if (q && !begins[i]) {
          const [vx, vy] = [p[0] - q[0], p[1] - q[1]], square = vx * vx + vy * vy || 1;
          const s = Math.max(0, Math.min(1, ((x - q[0]) * vx + (y - q[1]) * vy) / square));
          far = Math.hypot(q[0] + s * vx - x, q[1] + s * vy - y);
        }
        // Of those equally near the one in front.
        if (far < best - 0.5 || (far < best + 0.5 && found >= 0 && p[2] > project(axes, found)[2])) [best, found] = [Math.min(best, far), i];
      }
      [lastNominal, lastReal] = [nominal, moved];
    }
    if (found >= 0) { play(false); look(found); }
  };
  const pointers = new Map();
  let travelled = 0;
  view.addEventListener('pointerdown', event => {
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
    if (event.isTrusted) view.setPointerCapture(event.pointerId); // what a script makes up cannot be captured
    if (pointers.size === 1) travelled = 0;
  });
  view.addEventListener('pointermove', event => {
    const before = pointers.get(event.pointerId);
    if (!before) return;
    const here = [event.clientX, event.clientY], [dx, dy] = [here[0] - before[0], here[1] - before[1]];
    travelled += Math.abs(dx) + Math.abs(dy);
    if (pointers.size === 2) {
      const other = [...pointers].find(([id]) => id !== event.pointerId)[1], bounds = view.getBoundingClientRect();
      const far = p => Math.hypot(p[0] - other[0], p[1] - other[1]) || 1;
      zoom(far(here) / far(before), (here[0] + other[0]) / 2 - bounds.left, (here[1] + other[1]) / 2 - bounds.top);
      pan(dx / 2, dy / 2);
    } else if (event.shiftKey || event.ctrlKey || event.buttons & 6) pan(dx, dy);
    else orbit(dx * 0.008, dy * 0.008);
    pointers.set(event.pointerId, here);
  });
  const lift = event => {
    if (pointers.delete(event.pointerId) && travelled < 5 && pointers.size === 0 && event.type === 'pointerup') {
      const bounds = view.getBoundingClientRect();
      pick(event.clientX - bounds.left, event.clientY - bounds.top);
    }
  };
  view.addEventListener('pointerup', lift);
  view.addEventListener('pointercancel', lift);
  view.addEventListener('contextmenu', event => event.preventDefault());
  view.addEventListener('wheel', event => {
    event.preventDefault();
    const bounds = view.getBoundingClientRect();
    zoom(Math.exp(-event.deltaY * (event.deltaMode ? 0.05 : 0.0015)), event.clientX - bounds.left, event.clientY - bounds.top);
  }, { passive: false });
  /** The next place of another block. */
  const step = by => {
    let i = state.here + by;
    while (i > 0 && i < n - 1 && line[i] === line[state.here]) i += by;
    play(false);
    look(i);
  };
  const KEYS = {
    ArrowLeft: e => (e.shiftKey ? pan(-30, 0) : orbit(-0.12, 0)), ArrowRight: e => (e.shiftKey ? pan(30, 0) : orbit(0.12, 0)),
    ArrowUp: e => (e.shiftKey ? pan(0, -30) : orbit(0, -0.12)), ArrowDown: e => (e.shiftKey ? pan(0, 30) : orbit(0, 0.12)),
    '+': () => zoom(1.25), '=': () => zoom(1.25), '-': () => zoom(0.8), 0: () => stand('corner'), Home: () => stand('corner'),
    1: () => stand('corner'), 2: () => stand('top'), 3: () => stand('front'), 4: () => stand('side'),
    ',': () => step(-1), '.': () => step(1), w: () => look(worst(real)), ' ': () => play(!state.playing), m: () => swing(!state.swinging),
  };
  view.addEventListener('keydown', event => {
    const act = KEYS[event.key] || KEYS[event.key.toLowerCase()];
    if (!act || event.altKey || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    act(event);
  });
  const on = (id, act) => $(id).addEventListener('click', act);
  for (const where in VIEWS) on('view_' + where, () => stand(where));
  on('in', () => zoom(1.25));
  on('out', () => zoom(0.8));
  on('play', () => play(!state.playing));
  on('swing', () => swing(!state.swinging));
  on('previous', () => step(-1));
  on('next', () => step(1));
  on('worst', () => { play(false); look(worst(real)); });
  for (const id of ['en', 'ru']) on(id, () => { language = id; translate(); });
  for (const which of ['commanded', 'real', 'corrected']) $('show_' + which).addEventListener('change', event => { state.shown[which] = event.target.checked; draw(); });
  $('cut').addEventListener('change', event => { state.cut = event.target.checked; draw(); });
  $('at').max = n - 1;
  $('at').value = state.here;
  $('at').addEventListener('input', event => { play(false); look(Number(event.target.value)); });
  // Logarithmic, from its true size to twenty times what it begins with.
  const most = Math.log10(Math.max(10, data.magnification * 20));
  $('mag').value = 1000 * Math.log10(state.by) / most;
  $('mag').addEventListener('input', event => {
    state.by = 10 ** (event.target.value / 1000 * most);
    $('mag').setAttribute('aria-valuetext', times(state.by));
    summarise();
    draw();
  });
  dark.addEventListener('change', draw);
  calm.addEventListener('change', () => { if (calm.matches) { swing(false); play(false); } });

  // ---------------------------------------------------------------- begin
  translate();
  draw();
  new ResizeObserver(() => resized() && draw()).observe(view);
})();
