// Turnable view of the coloured surface: WebGL 2, no libraries. Hook for scripts: window.spaceplaneView.
(async function () {
  "use strict";
  const root = document.getElementById("viewer");
  const source = document.getElementById("surface-data");
  if (!root || !source) return;
  const canvas = root.querySelector("canvas");
  const gl = canvas.getContext("webgl2", { antialias: true, alpha: true, preserveDrawingBuffer: true });
  if (!gl || !("DecompressionStream" in window)) {
    root.classList.add("still");
    return;
  }
  const data = JSON.parse(source.textContent);

  async function unpack(text, Type) {
    const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
    return new Type(await new Response(stream).arrayBuffer());
  }

  const VERTEX = `#version 300 es
    layout(location=0) in vec4 position; layout(location=1) in vec4 normal; layout(location=2) in float field;
    uniform vec3 lower, extent, center; uniform mat3 turn; uniform vec4 lens; uniform vec2 shift;
    uniform float least, most;
    out vec3 n; out float cp; flat out int part;
    void main() {
      vec3 eye = turn * (lower + extent * position.xyz - center);
      n = turn * normal.xyz; part = int(normal.w + 0.5); cp = mix(least, most, field);
      float depth = lens.z - eye.z;
      gl_Position = vec4((eye.xy + shift) * lens.xy, (depth - lens.z) / lens.w * depth, depth);
    }`;
  const FRAGMENT = `#version 300 es
    precision highp float;
    in vec3 n; in float cp; flat in int part;
    uniform sampler2D ramp; uniform vec3 colours[16]; uniform float low, high, interval, least, most; uniform int mode, lines;
    out vec4 colour;
    void main() {
      vec3 unit = normalize(n);
      if (mode == 2) { // what lies under the pointer: the field's value in 16 bits and the part
        float steps = floor(clamp((cp - least) / max(most - least, 1e-12), 0.0, 1.0) * 65535.0 + 0.5);
        colour = vec4(floor(steps / 256.0) / 255.0, mod(steps, 256.0) / 255.0, float(part) / 255.0, 1.0);
        return;
      }
      vec3 base;
      if (mode == 1) base = colours[part];
      else base = texture(ramp, vec2(clamp((cp - low) / (high - low), 0.0, 1.0) * 0.996 + 0.002, 0.5)).rgb;
      if (mode == 0 && lines == 1) {
        float s = cp / interval, w = fwidth(s);
        float d = abs(fract(s - 0.5) - 0.5);
        float line = (1.0 - smoothstep(0.6 * w, 1.5 * w, d)) * (1.0 - smoothstep(0.25, 0.6, w));
        base *= 1.0 - 0.5 * line;
      }
      float key = max(dot(unit, normalize(vec3(-0.35, 0.55, 0.8))), 0.0);
      float fill = 0.5 + 0.5 * unit.y;
      float shine = pow(max(dot(unit, normalize(vec3(-0.18, 0.29, 0.94))), 0.0), 40.0);
      colour = vec4(base * (0.56 + 0.18 * fill + 0.36 * key) + 0.09 * shine, 1.0);
    }`;

  function compile(type, text) {
    const shader = gl.createShader(type);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    return shader;
  }
  const program = gl.createProgram();
  gl.attachShader(program, compile(gl.VERTEX_SHADER, VERTEX));
  gl.attachShader(program, compile(gl.FRAGMENT_SHADER, FRAGMENT));
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
  gl.useProgram(program);
  const at = (name) => gl.getUniformLocation(program, name);

  function vertexBuffer(array) {
    const buffer = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, array, gl.STATIC_DRAW);
    return buffer;
  }
  const [positions, normals, triangles] = await Promise.all([
    unpack(data.vertices, Uint16Array), unpack(data.normals, Int8Array), unpack(data.triangles, Uint32Array)]);
  const fields = await Promise.all(data.fields.map((f) => unpack(f.data, Uint16Array)));
  vertexBuffer(positions);
  gl.enableVertexAttribArray(0);
  gl.vertexAttribPointer(0, 4, gl.UNSIGNED_SHORT, true, 8, 0);
  vertexBuffer(normals);
  gl.enableVertexAttribArray(1);
  gl.vertexAttribPointer(1, 4, gl.BYTE, false, 4, 0);
  const fieldBuffers = fields.map(vertexBuffer);
  if (!fieldBuffers.length) fieldBuffers.push(vertexBuffer(new Uint16Array(positions.length / 4)));
  gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, triangles, gl.STATIC_DRAW);

  const stops = data.stops.map((c) => [1, 3, 5].map((k) => parseInt(c.slice(k, k + 2), 16)));
  const ramp = new Uint8Array(256 * 4);
  for (let k = 0; k < 256; k++) {
    const s = (k / 255) * (stops.length - 1), i = Math.min(Math.floor(s), stops.length - 2), f = s - i;
    for (let c = 0; c < 3; c++) ramp[4 * k + c] = stops[i][c] * (1 - f) + stops[i + 1][c] * f;
    ramp[4 * k + 3] = 255;
  }
  gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, 256, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, ramp);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
  const colours = new Float32Array(48).fill(0.7);
  data.parts.slice(0, 16).forEach((p, k) => [1, 3, 5].forEach((o, c) => {
    colours[3 * k + c] = parseInt(p.colour.slice(o, o + 2), 16) / 255;
  }));
  gl.uniform3fv(at("colours"), colours);
  const extent = data.upper.map((u, k) => u - data.lower[k]);
  const center = data.upper.map((u, k) => (u + data.lower[k]) / 2);
  const radius = Math.hypot(...extent) / 2;
  gl.uniform3fv(at("lower"), data.lower);
  gl.uniform3fv(at("extent"), extent);
  gl.uniform3fv(at("center"), center);
  gl.enable(gl.DEPTH_TEST);
  gl.enable(gl.CULL_FACE);

  const VIEWS = { perspective: [-142, 24], front: [180, 0], side: [-90, 0], top: [-90, 90], bottom: [-90, -90], rear: [0, 8] };
  const state = { azimuth: VIEWS.perspective[0], elevation: VIEWS.perspective[1], zoom: 1, shift: [0, 0], field: 0, mode: 0, lines: 1 };
  const rad = Math.PI / 180;

  function axes() { // rows: right, up, toward the viewer
    const a = state.azimuth * rad, e = state.elevation * rad;
    const toward = [Math.cos(e) * Math.cos(a), Math.cos(e) * Math.sin(a), Math.sin(e)];
    const right = [-Math.sin(a), Math.cos(a), 0];
    const up = [-Math.sin(e) * Math.cos(a), -Math.sin(e) * Math.sin(a), Math.cos(e)];
    return [right, up, toward];
  }
  const samples = []; // some vertices, relative to the centre: what has to fit on the canvas
  for (let k = 0, step = 4 * Math.max(1, Math.floor(positions.length / 4 / 3000)); k < positions.length; k += step) {
    samples.push([0, 1, 2].map((c) => data.lower[c] + (extent[c] * positions[k + c]) / 65535 - center[c]));
  }
  function fit(width, height, rows) { // pixels per metre and the middle of what is seen: every view fills the canvas
    const spans = [0, 1].map((r) => {
      const along = samples.map((s) => s[0] * rows[r][0] + s[1] * rows[r][1] + s[2] * rows[r][2]);
      return [Math.min(...along), Math.max(...along)];
    });
    const sizes = spans.map(([low, high]) => high - low);
    return { scale: Math.min((width * 0.94) / sizes[0], height / sizes[1]) * 0.94, middle: spans.map(([low, high]) => (low + high) / 2) };
  }
  let waiting = false;
  function draw() {
    waiting = false;
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    const width = canvas.clientWidth, height = canvas.clientHeight;
    if (!width || !height) return;
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
    }
    const rows = axes(), fitted = fit(width, height - 130, rows), distance = 7 * radius;
    const scale = fitted.scale * state.zoom;
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.uniformMatrix3fv(at("turn"), false, [0, 1, 2].flatMap((c) => rows.map((r) => r[c])));
    gl.uniform4f(at("lens"), (2 * scale / width) * distance, (2 * scale / height) * distance, distance, 1.6 * radius);
    gl.uniform2f(at("shift"), state.shift[0] / scale - fitted.middle[0], (12 - state.shift[1]) / scale - fitted.middle[1]);
    const field = data.fields[state.field];
    gl.bindBuffer(gl.ARRAY_BUFFER, fieldBuffers[state.field] || fieldBuffers[0]);
    gl.enableVertexAttribArray(2);
    gl.vertexAttribPointer(2, 1, gl.UNSIGNED_SHORT, true, 2, 0);
    gl.uniform1f(at("least"), field ? field.least : 0);
    gl.uniform1f(at("most"), field ? field.most : 1);
    gl.uniform1f(at("low"), field ? field.low : 0);
    gl.uniform1f(at("high"), field ? field.high : 1);
    gl.uniform1f(at("interval"), field ? step((field.high - field.low) / 12) : 1);
    gl.uniform1i(at("mode"), field ? state.mode : 1);
    gl.uniform1i(at("lines"), state.lines);
    gl.drawElements(gl.TRIANGLES, triangles.length, gl.UNSIGNED_INT, 0);
    compass(rows);
  }
  const probe = { frame: gl.createFramebuffer(), colour: gl.createRenderbuffer(), depth: gl.createRenderbuffer(), size: "" };
  function under(clientX, clientY) { // {cp, part} on the surface at a place of the window, or null
    const box = canvas.getBoundingClientRect();
    const x = Math.floor(((clientX - box.left) / box.width) * canvas.width);
    const y = canvas.height - 1 - Math.floor(((clientY - box.top) / box.height) * canvas.height);
    gl.bindFramebuffer(gl.FRAMEBUFFER, probe.frame);
    if (probe.size !== `${canvas.width} ${canvas.height}`) {
      const attach = [[probe.colour, gl.RGBA8, gl.COLOR_ATTACHMENT0], [probe.depth, gl.DEPTH_COMPONENT16, gl.DEPTH_ATTACHMENT]];
      for (const [buffer, format, place] of attach) {
        gl.bindRenderbuffer(gl.RENDERBUFFER, buffer);
        gl.renderbufferStorage(gl.RENDERBUFFER, format, canvas.width, canvas.height);
        gl.framebufferRenderbuffer(gl.FRAMEBUFFER, place, gl.RENDERBUFFER, buffer);
      }
      probe.size = `${canvas.width} ${canvas.height}`;
    }
    gl.enable(gl.SCISSOR_TEST);
    gl.scissor(x, y, 1, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.uniform1i(at("mode"), 2);
    gl.drawElements(gl.TRIANGLES, triangles.length, gl.UNSIGNED_INT, 0);
    const pixel = new Uint8Array(4);
    gl.readPixels(x, y, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
    gl.disable(gl.SCISSOR_TEST);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    if (!pixel[3]) return null;
    const field = data.fields[state.field], part = data.parts[pixel[2]];
    const cp = field ? field.least + ((field.most - field.least) * (256 * pixel[0] + pixel[1])) / 65535 : null;
    return { cp, part: part ? part.name.replaceAll("_", " ") : "" };
  }
  const tip = document.getElementById("tip");
  let asked = null;
  function hover(event) {
    if (asked) { asked = event; return; }
    asked = event;
    requestAnimationFrame(() => {
      const found = held.size ? null : under(asked.clientX, asked.clientY);
      tip.hidden = !found;
      if (found) {
        tip.textContent = (found.cp === null ? "" : `Cp ${found.cp.toFixed(3).replace("-", "−")} · `) + found.part;
        tip.style.left = `${asked.clientX + scrollX + 16}px`;
        tip.style.top = `${asked.clientY + scrollY + 14}px`;
      }
      asked = null;
    });
  }
  function redraw() {
    if (!waiting) { waiting = true; requestAnimationFrame(draw); }
  }
  function step(x) {
    const power = 10 ** Math.floor(Math.log10(x)), lead = x / power;
    return power * (lead > 5 ? 10 : lead > 2 ? 5 : lead > 1 ? 2 : 1);
  }
  function compass(rows) {
    root.querySelectorAll(".compass line").forEach((line, k) => {
      const x = 40 + 26 * rows[0][k], y = 40 - 26 * rows[1][k];
      line.setAttribute("x2", x);
      line.setAttribute("y2", y);
      const text = root.querySelectorAll(".compass text")[k];
      text.setAttribute("x", 40 + 34 * rows[0][k]);
      text.setAttribute("y", 44 - 34 * rows[1][k]);
    });
  }
  function legend() {
    const field = data.fields[state.field];
    root.classList.toggle("by-part", state.mode === 1 || !field);
    if (!field) return;
    const bar = root.querySelector(".ramp-ticks"), span = field.high - field.low, d = step(span / 6);
    bar.replaceChildren();
    for (let v = Math.ceil(field.low / d) * d; v <= field.high + 1e-9; v += d) {
      const tick = document.createElement("span");
      tick.style.left = `${(100 * (v - field.low)) / span}%`;
      tick.textContent = (Math.abs(v) < 1e-9 ? 0 : v).toFixed(d < 0.1 ? 2 : d < 1 ? 1 : 0).replace("-", "−");
      bar.append(tick);
    }
    root.querySelector(".cp-range").textContent =
      `lowest ${field.least.toFixed(3)}, highest ${field.most.toFixed(3)}`.replaceAll("-", "−");
  }

  const held = new Map();
  canvas.addEventListener("pointerdown", (event) => {
    try { canvas.setPointerCapture(event.pointerId); } catch { /* synthetic events own no pointer */ }
    held.set(event.pointerId, [event.clientX, event.clientY]);
    canvas.classList.add("held");
  });
  canvas.addEventListener("pointermove", (event) => {
    const last = held.get(event.pointerId);
    if (!last) {
      hover(event);
      return;
    }
    const dx = event.clientX - last[0], dy = event.clientY - last[1];
    held.set(event.pointerId, [event.clientX, event.clientY]);
    if (event.shiftKey || event.buttons === 2 || held.size > 1) {
      state.shift[0] += dx;
      state.shift[1] += dy;
    } else turn(-dx * 0.4, dy * 0.4);
    redraw();
  });
  for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, (event) => {
    held.delete(event.pointerId);
    canvas.classList.remove("held");
  });
  canvas.addEventListener("pointerleave", () => { tip.hidden = true; });
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("wheel", (event) => {
    if (!event.ctrlKey && document.activeElement !== canvas) return; // the page keeps scrolling until the view is clicked
    event.preventDefault();
    zoom(Math.exp(-event.deltaY * 0.0012));
  }, { passive: false });
  canvas.addEventListener("dblclick", () => view("perspective"));
  canvas.addEventListener("keydown", (event) => {
    const turns = { ArrowLeft: [6, 0], ArrowRight: [-6, 0], ArrowUp: [0, 6], ArrowDown: [0, -6] }[event.key];
    if (turns) turn(...turns);
    else if (event.key === "+" || event.key === "=") zoom(1.15);
    else if (event.key === "-") zoom(1 / 1.15);
    else return;
    event.preventDefault();
  });
  function turn(azimuth, elevation) {
    state.azimuth += azimuth;
    state.elevation = Math.max(-90, Math.min(90, state.elevation + elevation));
    redraw();
  }
  function zoom(factor) {
    state.zoom = Math.max(0.4, Math.min(30, state.zoom * factor));
    redraw();
  }
  function view(name) {
    [state.azimuth, state.elevation] = VIEWS[name];
    state.zoom = 1;
    state.shift = [0, 0];
    redraw();
  }
  function show(name) { // a flight point by name
    const k = data.fields.findIndex((f) => f.name === name);
    if (k >= 0) state.field = k;
    legend();
    redraw();
  }
  function colourBy(what) {
    state.mode = what === "parts" ? 1 : 0;
    root.querySelectorAll("[data-colour]").forEach((b) => b.setAttribute("aria-pressed", b.dataset.colour === what));
    legend();
    redraw();
  }
  root.querySelectorAll("[data-view]").forEach((b) => b.addEventListener("click", () => view(b.dataset.view)));
  root.querySelectorAll("[data-colour]").forEach((b) => b.addEventListener("click", () => colourBy(b.dataset.colour)));
  root.querySelector("[data-lines]").addEventListener("click", (event) => {
    state.lines = 1 - state.lines;
    event.currentTarget.setAttribute("aria-pressed", state.lines === 1);
    redraw();
  });
  document.addEventListener("flightpoint", (event) => show(event.detail.name));
  new ResizeObserver(redraw).observe(canvas);
  window.addEventListener("beforeprint", draw);
  window.spaceplaneView = { state, turn, zoom, view, show, colourBy, draw, under };
  root.classList.add("live");
  const active = document.querySelector("[data-point][aria-pressed=true]");
  show(active ? active.dataset.name : "");
  draw();
  root.dataset.ready = "true";
})().catch((error) => {
  console.error(error);
  document.getElementById("viewer").classList.add("still");
});
