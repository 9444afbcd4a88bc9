// The particles in space: spheres drawn by the graphics card, to be turned, cut and played through time.
"use strict";
(() => {
  const canvas = document.getElementById("view");
  if (!canvas) return;
  const $ = id => document.getElementById(id);
  const { css, dark, number } = report;
  const wait = $("wait");
  const say = text => { wait.textContent = text; wait.hidden = !text; };

  // ------------------------------------------------------------------ frames
  const film = report.data.film || { frames: [] };
  const frames = [];
  const inflate = async bytes => {
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
    return new Uint8Array(await new Response(stream).arrayBuffer());
  };
  const bytesOf = text => {
    const raw = atob(text), bytes = new Uint8Array(raw.length);
    for (let i = 0; i < raw.length; i++) bytes[i] = raw.charCodeAt(i);
    return bytes;
  };
  // Triangles, and the normal of each at all of its corners.
  const wallsOf = text => {
    const corners = new Float32Array(bytesOf(text).buffer), out = new Float32Array(2 * corners.length);
    for (let t = 0; t < corners.length; t += 9) {
      const [u, v] = [3, 6].map(k => [0, 1, 2].map(d => corners[t + k + d] - corners[t + d]));
      const n = [0, 1, 2].map(d => u[(d + 1) % 3] * v[(d + 2) % 3] - u[(d + 2) % 3] * v[(d + 1) % 3]), size = Math.hypot(...n) || 1;
      for (let c = 0; c < 3; c++) for (let d = 0; d < 3; d++) {
        out[2 * t + 6 * c + d] = corners[t + 3 * c + d];
        out[2 * t + 6 * c + 3 + d] = n[d] / size;
      }
    }
    return out;
  };
  // Low bytes of all numbers, then high bytes; of a frame that follows another, what is to be added to that one.
  const unpack = (meta, bytes, before) => {
    const n = meta.n, last = meta.follows ? before : null;
    let at = 0;
    const words = was => {
      const out = new Uint16Array(n);
      for (let i = 0; i < n; i++) out[i] = (bytes[at + i] | (bytes[at + n + i] << 8)) + (was ? was[i] : 0);
      at += 2 * n;
      return out;
    };
    const single = was => {
      const out = new Uint8Array(n);
      for (let i = 0; i < n; i++) out[i] = bytes[at + i] + (was ? was[i] : 0);
      at += n;
      return out;
    };
    const x = [0, 1, 2].map(d => words(last && last.x[d]));
    const columns = meta.columns.map((c, k) => {
      const was = last && last.columns[k];
      return c.bits === 0 ? null : c.bits === 8 ? single(was) : words(was);
    });
    if (at !== bytes.length) throw new Error(`frame of ${bytes.length} bytes in place of ${at}`);
    return { meta, x, columns, walls: meta.walls === null ? before ? before.walls : null : wallsOf(meta.walls) };
  };

  // ------------------------------------------------------------------ graphics
  const gl = canvas.getContext("webgl2", { antialias: true, preserveDrawingBuffer: false });
  if (!gl) {
    say("This browser draws no WebGL 2, so that particles cannot be shown; everything else is there.");
    return;
  }
  const compile = (vertex, fragment) => {
    const program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, "#version 300 es\nprecision highp float;\n" + text);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
    const names = {};
    for (let i = 0; i < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); i++) {
      const { name } = gl.getActiveUniform(program, i);
      names[name] = gl.getUniformLocation(program, name);
    }
    return { program, at: names, attribute: name => gl.getAttribLocation(program, name) };
  };
  // A square that faces the eye for each particle; the sphere on it is found pixel by pixel, with its depth.
  const spheres = compile(`
    in float px, py, pz, size, value;
    uniform vec3 origin, cell, eye;
    uniform mat3 turn;
    uniform mat4 proj;
    uniform vec2 sizes, values, range;
    uniform float grow, only, kinds;
    uniform vec4 cut;
    uniform vec3 plain;
    uniform sampler2D map;
    out vec2 uv; out vec3 centre; flat out float r; flat out vec3 tint;
    void main() {
      vec3 p = origin + cell * vec3(px, py, pz);
      float v = values.x + values.y * value;
      uv = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
      r = grow * (sizes.x + sizes.y * size);
      centre = turn * p - eye;
      float t = (v - range.x) / max(range.y - range.x, 1e-30);
      tint = texture(map, vec2(kinds > 0.5 ? (mod(v - 1.0, 10.0) + 0.5) / 10.0 : clamp(t, 0.002, 0.998), 0.5)).rgb;
      if (plain.x >= 0.0) tint = plain;
      bool gone = dot(cut.xyz, p) > cut.w || (only > 0.5 && (v < range.x || v > range.y));
      // Wider by what perspective shows of a sphere's side.
      gl_Position = gone ? vec4(2.0, 2.0, 2.0, 1.0) : proj * vec4(centre + vec3(uv * r * 1.08, 0.0), 1.0);
      uv *= 1.08;
    }`, `
    in vec2 uv; in vec3 centre; flat in float r; flat in vec3 tint;
    uniform mat4 proj;
    out vec4 colour;
    void main() {
      float d = dot(uv, uv);
      if (d > 1.0) discard;
      vec3 normal = vec3(uv, sqrt(1.0 - d));
      vec4 clip = proj * vec4(centre + r * normal, 1.0);
      gl_FragDepth = 0.5 * clip.z / clip.w + 0.5;
      float light = 0.42 + 0.58 * max(0.0, dot(normal, normalize(vec3(0.35, 0.5, 0.8))));
      float shine = pow(max(0.0, dot(normal, normalize(vec3(0.2, 0.3, 1.0)))), 40.0) * 0.12;
      colour = vec4(tint * light + shine, 1.0);
    }`);
  const lines = compile(`
    in vec3 corner; uniform vec3 eye; uniform mat3 turn; uniform mat4 proj;
    void main() { gl_Position = proj * vec4(turn * corner - eye, 1.0); }`,
    "uniform vec3 ink; out vec4 colour; void main() { colour = vec4(ink, 1.0); }");

  // Walls as glass: more of it where one looks along it.
  const glass = compile(`
    in vec3 corner, normal; uniform vec3 eye, middle; uniform float scale; uniform mat3 turn; uniform mat4 proj;
    out vec3 across, there;
    void main() {
      there = turn * ((corner - middle) * scale) - eye;
      across = turn * normal;
      gl_Position = proj * vec4(there, 1.0);
    }`, `
    in vec3 across, there; uniform vec3 ink; out vec4 colour;
    void main() {
      float facing = abs(dot(normalize(across), normalize(there)));
      colour = vec4(ink, 0.13 + 0.22 * (1.0 - facing));
    }`);
  const panes = gl.createVertexArray(), paneData = gl.createBuffer();
  gl.bindVertexArray(panes);
  gl.bindBuffer(gl.ARRAY_BUFFER, paneData);
  ["corner", "normal"].forEach((name, k) => {
    gl.enableVertexAttribArray(glass.attribute(name));
    gl.vertexAttribPointer(glass.attribute(name), 3, gl.FLOAT, false, 24, 12 * k);
  });

  const cloud = gl.createVertexArray();
  const buffers = Object.fromEntries(["px", "py", "pz", "size", "value"].map(n => [n, gl.createBuffer()]));
  const fed = {};
  const feed = (name, list) => {
    delete fed[name];
    const at = spheres.attribute(name);
    if (at < 0) return;
    gl.bindBuffer(gl.ARRAY_BUFFER, buffers[name]);
    if (!list) {
      gl.disableVertexAttribArray(at);
      gl.vertexAttrib1f(at, 0);
      return;
    }
    gl.bufferData(gl.ARRAY_BUFFER, list, gl.DYNAMIC_DRAW);
    gl.enableVertexAttribArray(at);
    gl.vertexAttribDivisor(at, 1);
    fed[name] = { at, kind: list instanceof Uint8Array ? gl.UNSIGNED_BYTE : gl.UNSIGNED_SHORT, bytes: list.BYTES_PER_ELEMENT };
  };
  // One particle in so many is drawn.
  const sparse = every => Object.entries(fed).forEach(([name, { at, kind, bytes }]) => {
    gl.bindBuffer(gl.ARRAY_BUFFER, buffers[name]);
    gl.vertexAttribPointer(at, 1, kind, name.length > 2, every > 1 ? every * bytes : 0, 0);
  });
  const edges = gl.createVertexArray(), corners = gl.createBuffer();
  gl.bindVertexArray(edges);
  gl.bindBuffer(gl.ARRAY_BUFFER, corners);
  gl.enableVertexAttribArray(lines.attribute("corner"));
  gl.vertexAttribPointer(lines.attribute("corner"), 3, gl.FLOAT, false, 0, 0);

  // ------------------------------------------------------------------ colours
  const MAPS = {
    viridis: ["440154", "482878", "3e4989", "31688e", "26828e", "1f9e89", "35b779", "6ece58", "b5de2b", "fde725"],
    damage: ["cfd6dd", "e9c46a", "e76f51", "b5174b", "4a0d3a"],
    "cool and warm": ["3b4cc0", "7b9ff9", "c0d4f5", "f2cbb7", "ee8468", "b40426"],
    grey: ["26292d", "f0f2f4"],
  };
  const KINDS = ["4e8fd0", "e08a3c", "58a866", "c9504f", "9a77c7", "8f6a55", "d684b8", "8c9299", "b9b13a", "3fb3bf"];
  const rgb = hex => [0, 2, 4].map(k => parseInt(hex.slice(k, k + 2), 16));
  const texture = gl.createTexture();
  const paint = (list, smooth) => {
    const texels = new Uint8Array(256 * 4), colours = list.map(rgb);
    for (let k = 0; k < 256; k++) {
      const at = smooth ? k / 255 * (colours.length - 1) : Math.floor(k / 256 * colours.length);
      const low = Math.floor(at), high = Math.min(low + 1, colours.length - 1);
      for (let d = 0; d < 3; d++) texels[4 * k + d] = colours[low][d] + (at - low) * (colours[high][d] - colours[low][d]);
      texels[4 * k + 3] = 255;
    }
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, 256, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, texels);
    for (const [what, how] of [[gl.TEXTURE_MIN_FILTER, gl.NEAREST], [gl.TEXTURE_MAG_FILTER, gl.NEAREST], [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE]]) {
      gl.texParameteri(gl.TEXTURE_2D, what, how);
    }
  };

  // ------------------------------------------------------------------ what is looked at
  const view = { yaw: -0.5, pitch: 1.2, distance: 4, pan: [0, 0], middle: [0, 0, 0], scale: 1, reach: 2 };
  let pane = null;
  let shown = -1, playing = 0, asked = false, rough = false, touched = false;
  const spread = f => [0, 1, 2].map(d => f.meta.most[d] - f.meta.least[d]);
  const fit = () => {
    const known = frames.filter(f => f && f.meta.n > 0);
    if (!known.length) return;
    const first = known[0], last = known[known.length - 1];
    const base = first.meta.n * 2 < last.meta.n ? last : first;
    const size = spread(base), wide = Math.max(...size, 1e-300);
    const lo = [], hi = [];
    for (let d = 0; d < 3; d++) {
      // What flies far away is not what the picture is about.
      lo[d] = Math.max(Math.min(base.meta.least[d], last.meta.least[d]), base.meta.least[d] - 0.4 * wide);
      hi[d] = Math.min(Math.max(base.meta.most[d], last.meta.most[d]), base.meta.most[d] + 0.4 * wide);
    }
    const radius = (sizeOf(base).most || 0);
    view.middle = [0, 1, 2].map(d => 0.5 * (lo[d] + hi[d]));
    view.scale = 1 / (0.5 * Math.hypot(...[0, 1, 2].map(d => hi[d] - lo[d])) + radius || 1);
    view.half = [0, 1, 2].map(d => (0.5 * (hi[d] - lo[d]) + radius) * view.scale);
  };
  const reach = () => {
    view.reach = Math.max(1, ...frames.filter(Boolean).map(f => view.scale * Math.hypot(...[0, 1, 2].map(d =>
      Math.max(Math.abs(f.meta.least[d] - view.middle[d]), Math.abs(f.meta.most[d] - view.middle[d]))))));
  };
  const turned = () => {
    const [c, s, a, b] = [Math.cos(view.yaw), Math.sin(view.yaw), Math.cos(view.pitch), Math.sin(view.pitch)];
    // Rows: to the right, up, towards the eye.
    return [[c, -s, 0], [s * a, c * a, b], [-s * b, -c * b, a]];
  };
  const FEW = 40000;
  const TAN = Math.tan(Math.PI / 12);
  const home = () => {
    const thin = view.half && view.half[2] < 0.2 * Math.min(view.half[0], view.half[1]);
    [view.yaw, view.pitch] = thin ? [0, 0] : [-0.5, 1.2];
    view.pan = [0, 0];
    frame();
  };
  // So far away that all of it is in the picture.
  const frame = () => {
    const rows = turned(), half = view.half || [1, 1, 1], aspect = canvas.clientWidth / Math.max(1, canvas.clientHeight);
    const size = rows.map(row => row.reduce((sum, v, d) => sum + Math.abs(v) * half[d], 0));
    view.distance = 1.06 * Math.max(size[0] / aspect, size[1]) / TAN + size[2];
    request();
  };

  // ------------------------------------------------------------------ controls
  const colour = $("colour"), map = $("map"), from = $("from"), to = $("to"), only = $("only"), cut = $("cut"), where = $("where"), flip = $("flip");
  const grow = $("grow"), box = $("box"), walls = $("walls"), slider = $("frame"), now = $("now"), play = $("play"), legend = $("legend");
  map.replaceChildren(...Object.keys(MAPS).map(name => new Option(name)));
  const column = f => f.meta.columns.findIndex(c => c.name === colour.value);
  const sizeOf = f => {
    const at = f.meta.columns.findIndex(c => c.name === "radius");
    if (at >= 0) return { ...f.meta.columns[at], list: f.columns[at] };
    const n = Math.max(1, f.meta.n), volume = spread(f).reduce((v, s) => v * Math.max(s, 1e-3 * Math.max(...spread(f), 1e-300)), 1);
    // Of a solid so wide that no light falls through.
    const solid = f.meta.columns.some(c => /dmg|damage/.test(c.name)) ? Math.SQRT2 : 1;
    const guess = 0.5 * solid * Math.cbrt(volume / n);
    return { lo: guess, hi: guess, least: guess, most: guess, list: null };
  };
  // The range over all frames, so that a colour keeps its meaning.
  const extent = name => {
    const all = frames.filter(Boolean).flatMap(f => f.meta.columns.filter(c => c.name === name && c.least !== null && f.meta.n > 0));
    return all.length ? [Math.min(...all.map(c => c.least)), Math.max(...all.map(c => c.most))] : [0, 1];
  };
  const isKind = () => colour.value === "type";
  const range = () => {
    const known = extent(colour.value);
    return [from, to].map((input, k) => (input.value === "" || Number.isNaN(input.valueAsNumber) ? known[k] : input.valueAsNumber));
  };
  // A column with its unit, where that is known.
  const units = () => (frames.find(Boolean) || { meta: { units: ["", "", ""] } }).meta.units;
  const titled = name => {
    const unit = { radius: 0, speed: 2, vx: 2, vy: 2, vz: 2 }[name];
    return unit === undefined || !units()[unit] ? name : `${name} [${units()[unit]}]`;
  };
  const names = () => {
    const was = colour.value, known = [];
    frames.filter(Boolean).forEach(f => f.meta.columns.forEach(c => known.includes(c.name) || known.push(c.name)));
    if (known.join() === [...colour.options].map(o => o.value).join()) return;
    colour.replaceChildren(...known.map(name => new Option(name)));
    colour.value = touched && known.includes(was) ? was : known[0] || "";
    choose();
    coloured();
  };
  // Damage for solids, speed for grains, until another colour is chosen: which of them changes, later snapshots show.
  const choose = () => {
    if (touched) return;
    const known = [...colour.options].map(o => o.value), changes = name => known.includes(name) && extent(name)[1] > 0;
    const first = ["damage", "speed"].find(changes) || (known.includes("damage") ? "damage" : "type");
    if (known.includes(first)) colour.value = first;
    map.value = colour.value === "damage" ? "damage" : "viridis";
  };
  const coloured = () => {
    const kinds = isKind(), list = kinds ? KINDS : MAPS[map.value];
    paint(list, !kinds);
    map.disabled = kinds;
    const [lo, hi] = range(), parts = [];
    const add = (tag, text, style) => {
      const e = document.createElement(tag);
      e.textContent = text;
      if (style) e.style.background = style;
      parts.push(e);
    };
    add("b", titled(colour.value));
    if (kinds) {
      for (let k = Math.max(1, lo); k <= Math.min(hi, lo + 11); k++) {
        add("i", "", "#" + KINDS[(k - 1) % 10]);
        add("span", String(k));
      }
    } else {
      add("span", number(lo));
      add("i", "", `linear-gradient(to right,${list.map(c => "#" + c).join(",")})`);
      parts[parts.length - 1].className = "wide";
      add("span", number(hi));
    }
    legend.replaceChildren(...parts);
    if (shown >= 0) load(frames[shown]);
    request();
  };

  const load = f => {
    gl.bindVertexArray(cloud);
    ["px", "py", "pz"].forEach((name, d) => feed(name, f.x[d]));
    feed("size", sizeOf(f).list);
    const at = column(f);
    feed("value", at < 0 ? null : f.columns[at]);
  };
  const show = k => {
    if (!frames[k]) return;
    shown = k;
    load(frames[k]);
    const { step, time, n } = frames[k].meta;
    slider.value = k;
    const text = `step ${step}${time === null ? "" : `, time ${number(time)} ${units()[1]}`.trimEnd()}, ${n} particles`;
    now.textContent = text;
    slider.setAttribute("aria-valuetext", text);
    if (report.mark) report.mark({ step, time: time === null ? undefined : time });
    request();
  };

  // ------------------------------------------------------------------ drawing
  const request = () => {
    if (asked) return;
    asked = true;
    requestAnimationFrame(draw);
  };
  const draw = () => {
    asked = false;
    const ratio = (window.devicePixelRatio || 1) * (rough ? 0.5 : 1);
    const width = Math.max(1, Math.round(canvas.clientWidth * ratio)), height = Math.max(1, Math.round(canvas.clientHeight * ratio));
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    gl.viewport(0, 0, width, height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    const f = frames[shown];
    if (!f) return;
    const rows = turned(), aspect = width / height;
    const near = Math.max(view.distance - 1.05 * view.reach - 0.1, 0.01), far = view.distance + 1.05 * view.reach + 0.1;
    const proj = new Float32Array([1 / (TAN * aspect), 0, 0, 0, 0, 1 / TAN, 0, 0, 0, 0, (near + far) / (near - far), -1, 0, 0, 2 * near * far / (near - far), 0]);
    const turn = new Float32Array([0, 1, 2].flatMap(d => rows.map(row => row[d])));
    const eye = [view.pan[0], view.pan[1], view.distance];
    const place = (p, d) => (p - view.middle[d]) * view.scale;
    if (box.checked) {
      const list = [], { corner, edges: along } = f.meta;
      for (let d = 0; d < 3; d++) for (let k = 0; k < 4; k++) for (let end = 0; end < 2; end++) {
        const part = [];
        part[d] = end; part[(d + 1) % 3] = k & 1; part[(d + 2) % 3] = k >> 1;
        list.push(...corner.map((c, i) => c + part.reduce((sum, p, e) => sum + p * along[e][i], 0)).map(place));
      }
      gl.useProgram(lines.program);
      gl.bindVertexArray(edges);
      gl.bindBuffer(gl.ARRAY_BUFFER, corners);
      gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(list), gl.DYNAMIC_DRAW);
      gl.uniform3fv(lines.at.eye, eye);
      gl.uniformMatrix3fv(lines.at.turn, false, turn);
      gl.uniformMatrix4fv(lines.at.proj, false, proj);
      gl.uniform3fv(lines.at.ink, dark.matches ? [0.45, 0.5, 0.56] : [0.62, 0.66, 0.7]);
      gl.drawArrays(gl.LINES, 0, 24);
    }
    gl.useProgram(spheres.program);
    gl.bindVertexArray(cloud);
    const size = sizeOf(f), at = column(f), c = f.meta.columns[at], [lo, hi] = range();
    gl.uniform3fv(spheres.at.origin, f.meta.origin.map(place));
    gl.uniform3fv(spheres.at.cell, f.meta.cell.map(h => h * view.scale));
    gl.uniform3fv(spheres.at.eye, eye);
    gl.uniformMatrix3fv(spheres.at.turn, false, turn);
    gl.uniformMatrix4fv(spheres.at.proj, false, proj);
    gl.uniform2f(spheres.at.sizes, size.lo * view.scale, (size.hi - size.lo) * view.scale);
    gl.uniform2f(spheres.at.values, c ? c.lo : 0, c ? c.hi - c.lo : 0);
    gl.uniform2f(spheres.at.range, lo, hi);
    // A slow card turns fewer and larger particles.
    const every = rough ? Math.ceil(f.meta.n / FEW) : 1;
    sparse(every);
    gl.uniform1f(spheres.at.grow, grow.valueAsNumber * Math.cbrt(every));
    gl.uniform1f(spheres.at.only, only.checked && c ? 1 : 0);
    gl.uniform1f(spheres.at.kinds, isKind() ? 1 : 0);
    gl.uniform3fv(spheres.at.plain, c ? [-1, 0, 0] : [0.6, 0.62, 0.65]);
    const axis = "xyz".indexOf(cut.value), sign = flip.checked ? -1 : 1, plane = [0, 0, 0, 1e30];
    if (axis >= 0) {
      plane[axis] = sign;
      plane[3] = sign * ((2 * where.valueAsNumber - 1) * view.half[axis]);
    }
    gl.uniform4fv(spheres.at.cut, plane);
    gl.bindTexture(gl.TEXTURE_2D, texture);
    if (f.meta.n > 0) gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, Math.ceil(f.meta.n / every));
    if (f.walls && f.walls.length && walls.checked) {
      gl.useProgram(glass.program);
      gl.bindVertexArray(panes);
      gl.bindBuffer(gl.ARRAY_BUFFER, paneData);
      if (pane !== f.walls) gl.bufferData(gl.ARRAY_BUFFER, pane = f.walls, gl.STATIC_DRAW);
      gl.uniform3fv(glass.at.eye, eye);
      gl.uniform3fv(glass.at.middle, view.middle);
      gl.uniform1f(glass.at.scale, view.scale);
      gl.uniformMatrix3fv(glass.at.turn, false, turn);
      gl.uniformMatrix4fv(glass.at.proj, false, proj);
      gl.uniform3fv(glass.at.ink, dark.matches ? [0.55, 0.68, 0.78] : [0.37, 0.49, 0.58]);
      gl.enable(gl.BLEND);
      gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
      gl.depthMask(false);
      gl.drawArrays(gl.TRIANGLES, 0, f.walls.length / 6);
      gl.depthMask(true);
      gl.disable(gl.BLEND);
    }
    rows[0].forEach((right, d) => {
      const [dx, dy] = [26 * right, -26 * rows[1][d]], line = $(`axis-${d}`), text = $(`name-${d}`);
      line.setAttribute("x2", dx);
      line.setAttribute("y2", dy);
      text.setAttribute("x", 1.3 * dx);
      text.setAttribute("y", 1.3 * dy + 4);
    });
  };

  // ------------------------------------------------------------------ hands
  const rotate = (dx, dy) => {
    view.yaw += dx;
    view.pitch = Math.min(Math.PI, Math.max(0, view.pitch + dy));
    request();
  };
  const zoom = by => {
    view.distance = Math.min(60, Math.max(0.05, view.distance * by));
    request();
  };
  const pan = (dx, dy) => {
    const unit = 2 * TAN * view.distance / Math.max(1, canvas.clientHeight);
    view.pan = [view.pan[0] - dx * unit, view.pan[1] + dy * unit];
    request();
  };
  const fingers = new Map();
  let last = 0;
  canvas.addEventListener("pointerdown", e => {
    fingers.set(e.pointerId, e);
    canvas.setPointerCapture(e.pointerId);
    last = 0;
  });
  canvas.addEventListener("pointermove", e => {
    const was = fingers.get(e.pointerId);
    if (!was) return;
    // Moves that come so late have waited for the card.
    if (last && e.timeStamp - last > 70) rough = true;
    last = e.timeStamp;
    const [dx, dy] = [e.clientX - was.clientX, e.clientY - was.clientY];
    if (fingers.size === 2) {
      const other = [...fingers.values()].find(f => f.pointerId !== e.pointerId);
      const gap = p => Math.hypot(p.clientX - other.clientX, p.clientY - other.clientY);
      zoom(gap(was) / Math.max(1, gap(e)));
      pan(dx / 2, dy / 2);
    } else if (e.shiftKey || e.buttons & 6) pan(dx, dy);
    else rotate(dx * 0.008, -dy * 0.008);
    fingers.set(e.pointerId, e);
  });
  const lift = e => {
    fingers.delete(e.pointerId);
    rough = false;
    request();
  };
  canvas.addEventListener("pointerup", lift);
  canvas.addEventListener("pointercancel", lift);
  canvas.addEventListener("contextmenu", e => e.preventDefault());
  // The page scrolls until the picture is grabbed.
  canvas.addEventListener("wheel", e => {
    if (document.activeElement !== canvas) return;
    e.preventDefault();
    zoom(Math.exp(0.0012 * e.deltaY));
  }, { passive: false });

  const step = by => show(Math.min(frames.length - 1, Math.max(0, shown + by)));
  const stop = () => {
    playing = 0;
    play.textContent = "Play";
    play.setAttribute("aria-pressed", "false");
  };
  const start = () => {
    if (frames.length < 2) return;
    if (shown >= frames.length - 1) show(0);
    play.textContent = "Pause";
    play.setAttribute("aria-pressed", "true");
    const me = playing = performance.now();
    let then = me;
    const beat = t => {
      if (playing !== me) return;
      if (t - then > 80) {
        then = t;
        if (shown >= frames.length - 1) return stop();
        step(1);
      }
      requestAnimationFrame(beat);
    };
    requestAnimationFrame(beat);
  };
  const toggle = () => (playing ? stop() : start());
  const look = (yaw, pitch) => {
    [view.yaw, view.pitch] = [yaw, pitch];
    frame();
  };
  const KEYS = {
    ArrowLeft: () => rotate(-0.1, 0), ArrowRight: () => rotate(0.1, 0), ArrowUp: () => rotate(0, 0.1), ArrowDown: () => rotate(0, -0.1),
    "+": () => zoom(0.9), "=": () => zoom(0.9), "-": () => zoom(1 / 0.9), " ": toggle, ",": () => step(-1), ".": () => step(1), Home: home,
    x: () => look(-Math.PI / 2, Math.PI / 2), y: () => look(0, Math.PI / 2), z: () => look(0, 0),
  };
  canvas.addEventListener("keydown", e => {
    const act = !e.ctrlKey && !e.metaKey && !e.altKey && KEYS[e.key];
    if (!act) return;
    e.preventDefault();
    act();
  });

  play.addEventListener("click", toggle);
  $("back").addEventListener("click", () => step(-1));
  $("next").addEventListener("click", () => step(1));
  slider.addEventListener("input", () => { stop(); show(Number(slider.value)); });
  colour.addEventListener("change", () => {
    touched = true;
    from.value = to.value = "";
    map.value = colour.value === "damage" ? "damage" : "viridis";
    coloured();
  });
  map.addEventListener("change", () => { touched = true; coloured(); });
  [from, to].forEach(input => input.addEventListener("input", coloured));
  [only, where, flip, grow, box, walls].forEach(input => input.addEventListener("input", request));
  cut.addEventListener("change", () => { where.disabled = flip.disabled = cut.value === "nothing"; request(); });
  $("reset").addEventListener("click", home);
  $("save").addEventListener("click", () => {
    draw();
    canvas.toBlob(blob => {
      const link = document.createElement("a");
      link.href = URL.createObjectURL(blob);
      link.download = `step-${frames[shown] ? frames[shown].meta.step : 0}.png`;
      link.click();
      URL.revokeObjectURL(link.href);
    });
  });
  dark.addEventListener("change", request);
  new ResizeObserver(request).observe(canvas);

  // ------------------------------------------------------------------ beginning
  const arrived = (k, f) => {
    const begins = !frames.some(f => f && f.meta.n > 0);
    frames[k] = f;
    slider.max = Math.max(0, frames.length - 1);
    slider.disabled = frames.length < 2;
    if (begins) {
      fit();
      const long = d => f.meta.edges.reduce((sum, edge) => sum + Math.abs(edge[d]), 0);
      box.checked = spread(f).every((s, d) => long(d) < 3 * Math.max(s, 0.3 * Math.max(...spread(f))));
      names();
      home();
    }
    if (f.walls && f.walls.length) $("walled").hidden = false;
    if (shown < 0) show(k);
  };
  const settled = () => {
    reach();
    names();
    choose();
    coloured();
  };
  const read = async () => {
    for (let k = 0; k < film.frames.length; k++) {
      say(`Unpacking frame ${k + 1} of ${film.frames.length} …`);
      const packed = $(`frame-${k}`), f = unpack(film.frames[k], await inflate(bytesOf(packed.textContent)), frames[k - 1]);
      packed.remove();
      arrived(k, f);
      reach();
    }
    say(film.frames.length ? "" : "There is nothing to see yet.");
    const before = [view.yaw, view.pitch].join();
    fit();
    settled();
    if (before === [view.yaw, view.pitch].join()) home();
    if (shown === 0 && !playing) show(frames.length - 1);
  };
  report.view = { draw, arrived, settled, unpack, inflate, frames, show, say, shown: () => shown, state: view };
  read().catch(e => say(`The particles cannot be shown: ${e.message}`));
})();
