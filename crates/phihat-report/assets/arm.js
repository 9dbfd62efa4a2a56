// The arm of the run, to be turned and played. Drawn from its kinematics by WebGL 2.
"use strict";
// After the page is there: until then its picture stands in for it.
(globalThis.requestIdleCallback ?? setTimeout)(() => {
  const { data, t: times, signal, nearest, clock, show, element } = phihat;
  const stage = document.querySelector(".stage");
  if (!stage || !data.arm || !data.joints.length || !times.length) return;
  const canvas = document.getElementById("arm-view");
  const gl = canvas.getContext("webgl2", { antialias: true, stencil: true, alpha: true });
  if (!gl) return;

  // ── Mathematics: 4 × 4 matrices column by column.
  const V = {
    add: (a, b) => a.map((x, i) => x + b[i]),
    sub: (a, b) => a.map((x, i) => x - b[i]),
    times: (a, s) => a.map((x) => x * s),
    dot: (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2],
    cross: (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]],
    norm: (a) => Math.hypot(...a),
    unit: (a) => V.times(a, 1 / (V.norm(a) || 1)),
  };
  const frame = (x, y, z, p) => [...x, 0, ...y, 0, ...z, 0, ...p, 1];
  function mul(a, b) {
    const c = new Array(16).fill(0);
    for (let j = 0; j < 4; j += 1) for (let i = 0; i < 4; i += 1) for (let k = 0; k < 4; k += 1) c[4 * j + i] += a[4 * k + i] * b[4 * j + k];
    return c;
  }
  const point = (m, p) => [0, 1, 2].map((i) => m[i] * p[0] + m[4 + i] * p[1] + m[8 + i] * p[2] + m[12 + i]);
  const turned = (m, v) => [0, 1, 2].map((i) => m[i] * v[0] + m[4 + i] * v[1] + m[8 + i] * v[2]);
  const origin = (m) => [m[12], m[13], m[14]];
  const placement = (r, p) => frame([r[0][0], r[1][0], r[2][0]], [r[0][1], r[1][1], r[2][1]], [r[0][2], r[1][2], r[2][2]], p);
  function about([x, y, z], angle) {
    const [s, c] = [Math.sin(angle), Math.cos(angle)];
    const d = 1 - c;
    return frame([c + d * x * x, d * x * y + s * z, d * x * z - s * y], [d * x * y - s * z, c + d * y * y, d * y * z + s * x], [d * x * z + s * y, d * y * z - s * x, c + d * z * z], [0, 0, 0]);
  }
  // Where z points along a direction, at a point, with these lengths of the axes.
  function along(z, p, across, length) {
    const side = Math.abs(z[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0];
    const x = V.unit(V.cross(side, z));
    const y = V.cross(z, x);
    return frame(V.times(x, across), V.times(y, across), V.times(z, length), p);
  }

  // ── The arm.
  const { links, tip, gravity, payloads, torques, forces, walls } = data.arm;
  const fixed = links.map((link) => placement(link.r, link.p));
  function poses(q) {
    const out = [];
    links.forEach((link, i) => {
      let own = fixed[i];
      const at = link.joint == null ? 0 : q[link.joint];
      if (link.slides) own = mul(own, frame([1, 0, 0], [0, 1, 0], [0, 0, 1], V.times(link.axis, at)));
      else if (link.joint != null) own = mul(own, about(link.axis, at));
      out.push(link.parent == null ? own : mul(out[link.parent], own));
    });
    return out;
  }
  const n = data.joints.length;
  // A value at index k; where the record has a gap, the last before it.
  function value(joint, label, k) {
    const [low, high] = signal(joint, label);
    for (let i = k; i >= 0; i -= 1) if (!Number.isNaN(low[i])) return high ? 0.5 * (low[i] + high[i]) : low[i];
    return 0;
  }
  const desired = (k) => Array.from({ length: n }, (_, j) => value(j, "q_d", k));
  const actual = (k) => Array.from({ length: n }, (_, j) => value(j, "q", k));
  const magnified = (k, by) => Array.from({ length: n }, (_, j) => value(j, "q_d", k) + by * 1e-3 * value(j, "e", k));

  // Sizes: as thick as its mass at the density of a robot's link asks.
  const reach = Math.max(...links.reduce((far, link) => [...far, (link.parent == null ? 0 : far[link.parent]) + V.norm(link.p)], []), 1e-3);
  const lengths = links.map((_, i) => links.reduce((sum, link) => sum + (link.parent === i ? V.norm(link.p) : 0), 0));
  const thickness = links.map((link, i) => {
    const radius = Math.sqrt(Math.max(link.mass, 0.05) / (2000 * Math.PI * Math.max(lengths[i], 0.12 * reach)));
    return Math.min(Math.max(radius, 0.02 * reach), 0.045 * reach);
  });

  // The whole path of the tip, from at most so many postures.
  const PATH = 500;
  const stride = Math.max(1, Math.ceil(times.length / PATH));
  const path = [];
  let [least, largest] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  for (let k = 0; k < times.length; k += stride) {
    const places = poses(desired(k)).map(origin);
    path.push([times[k], places[tip]]);
    for (const p of places) [least, largest] = [least.map((x, i) => Math.min(x, p[i])), largest.map((x, i) => Math.max(x, p[i]))];
  }

  // The largest factor that keeps the magnified error a small motion.
  const FACTORS = [1, 3, 10, 30, 100, 300, 1000];
  const slides = data.joints.map((_, j) => links.some((link) => link.joint === j && link.slides));
  let most = 0;
  for (let j = 0; j < n; j += 1) for (const list of signal(j, "e")) for (const e of list) if (!Number.isNaN(e)) most = Math.max(most, Math.abs(e) / (slides[j] ? reach : 1));
  // Of a run that goes on no error is known yet: a few times its bound.
  const limits = data.charts.find((chart) => chart.stem === "error").panels;
  if (!most) most = 3 * Math.max(...limits.map((own, j) => (own.bound ?? 0) / (slides[j] ? reach : 1)));
  // How far errors within a bound per joint [mrad, mm] take a link's origin, to first order.
  function reached(at, i, bounds) {
    let far = 0;
    for (let k = i; k != null; k = links[k].parent) {
      const { joint, axis, slides: slid } = links[k];
      if (joint != null) far += 1e-3 * bounds[joint] * (slid ? 1 : V.norm(V.cross(V.unit(turned(at[k], axis)), V.sub(origin(at[i]), origin(at[k])))));
    }
    return far;
  }
  // Nor is the bound drawn wider than an eighth of the arm.
  const widest = (() => { const own = phihat.around?.(times.at(-1)); return own ? reached(poses(desired(0)), tip, own.bounds) : 0; })();
  const view = { factor: FACTORS.findLast((f) => f * most * 1e-3 <= 0.35 && f * widest <= 0.125 * reach) ?? 1, ghost: true, path: true, tube: true, speed: 1, playing: false, sharpness: 1 };

  // ── Meshes: positions and normals of triangles. A tube is bent by its two radii in the shader.
  function lathe(profile, around = 22) {
    const out = [];
    const vertex = ([r, z, nr, nz], a) => [r * Math.cos(a), r * Math.sin(a), z, nr * Math.cos(a), nr * Math.sin(a), nz];
    for (let i = 0; i + 1 < profile.length; i += 1) {
      for (let k = 0; k < around; k += 1) {
        const [a, b] = [2 * Math.PI * k / around, 2 * Math.PI * (k + 1) / around];
        const [p, q, r, s] = [vertex(profile[i], a), vertex(profile[i], b), vertex(profile[i + 1], a), vertex(profile[i + 1], b)];
        out.push(...p, ...q, ...s, ...p, ...s, ...r);
      }
    }
    return out;
  }
  const arc = (steps) => Array.from({ length: steps + 1 }, (_, i) => { const a = Math.PI * (i / steps - 0.5); return [Math.cos(a), Math.sin(a), Math.cos(a), Math.sin(a)]; });
  // A cylinder from −1 to 1 with a rounded rim.
  const rim = 0.14;
  const quarter = Array.from({ length: 5 }, (_, i) => { const a = Math.PI / 2 * i / 4; return [1 - rim + rim * Math.cos(a), 1 - rim + rim * Math.sin(a), Math.cos(a), Math.sin(a)]; });
  const drum = [[0, -1, 0, -1], ...quarter.map(([r, z, nr, nz]) => [r, -z, nr, -nz]).reverse(), ...quarter, [0, 1, 0, 1]];
  const MESHES = {
    tube: lathe([[1, 0, 1, 0], [1, 1, 1, 0]]),
    ball: lathe(arc(10)),
    drum: lathe(drum),
    cone: lathe([[0, 0, 0, -1], [1, 0, 0, -1], [1, 0, 0.9, 0.4], [0, 1, 0.9, 0.4]]),
    disc: lathe([[0, 0, 0, 1], [1, 0, 0, 1]], 64),
  };
  // Shapes of links: coded points and corners; where faces meet at a small angle, they share a normal.
  const shorts = (text) => { const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0)); return new Uint16Array(bytes.buffer); };
  const SHARP = Math.cos(0.7);
  const decoded = (shape) => {
    const codes = shorts(shape.points);
    return Array.from({ length: codes.length / 3 }, (_, k) => [0, 1, 2].map((i) => shape.low[i] + shape.step[i] * codes[3 * k + i]));
  };
  function surface(shape) {
    const [points, corners] = [decoded(shape), shorts(shape.triangles)];
    const faces = Array.from({ length: corners.length / 3 }, (_, k) => {
      const own = [corners[3 * k], corners[3 * k + 1], corners[3 * k + 2]];
      const [a, b, c] = own.map((i) => points[i]);
      const area = V.cross(V.sub(b, a), V.sub(c, a));
      return { own, area, unit: V.unit(area) };
    });
    const around = points.map(() => []);
    for (const face of faces) for (const i of face.own) around[i].push(face);
    return faces.flatMap(({ own, unit }) => own.flatMap((i) => {
      const near = around[i].filter((other) => V.dot(other.unit, unit) > SHARP);
      return [...points[i], ...V.unit(near.reduce((sum, other) => V.add(sum, other.area), unit.map((x) => 1e-12 * x)))];
    }));
  }
  const surfaces = new Map((data.arm.shapes ?? []).map((shape) => [shape.link, `link ${shape.link}`]));
  for (const shape of data.arm.shapes ?? []) MESHES[surfaces.get(shape.link)] = surface(shape);
  // Of a joint's link and what is welded to it.
  const mover = [];
  links.forEach((link, i) => { mover[i] = link.joint ?? (link.parent == null ? null : mover[link.parent]); });
  const compile = (kind, text) => { const s = gl.createShader(kind); gl.shaderSource(s, text); gl.compileShader(s); return s; };
  function program(vertex, fragment) {
    const made = gl.createProgram();
    gl.attachShader(made, compile(gl.VERTEX_SHADER, `#version 300 es\n${vertex}`));
    gl.attachShader(made, compile(gl.FRAGMENT_SHADER, `#version 300 es\nprecision highp float;\n${fragment}`));
    gl.linkProgram(made);
    if (!gl.getProgramParameter(made, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(made));
    return { made, at: (name) => gl.getUniformLocation(made, name) };
  }
  const solid = program(`
    in vec3 position, normal;
    uniform mat4 model, camera;
    uniform vec2 radii;
    out vec3 n, p;
    void main() {
      vec3 scaled = vec3(position.xy * mix(radii.x, radii.y, clamp(position.z, 0.0, 1.0)), position.z);
      vec4 world = model * vec4(scaled, 1.0);
      mat3 m = mat3(model);
      n = m * (normal / vec3(dot(m[0], m[0]), dot(m[1], m[1]), dot(m[2], m[2])));
      p = world.xyz;
      gl_Position = camera * world;
    }`, `
    in vec3 n, p;
    uniform vec4 colour;
    uniform vec3 eye;
    uniform float flatness, fade;
    out vec4 pixel;
    void main() {
      vec3 normal = normalize(n), sight = normalize(eye - p);
      vec3 key = normalize(vec3(0.35, -0.55, 0.9)), half_way = normalize(key + sight);
      float diffuse = 0.52 * max(dot(normal, key), 0.0) + 0.10 * max(dot(normal, vec3(-0.8, 0.5, 0.1)), 0.0);
      float sky = 0.46 + 0.14 * normal.z;
      float shine = 0.22 * pow(max(dot(normal, half_way), 0.0), 40.0);
      float edge = 0.16 * pow(1.0 - max(dot(normal, sight), 0.0), 3.0);
      vec3 lit = colour.rgb * (sky + diffuse) + shine + edge * colour.rgb;
      float far = fade > 0.0 ? clamp(1.0 - length(p.xy) / fade, 0.0, 1.0) : 1.0;
      pixel = vec4(mix(lit, colour.rgb, flatness), colour.a * far);
    }`);
  const thick = program(`
    in vec3 position, other;
    in vec2 way;
    in float time;
    uniform mat4 camera;
    uniform vec2 size;
    uniform float width;
    out float at;
    out vec3 p;
    void main() {
      vec4 a = camera * vec4(position, 1.0), b = camera * vec4(other, 1.0);
      vec2 d = normalize((b.xy / b.w - a.xy / a.w) * size * way.y + vec2(1e-6, 0.0));
      gl_Position = a + vec4(vec2(-d.y, d.x) / size * width * way.x * a.w, 0.0, 0.0);
      at = time;
      p = position;
    }`, `
    in float at;
    in vec3 p;
    uniform vec4 colour;
    uniform float now, fade;
    out vec4 pixel;
    void main() {
      float far = fade > 0.0 ? clamp(1.0 - length(p.xy) / fade, 0.0, 1.0) : 1.0;
      pixel = vec4(colour.rgb, colour.a * far * (at <= now ? 1.0 : 0.28));
    }`);
  // One vertex array per program: an attribute is where its program has it.
  function upload(used, fields, stride_, values) {
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(values), gl.STATIC_DRAW);
    let offset = 0;
    for (const [name, size] of fields) {
      const at = gl.getAttribLocation(used.made, name);
      if (at >= 0) { gl.enableVertexAttribArray(at); gl.vertexAttribPointer(at, size, gl.FLOAT, false, 4 * stride_, 4 * offset); }
      offset += size;
    }
    return { array, count: values.length / stride_ };
  }
  const meshes = Object.fromEntries(Object.entries(MESHES).map(([name, values]) => [name, upload(solid, [["position", 3], ["normal", 3]], 6, values)]));
  // Segments [a, b, time] as quads that face the eye.
  function segments(list) {
    const out = [];
    for (const [a, b, time] of list) {
      const corner = (p, q, side, way) => out.push(...p, ...q, side, way, time);
      corner(a, b, 1, 1); corner(a, b, -1, 1); corner(b, a, 1, -1);
      corner(a, b, -1, 1); corner(b, a, -1, -1); corner(b, a, 1, -1);
    }
    return upload(thick, [["position", 3], ["other", 3], ["way", 2], ["time", 1]], 9, out);
  }
  const trail = segments(path.slice(1).map(([time, p], k) => [path[k][1], p, time]));
  const floor = Math.min(0, ...path.map(([, p]) => p[2] - 0.03 * reach));
  const cell = [0.05, 0.1, 0.2, 0.5, 1].find((size) => size >= 0.11 * reach) ?? 1;
  const around = Math.ceil(1.3 * reach / cell);
  const rows = Array.from({ length: 2 * around + 1 }, (_, i) => (i - around) * cell);
  const edge = around * cell;
  const pieces = rows.slice(1).map((b, k) => [rows[k], b]);
  const grid = segments(rows.flatMap((x) => pieces.flatMap(([a, b]) => [[[x, a, floor], [x, b, floor], -1], [[a, x, floor], [b, x, floor], -1]])));

  // ── The camera.
  const middle = path.reduce((sum, [, p]) => V.add(sum, V.times(p, 1 / path.length)), [0, 0, 0]);
  // A ball around all that the arm ever fills, a little above the legend.
  const radius = 0.5 * V.norm(V.sub(largest, least)) + 0.06 * reach;
  const target = V.add(V.times(V.add(least, largest), 0.5), [0, 0, -0.1 * radius]);
  const FIELD = 0.52;
  const HOME = { azimuth: Math.atan2(middle[1], middle[0]) - 1.05, elevation: 0.32, distance: 0.98 * radius / Math.sin(FIELD / 2) };
  const eye = { ...HOME };
  function camera(aspect) {
    const { azimuth, elevation, distance } = eye;
    const back = [Math.cos(elevation) * Math.cos(azimuth), Math.cos(elevation) * Math.sin(azimuth), Math.sin(elevation)];
    const from = V.add(target, V.times(back, distance));
    const x = V.unit(V.cross([0, 0, 1], back));
    const y = V.cross(back, x);
    const look = [x[0], y[0], back[0], 0, x[1], y[1], back[1], 0, x[2], y[2], back[2], 0, -V.dot(x, from), -V.dot(y, from), -V.dot(back, from), 1];
    const f = 1 / Math.tan(FIELD / Math.min(1, aspect * 0.9 + 0.1) * 0.5);
    const [near, far] = [0.05 * distance, 8 * reach + distance];
    const lens = [f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, -(far + near) / (far - near), -1, 0, 0, -2 * far * near / (far - near), 0];
    return { from, matrix: mul(lens, look) };
  }

  // ── One picture.
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const colours = () => (dark.matches
    ? { body: [0.80, 0.83, 0.87], joint: [0.36, 0.42, 0.50], picked: [0.25, 0.62, 0.90], base: [0.42, 0.46, 0.52], ghost: [0.98, 0.66, 0.10], force: [0.95, 0.42, 0.30], load: [0.30, 0.78, 0.60], grid: [0.55, 0.60, 0.66], shadow: [0, 0, 0, 0.42], gravity: [0.66, 0.70, 0.76], path: [0.98, 0.66, 0.10], wall: [0.5, 0.55, 0.6], tubes: { inside: [0.25, 0.80, 0.62], thin: [0.95, 0.76, 0.25], over: [1.0, 0.45, 0.30], none: [0.62, 0.66, 0.72] } }
    : { body: [0.90, 0.915, 0.93], joint: [0.25, 0.30, 0.36], picked: [0.0, 0.44, 0.74], base: [0.52, 0.56, 0.61], ghost: [0.90, 0.42, 0.02], force: [0.78, 0.16, 0.10], load: [0.05, 0.52, 0.38], grid: [0.55, 0.59, 0.64], shadow: [0.1, 0.13, 0.18, 0.17], gravity: [0.40, 0.44, 0.50], path: [0.88, 0.40, 0.02], wall: [0.6, 0.65, 0.7], tubes: { inside: [0.05, 0.56, 0.42], thin: [0.80, 0.55, 0.0], over: [0.78, 0.20, 0.05], none: [0.45, 0.50, 0.56] } });
  let now = null;
  function draw(mesh, model, colour, options = {}) {
    const { radii = [1, 1], flatness = 0, fade = 0 } = options;
    gl.uniformMatrix4fv(solid.at("model"), false, now.shadow ? mul(now.shadow, model) : model);
    gl.uniform4fv(solid.at("colour"), now.shadow ? now.ink.shadow : colour.length === 4 ? colour : [...colour, now.alpha]);
    gl.uniform2fv(solid.at("radii"), radii);
    gl.uniform1f(solid.at("flatness"), now.shadow ? 1 : flatness);
    gl.uniform1f(solid.at("fade"), fade);
    gl.bindVertexArray(meshes[mesh].array);
    gl.drawArrays(gl.TRIANGLES, 0, meshes[mesh].count);
  }
  const ball = (p, r, colour, flatness = 0) => draw("ball", frame([r, 0, 0], [0, r, 0], [0, 0, r], p), colour, { flatness });
  function limb(a, b, ra, rb, colour, flatness = 0) {
    const d = V.sub(b, a);
    const length = V.norm(d);
    if (length > 1e-4 * reach) draw("tube", along(V.times(d, 1 / length), a, 1, length), colour, { radii: [ra, rb], flatness });
    ball(b, rb, colour, flatness);
    ball(a, ra, colour, flatness);
  }
  function robot(at, ink) {
    links.forEach((link, i) => {
      if (surfaces.size) {
        if (surfaces.has(i)) draw(surfaces.get(i), at[i], clock.joint != null && mover[i] === clock.joint ? ink.picked : mover[i] == null ? ink.base : ink.body);
        return;
      }
      const p = origin(at[i]);
      if (link.parent != null) {
        const [a, b] = [0.84 * thickness[link.parent], 0.84 * thickness[i]];
        if (V.norm(V.sub(p, origin(at[link.parent]))) > 1e-3 * reach) limb(origin(at[link.parent]), p, a, b, ink.body);
      }
      if (link.joint == null) return;
      const r = 0.98 * thickness[i];
      const picked = clock.joint === link.joint;
      const axis = V.unit(turned(at[i], link.axis));
      draw("drum", along(axis, p, r, link.slides ? 1.6 * r : 1.2 * r), picked ? ink.picked : ink.joint);
    });
    if (surfaces.size) return;
    const base = origin(at[0]);
    draw("drum", along([0, 0, 1], V.add(base, [0, 0, 0.02 * reach]), 1.75 * thickness[0], 0.02 * reach), ink.base);
    const hand = along(V.unit(turned(at[tip], [0, 0, 1])), origin(at[tip]), 0.5 * thickness[tip], 0.02 * reach);
    draw("drum", hand, ink.base);
  }
  // The bound as a body around the desired pose: errors within it, magnified as the error is, leave the arm inside.
  function tubeAround(at, own) {
    const wide = links.map((_, i) => 0.84 * thickness[i] + view.factor * reached(at, i, own.bounds));
    const skin = () => links.forEach((link, i) => {
      if (link.parent != null && V.norm(V.sub(origin(at[i]), origin(at[link.parent]))) > 1e-3 * reach) limb(origin(at[link.parent]), origin(at[i]), wide[link.parent], wide[i], now.ink.tubes[own.level], 1);
    });
    // First its depth, so that only its surface is seen.
    now.alpha = 0.22;
    gl.colorMask(false, false, false, false);
    skin();
    gl.colorMask(true, true, true, true);
    // Once per pixel, where two parts of it are at the same place.
    gl.clear(gl.STENCIL_BUFFER_BIT);
    gl.enable(gl.STENCIL_TEST);
    gl.depthFunc(gl.LEQUAL);
    skin();
    gl.depthFunc(gl.LESS);
    gl.disable(gl.STENCIL_TEST);
    now.alpha = 1;
  }
  function arrow(from, to, width, colour) {
    const d = V.sub(to, from);
    const length = V.norm(d);
    const z = V.times(d, 1 / (length || 1));
    const head = Math.min(6 * width, 0.5 * length);
    draw("tube", along(z, from, width, length - head), colour, { flatness: 0.3 });
    draw("cone", along(z, V.add(from, V.times(z, length - head)), 2.8 * width, head), colour, { flatness: 0.3 });
  }
  const acts = (what, t) => what.start <= t && (what.end == null || t < what.end);
  // An arrow bent around an axis: the external torque on a joint.
  function twist(m, axis, torque, colour) {
    const z = V.unit(turned(m, axis));
    const base = along(z, origin(m), 1, 1);
    const [x, y] = [V.unit([base[0], base[1], base[2]]), V.unit([base[4], base[5], base[6]])];
    const r = 0.13 * reach;
    const on = (a) => V.add(origin(m), V.add(V.times(x, r * Math.cos(a)), V.times(y, r * Math.sin(a))));
    const way = Math.sign(torque) || 1;
    for (let k = 0; k < 20; k += 1) limb(on(way * 0.22 * k), on(way * 0.22 * (k + 1)), 0.009 * reach, 0.009 * reach, colour);
    const [end, before] = [on(way * 4.4), on(way * 4.15)];
    arrow(end, V.add(end, V.times(V.unit(V.sub(end, before)), 0.07 * reach)), 0.011 * reach, colour);
    return on(way * 2.2);
  }
  function outside(at, t, ink) {
    const labels = [];
    for (const load of payloads.filter((one) => acts(one, t) && one.mass > 0)) {
      const centre = point(at[load.link], load.com);
      const r = Math.min(Math.max(Math.cbrt(load.mass / 8000), 0.035 * reach), 0.12 * reach);
      ball(centre, r, ink.load);
      labels.push([centre, `payload ${show(load.mass)} kg`]);
    }
    for (const push of torques.filter((one) => acts(one, t) && one.joint < n)) {
      const i = links.findIndex((link) => link.joint === push.joint);
      const unit = links[i].slides ? "N" : "N·m";
      const p = links[i].slides ? origin(at[i]) : twist(at[i], links[i].axis, push.torque, ink.force);
      if (links[i].slides) arrow(p, V.add(p, V.times(V.unit(turned(at[i], links[i].axis)), Math.sign(push.torque) * 0.25 * reach)), 0.012 * reach, ink.force);
      labels.push([p, `push ${show(push.torque)} ${unit}`]);
    }
    for (const push of forces.filter((one) => acts(one, t))) {
      const [p, size] = [origin(at[push.link]), V.norm(push.force)];
      const from = V.sub(p, V.times(V.unit(push.force), 0.3 * reach));
      arrow(from, p, 0.012 * reach, ink.force);
      labels.push([from, `push ${show(size)} N`]);
    }
    const down = V.norm(gravity);
    if (down > 0) {
      const from = V.add(target, [-1.15 * radius * Math.sin(HOME.azimuth), 1.15 * radius * Math.cos(HOME.azimuth), 0.3 * radius]);
      const to = V.add(from, V.times(V.unit(gravity), 0.22 * reach));
      arrow(from, to, 0.008 * reach, ink.gravity);
      labels.push([from, `gravity ${show(down)} m/s²`]);
    }
    return labels;
  }
  function lines(what, colour, width, fade, t) {
    gl.useProgram(thick.made);
    gl.uniformMatrix4fv(thick.at("camera"), false, now.matrix);
    gl.uniform2f(thick.at("size"), canvas.width, canvas.height);
    gl.uniform1f(thick.at("width"), width * canvas.width / canvas.clientWidth);
    gl.uniform4fv(thick.at("colour"), colour);
    gl.uniform1f(thick.at("fade"), fade);
    gl.uniform1f(thick.at("now"), t);
    gl.bindVertexArray(what.array);
    gl.drawArrays(gl.TRIANGLES, 0, what.count);
    gl.useProgram(solid.made);
  }
  const onto = (z) => [1, 0, 0, 0, 0, 1, 0, 0, -0.39, 0.61, 0, 0, 0.39 * z, -0.61 * z, z, 1];

  function render() {
    const k = nearest(clock.t);
    if (k < 0) return;
    const [w, h] = [canvas.clientWidth, canvas.clientHeight];
    const scale = Math.min(devicePixelRatio, 2) * view.sharpness;
    const [pw, ph] = [Math.round(w * scale), Math.round(h * scale)];
    if (!pw || !ph) return;
    if (canvas.width !== pw || canvas.height !== ph) { canvas.width = pw; canvas.height = ph; }
    gl.viewport(0, 0, pw, ph);
    const { from, matrix } = camera(w / h);
    now = { matrix, alpha: 1, ink: colours(), shadow: null };
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT | gl.STENCIL_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.BLEND);
    gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.useProgram(solid.made);
    gl.uniformMatrix4fv(solid.at("camera"), false, matrix);
    gl.uniform3fv(solid.at("eye"), from);
    const { ink } = now;
    const solidAt = poses(view.factor === 1 ? actual(k) : magnified(k, view.factor));
    // A page may have something else to show beside the arm than what is desired.
    const ghostAt = poses(phihat.ghost?.(view.factor) ?? desired(k));
    gl.depthMask(false);
    lines(grid, [...ink.grid, 0.45], 1, edge, 0);
    // The shadow: everything flat on the floor, once per pixel.
    now.shadow = onto(floor);
    gl.enable(gl.STENCIL_TEST);
    gl.stencilFunc(gl.EQUAL, 0, 255);
    gl.stencilOp(gl.KEEP, gl.KEEP, gl.INCR);
    gl.disable(gl.DEPTH_TEST);
    robot(solidAt, ink);
    gl.enable(gl.DEPTH_TEST);
    gl.disable(gl.STENCIL_TEST);
    now.shadow = null;
    gl.depthMask(true);
    robot(solidAt, ink);
    const labels = outside(solidAt, clock.t, ink);
    for (const wall of walls) draw("disc", along(wall.normal, wall.point, 0.25 * reach, 1), [...ink.wall, 0.35]);
    if (view.path) lines(trail, [...ink.path, 0.95], 2.4, 0, clock.t);
    if (view.ghost) {
      // First its depth, so that only its surface is seen.
      now.alpha = 0.45;
      const ghost = { ...ink, body: ink.ghost, joint: ink.ghost, picked: ink.ghost, base: ink.ghost };
      gl.colorMask(false, false, false, false);
      gl.enable(gl.POLYGON_OFFSET_FILL);
      gl.polygonOffset(2, 4);
      robot(ghostAt, ghost);
      gl.colorMask(true, true, true, true);
      gl.depthFunc(gl.LEQUAL);
      gl.polygonOffset(1, 2);
      robot(ghostAt, ghost);
      gl.disable(gl.POLYGON_OFFSET_FILL);
      gl.depthFunc(gl.LESS);
      now.alpha = 1;
    }
    const bound = view.tube ? phihat.around?.(clock.t) : null;
    if (bound) tubeAround(poses(desired(k)), bound);
    if (tubeWords) {
      tubeWords.hidden = !bound;
      if (bound) tubeWords.className = `is-tube is-${bound.level}`;
    }
    tell(labels, matrix, [w, h]);
    readOut(k);
  }

  // ── Words around it.
  const words = stage.querySelector(".stage-words");
  const tubeWords = document.getElementById("tube-words");
  function tell(labels, matrix, [w, h]) {
    while (words.children.length < labels.length) words.append(element("span"));
    const taken = [];
    [...words.children].forEach((span, i) => {
      span.hidden = i >= labels.length;
      if (span.hidden) return;
      const [p, text] = labels[i];
      const clip = [0, 1, 3].map((r) => matrix[r] * p[0] + matrix[4 + r] * p[1] + matrix[8 + r] * p[2] + matrix[12 + r]);
      span.textContent = text;
      // Nor beside the edge for something that is not seen, as the arrow of gravity on a phone.
      const share = (clip[0] / clip[2] + 1) / 2;
      if (clip[2] <= 0 || share < 0 || share > 1) { span.hidden = true; return; }
      const left = Math.min(Math.max(share * w, 4), w - span.offsetWidth - 4);
      let top = Math.min(Math.max((1 - clip[1] / clip[2]) / 2 * h - 26, 2), h - 24);
      // Words do not stand on words.
      for (const [x, y, wide] of taken) if (Math.abs(top - y) < 24 && left < x + wide + 4 && x < left + span.offsetWidth + 4) top = y + 24;
      taken.push([left, top, span.offsetWidth]);
      span.style.left = `${left}px`;
      span.style.top = `${top}px`;
    });
  }
  const slider = document.getElementById("time");
  const clockText = document.getElementById("clock");
  const tipText = document.getElementById("tip-error");
  // What all names begin with is not said in a narrow list.
  const [first, ...others] = data.joints;
  const shared = others.length ? first.split(/(?<=[_/])/).reduce(([at, same], part) => { const next = at + part.length; return same && next < first.length && others.every((name) => name.startsWith(first.slice(0, next))) ? [next, true] : [at, false]; }, [0, true])[0] : 0;
  const bars = data.joints.map((name, j) => {
    const row = element("li");
    const errors = limits[j];
    const [bar, mark, text] = [element("span", "bar"), element("i"), element("output")];
    bar.append(mark);
    const label = element("b", "", name.slice(shared));
    label.title = name;
    row.append(label, bar, text);
    document.getElementById("errors").append(row);
    return { errors, mark, text, bar, full: errors.bound ?? most * (slides[j] ? reach : 1) };
  });
  function readOut(k) {
    const far = V.norm(V.sub(origin(poses(actual(k))[tip]), origin(poses(desired(k))[tip])));
    slider.value = String(k);
    const text = `${times[k].toFixed(3)} s`;
    slider.setAttribute("aria-valuetext", text);
    clockText.textContent = text;
    tipText.textContent = `${show(1e3 * far)} mm`;
    bars.forEach(({ errors, mark, text: out, bar, full }, j) => {
      const e = value(j, "e", k);
      const share = Math.max(-1, Math.min(1, e / (full || 1)));
      mark.style.left = `${50 + 50 * Math.min(0, share)}%`;
      mark.style.width = `${50 * Math.abs(share)}%`;
      bar.classList.toggle("over", errors.bound != null && Math.abs(e) > errors.bound && times[k] >= data.settle_s);
      out.textContent = `${e < 0 ? "−" : "\u2007"}${Math.abs(e).toFixed(3)} ${errors.units[0]}`;
    });
  }

  // ── Hands: play, slider, keys, touch.
  let waiting = false;
  // A picture is drawn when the last one is there: else a page without a graphics processor waits for it, and answers nothing.
  let drawing = null;
  const mark = () => { gl.deleteSync(drawing); drawing = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0); gl.flush(); };
  const paint = () => {
    if (!gl.isContextLost() && gl.getSyncParameter(drawing, gl.SYNC_STATUS) !== gl.SIGNALED) return void requestAnimationFrame(paint);
    waiting = false;
    render();
    mark();
  };
  mark();
  const soon = () => { if (!waiting) { waiting = true; requestAnimationFrame(paint); } };
  const button = document.getElementById("play");
  let last = null;
  function step(time) {
    if (!view.playing) return;
    const dt = last == null ? 0 : Math.min(0.25, (time - last) / 1e3);
    // Without a graphics processor: fewer pixels before fewer pictures.
    if (dt > 0.05) view.sharpness = Math.max(0.5, 0.85 * view.sharpness);
    last = time;
    const end = times.at(-1);
    clock.set(clock.t + dt * view.speed, "arm");
    if (clock.t >= end) play(false); else requestAnimationFrame(step);
  }
  function play(on) {
    view.playing = on;
    last = null;
    button.textContent = on ? "❚❚ pause" : "▶ play";
    if (!on) return;
    if (clock.t >= times.at(-1)) clock.set(times[0], "arm");
    requestAnimationFrame(step);
  }
  const jump = (by) => { play(false); clock.set(times[Math.min(Math.max(nearest(clock.t) + by, 0), times.length - 1)], "arm"); };
  const turn = (dx, dy) => { eye.azimuth -= dx; eye.elevation = Math.min(1.5, Math.max(-0.35, eye.elevation + dy)); soon(); };
  const zoom = (by) => { eye.distance = Math.min(6 * reach, Math.max(0.5 * reach, eye.distance * by)); soon(); };
  const tenth = Math.max(1, Math.round(times.length / 100));
  const KEYS = {
    " ": () => play(!view.playing), Home: () => { play(false); clock.set(times[0], "arm"); }, End: () => { play(false); clock.set(times.at(-1), "arm"); },
    ArrowLeft: (e) => jump(e.altKey ? -1 : -tenth), ArrowRight: (e) => jump(e.altKey ? 1 : tenth),
    ArrowUp: () => turn(0, 0.1), ArrowDown: () => turn(0, -0.1), "+": () => zoom(0.85), "-": () => zoom(1.18), 0: () => { Object.assign(eye, HOME); soon(); },
  };
  const TURNS = { ArrowLeft: [-0.12, 0], ArrowRight: [0.12, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] };
  canvas.addEventListener("keydown", (e) => {
    const known = e.shiftKey && TURNS[e.key] ? () => turn(...TURNS[e.key]) : KEYS[e.key];
    if (!known || e.ctrlKey || e.metaKey) return;
    e.preventDefault();
    known(e);
  });
  const fingers = new Map();
  canvas.addEventListener("pointerdown", (e) => { canvas.setPointerCapture(e.pointerId); fingers.set(e.pointerId, [e.clientX, e.clientY]); });
  canvas.addEventListener("pointermove", (e) => {
    if (!fingers.has(e.pointerId)) return;
    const before = fingers.get(e.pointerId);
    const others = [...fingers].filter(([id]) => id !== e.pointerId).map(([, p]) => p);
    if (others.length) {
      const far = (p) => Math.hypot(p[0] - others[0][0], p[1] - others[0][1]) || 1;
      zoom(far(before) / far([e.clientX, e.clientY]));
    } else turn((e.clientX - before[0]) * 0.008, (e.clientY - before[1]) * 0.008);
    fingers.set(e.pointerId, [e.clientX, e.clientY]);
  });
  for (const type of ["pointerup", "pointercancel"]) canvas.addEventListener(type, (e) => fingers.delete(e.pointerId));
  canvas.addEventListener("wheel", (e) => { if (e.ctrlKey || document.activeElement === canvas) { e.preventDefault(); zoom(Math.exp(0.0012 * e.deltaY)); } }, { passive: false });
  canvas.addEventListener("dblclick", () => { Object.assign(eye, HOME); soon(); });
  button.addEventListener("click", () => play(!view.playing));
  slider.max = String(times.length - 1);
  slider.addEventListener("input", () => { play(false); clock.set(times[Number(slider.value)], "arm"); });
  const speed = document.getElementById("speed");
  speed.addEventListener("change", () => { view.speed = Number(speed.value); });
  const magnify = document.getElementById("magnify");
  for (const f of FACTORS) magnify.append(new Option(f === 1 ? "as it is" : `× ${f}`, f));
  magnify.value = String(view.factor);
  const legend = document.getElementById("drawn");
  const describe = () => { legend.textContent = view.factor === 1 ? "the arm, q" : `the arm, its error × ${view.factor}: q_d + ${view.factor} e`; };
  magnify.addEventListener("change", () => { view.factor = Number(magnify.value); describe(); soon(); });
  for (const name of ["ghost", "path", "tube"]) document.getElementById(name)?.addEventListener("change", (e) => { view[name] = e.target.checked; soon(); });
  clock.listen((t, from) => { if (from !== "arm") play(false); soon(); });
  dark.addEventListener("change", soon);
  new ResizeObserver(soon).observe(canvas);
  describe();
  stage.hidden = false;
  document.documentElement.classList.add("alive");
  // What a test asks: where the tip is at a time, and whether something was drawn.
  canvas.tipAt = (t) => origin(poses(desired(nearest(t)))[tip]);
  canvas.pixels = () => { render(); const all = new Uint8Array(4 * canvas.width * canvas.height); gl.readPixels(0, 0, canvas.width, canvas.height, gl.RGBA, gl.UNSIGNED_BYTE, all); return all; };
  // Of a link's shape, the points in its own axes.
  canvas.shapeOf = (link) => decoded(data.arm.shapes.find((shape) => shape.link === link));
  canvas.paint = render;
  // What a film draws of the picture of now [px]: links of the arm, of the desired pose and of the bound, each with its ends and width.
  canvas.outline = () => {
    const k = nearest(clock.t);
    const [w, h] = [canvas.clientWidth, canvas.clientHeight];
    const { from, matrix } = camera(w / h);
    const seen = (p) => { const [x, y, d] = [0, 1, 3].map((r) => matrix[r] * p[0] + matrix[4 + r] * p[1] + matrix[8 + r] * p[2] + matrix[12 + r]); return [(x / d + 1) / 2 * w, (1 - y / d) / 2 * h]; };
    const broad = (p, r) => { const side = V.unit(V.cross(V.sub(p, from), [0, 0, 1])); const [a, b] = [seen(p), seen(V.add(p, V.times(side, r)))]; return 2 * Math.hypot(b[0] - a[0], b[1] - a[1]); };
    const bound = phihat.around?.(clock.t);
    const limbs = (at, bounds) => links.flatMap((link, i) => {
      if (link.parent == null || V.norm(V.sub(origin(at[i]), origin(at[link.parent]))) < 1e-3 * reach) return [];
      const r = 0.84 * thickness[i] + (bounds ? view.factor * reached(at, i, bounds) : 0);
      return [{ ends: [...seen(origin(at[link.parent])), ...seen(origin(at[i]))], width: broad(origin(at[i]), r) }];
    });
    const goal = poses(desired(k));
    return { size: [w, h], factor: view.factor, arm: limbs(poses(view.factor === 1 ? actual(k) : magnified(k, view.factor))), desired: limbs(goal), bound: bound && limbs(goal, bound.bounds), level: bound?.level };
  };
  // Where each joint is on the screen, and where the tip goes there as the joint turns forward: what a hand takes hold of.
  canvas.grips = () => {
    const k = nearest(clock.t);
    const [w, h] = [canvas.clientWidth, canvas.clientHeight];
    const { matrix } = camera(w / h);
    const at = poses(view.factor === 1 ? actual(k) : magnified(k, view.factor));
    const seen = (p) => { const [x, y, d] = [0, 1, 3].map((r) => matrix[r] * p[0] + matrix[4 + r] * p[1] + matrix[8 + r] * p[2] + matrix[12 + r]); return [(x / d + 1) / 2 * w, (1 - y / d) / 2 * h]; };
    return links.flatMap((link, i) => {
      if (link.joint == null) return [];
      const [p, z, end] = [origin(at[i]), V.unit(turned(at[i], link.axis)), origin(at[tip])];
      const moves = link.slides ? z : V.cross(z, V.sub(end, p));
      const [a, b] = [seen(end), seen(V.add(end, V.times(V.norm(moves) > 1e-9 ? V.unit(moves) : z, 0.05 * reach)))];
      const far = Math.hypot(b[0] - a[0], b[1] - a[1]);
      const [x, y] = seen(p);
      return [{ joint: link.joint, x, y, way: far > 1e-3 ? [(b[0] - a[0]) / far, (b[1] - a[1]) / far] : [1, 0] }];
    });
  };
  soon();
});
