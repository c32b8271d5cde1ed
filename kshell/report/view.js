"use strict";
// The view of a report: draws the structure with WebGL 2, turns it, and reads values at points.
// Symbols: q is the rotation of the view (3 x 3, rows), c the middle of the nodes, r half of their extent,
// (px, py) what the view is moved by, z what it is enlarged by, f by which displacements are enlarged.
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const part = id => document.getElementById(id);
  const bytes = text => Uint8Array.from(atob(text), letter => letter.charCodeAt(0)).buffer;
  const floats = text => new Float32Array(bytes(text)), whole = text => new Uint32Array(bytes(text));
  const gl = part("canvas").getContext("webgl2", {antialias: true, preserveDrawingBuffer: true});
  if (!gl || !data.states.length || !data.states[0].fields.length) return;
  part("view").hidden = false;
  const nodes = floats(data.nodes), triangles = whole(data.triangles), count = nodes.length / 3;
  const VIRIDIS = [[68, 1, 84], [71, 44, 122], [59, 81, 139], [44, 113, 142], [33, 144, 141], [39, 173, 129],
    [92, 200, 99], [170, 220, 50], [253, 231, 37]];
  const BLUE_RED = [[5, 48, 97], [53, 129, 185], [146, 197, 222], [220, 234, 242], [247, 247, 247], [252, 224, 208],
    [244, 165, 130], [203, 71, 66], [103, 0, 31]];
  const PULL = 2e-3;  // of the depth, by which strokes lie before the surface
  const GREY = Array(9).fill([225, 229, 234]);

  const vertexShader = `#version 300 es
    layout(location = 0) in vec3 node; layout(location = 1) in vec3 moved; layout(location = 2) in float value;
    uniform mat3 turn; uniform vec3 middle; uniform vec4 window; uniform float factor, pull;
    out float shown; out vec3 place;
    void main() {
      place = turn * (node + factor * moved - middle);
      gl_Position = vec4(place.xy * window.xy + window.zw, -place.z * window.y * 0.1 - pull, 1.0);
      shown = value;
    }`;
  const fragmentShader = `#version 300 es
    precision highp float;
    in float shown; in vec3 place;
    uniform vec3 colours[9]; uniform vec2 range; uniform vec4 line;
    out vec4 colour;
    void main() {
      if (line.a > 0.0) { colour = line; return; }
      float s = 8.0 * clamp((shown - range.x) / (range.y - range.x), 0.0, 1.0);
      int k = int(min(floor(s), 7.0));
      vec3 normal = normalize(cross(dFdx(place), dFdy(place)));
      float light = 0.62 + 0.38 * abs(dot(normal, normalize(vec3(0.25, 0.35, 0.9))));
      colour = vec4(light * mix(colours[k], colours[k + 1], s - float(k)), 1.0);
    }`;
  const program = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, vertexShader], [gl.FRAGMENT_SHADER, fragmentShader]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  gl.useProgram(program);
  const at = name => gl.getUniformLocation(program, name);
  const buffer = (name, size, values) => {
    const place = gl.getAttribLocation(program, name), made = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, made);
    gl.bufferData(gl.ARRAY_BUFFER, values, gl.DYNAMIC_DRAW);
    gl.enableVertexAttribArray(place);
    gl.vertexAttribPointer(place, size, gl.FLOAT, false, 0, 0);
    return made;
  };
  const numbers = values => {
    const made = gl.createBuffer();
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, made);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, values, gl.STATIC_DRAW);
    return {made, count: values.length};
  };
  buffer("node", 3, nodes);
  const movedBuffer = buffer("moved", 3, new Float32Array(nodes.length));
  const valueBuffer = buffer("value", 1, new Float32Array(count));
  const faces = numbers(triangles), lines = numbers(whole(data.lines)), outline = numbers(whole(data.outline));
  // strokes are thin rectangles: their corners are bound by themselves
  const strokes = {bound: gl.createVertexArray(), node: gl.createBuffer(), moved: gl.createBuffer(), parts: []};
  gl.bindVertexArray(strokes.bound);
  for (const [place, made] of [[0, strokes.node], [1, strokes.moved]]) {
    gl.bindBuffer(gl.ARRAY_BUFFER, made);
    gl.enableVertexAttribArray(place);
    gl.vertexAttribPointer(place, 3, gl.FLOAT, false, 0, 0);
  }
  gl.bindVertexArray(null);
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  nodes.forEach((x, n) => { low[n % 3] = Math.min(low[n % 3], x); high[n % 3] = Math.max(high[n % 3], x); });
  const c = low.map((x, n) => 0.5 * (x + high[n]));
  const r = 0.5 * Math.hypot(...low.map((x, n) => high[n] - x)) || 1;

  let q, px, py, z, moved, values, range, colours, mark = null, f = 0;
  const times = (a, b) => a.map(row => [0, 1, 2].map(j => row[0] * b[0][j] + row[1] * b[1][j] + row[2] * b[2][j]));
  const about = (axis, angle) => {
    const s = Math.sin(angle), k = Math.cos(angle);
    return axis === "x" ? [[1, 0, 0], [0, k, -s], [0, s, k]] : [[k, -s, 0], [s, k, 0], [0, 0, 1]];
  };
  const start = () => {
    q = times(about("x", -1.0), about("z", 0.55));
    px = py = 0;
    z = 1;
  };
  const column = text => floats(text);
  const kept = new Map();  // columns as numbers, by their text
  const numbersOf = text => { if (!kept.has(text)) kept.set(text, column(text)); return kept.get(text); };
  const state = () => data.states[+part("frame").value];
  const length = of => Float32Array.from({length: count}, (_, n) => Math.hypot(...of.map(v => v[n])));
  const options = (select, names) => select.replaceChildren(...names.map((name, n) => new Option(name, n)));

  const choices = () => state().fields.flatMap(field => {
    const own = field.columns.map((text, n) => ({
      label: field.of.length ? `${field.label} ${field.of[n]}` : field.label, values: () => numbersOf(text)}));
    const whole = {label: `${field.label}, length`, values: () => length(field.columns.map(numbersOf))};
    return field.name === "displacement" ? [whole, ...own] : own;
  });
  const shownFor = () => [...choices(), ...state().strokes];
  const short = value => Number(value.toPrecision(4)).toString();

  function chooseState() {
    const columns = state().fields[0].columns.map(numbersOf);
    moved = new Float32Array(nodes.length);
    columns.forEach((values, k) => values.forEach((value, n) => { moved[3 * n + k] = value; }));
    gl.bindBuffer(gl.ARRAY_BUFFER, movedBuffer);
    gl.bufferData(gl.ARRAY_BUFFER, moved, gl.DYNAMIC_DRAW);
    chooseField();
  }
  // corners of two triangles for each stroke: its ends a and b, to both sides
  function strokeCorners(lines) {
    const node = [], shift = [];
    strokes.parts = lines.map(line => {
      const numbers = floats(line.numbers), first = node.length / 3;
      for (let k = 0; k < numbers.length; k += 12) {
        for (const [end, side] of [[0, 1], [0, -1], [3, 1], [3, 1], [0, -1], [3, -1]]) {
          for (let j = 0; j < 3; j++) {
            node.push(numbers[k + end + j] + side * numbers[k + 6 + j]);
            shift.push(numbers[k + 9 + j]);
          }
        }
      }
      const rgb = [1, 3, 5].map(j => parseInt(line.colour.slice(j, j + 2), 16) / 255);
      return {first, count: node.length / 3 - first, rgb};
    });
    for (const [made, all] of [[strokes.node, node], [strokes.moved, shift]]) {
      gl.bindBuffer(gl.ARRAY_BUFFER, made);
      gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(all), gl.DYNAMIC_DRAW);
    }
  }
  function chooseField() {
    const chosen = shownFor()[+part("field").value] || choices()[0];
    strokeCorners(chosen.lines || []);
    part("strokes").replaceChildren(...(chosen.lines || []).map(line => {
      const row = document.createElement("div");
      row.textContent = line.words;
      row.style.borderColor = line.colour;
      return row;
    }), chosen.lines ? `longest: ${chosen.longest}` : "");
    part("legend").classList.toggle("without", !!chosen.lines);
    values = chosen.lines ? new Float32Array(count) : chosen.values();
    let least = Infinity, most = -Infinity;
    for (const value of values) { least = Math.min(least, value); most = Math.max(most, value); }
    const both = least < 0 && most > 0, side = Math.max(-least, most);
    colours = chosen.lines ? GREY : both ? BLUE_RED : VIRIDIS;
    range = both ? [-side, side] : most > least ? [least, most] : [least, least + 1];
    part("high").textContent = short(range[1]);
    part("low").textContent = short(range[0]);
    part("bar").style.background = `linear-gradient(to top, ${colours.map(rgb => `rgb(${rgb})`).join(", ")})`;
    gl.bindBuffer(gl.ARRAY_BUFFER, valueBuffer);
    gl.bufferData(gl.ARRAY_BUFFER, values, gl.DYNAMIC_DRAW);
    if (mark) read(mark.triangle, mark.weights);
    draw();
  }
  function window_() {
    const {clientWidth: w, clientHeight: h} = gl.canvas, unit = 0.92 * z / r;
    return {x: unit * Math.min(1, h / w), y: unit * Math.min(1, w / h), px, py};
  }
  function draw() {
    const canvas = gl.canvas, ratio = window.devicePixelRatio || 1;
    const w = Math.round(canvas.clientWidth * ratio), h = Math.round(canvas.clientHeight * ratio);
    if (canvas.width !== w || canvas.height !== h) { canvas.width = w; canvas.height = h; }
    f = state().scale * +part("scale").value;
    part("factor").textContent = short(f);
    const {x, y} = window_(), dark = window.matchMedia("(prefers-color-scheme: dark)").matches;
    gl.viewport(0, 0, w, h);
    gl.clearColor(...(dark ? [0.114, 0.137, 0.169] : [0.957, 0.965, 0.976]), 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.uniformMatrix3fv(at("turn"), true, q.flat());
    gl.uniform3fv(at("middle"), c);
    gl.uniform4f(at("window"), x, y, px, py);
    gl.uniform1f(at("factor"), f);
    gl.uniform3fv(at("colours"), colours.flat().map(part => part / 255));
    gl.uniform2fv(at("range"), range);
    const shown = (what, kind, pull, line) => {
      gl.uniform1f(at("pull"), pull);
      gl.uniform4fv(at("line"), line);
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, what.made);
      gl.drawElements(kind, what.count, gl.UNSIGNED_INT, 0);
    };
    shown(faces, gl.TRIANGLES, 0, [0, 0, 0, 0]);
    const ink = dark ? 0.9 : 0.1;
    const pale = strokes.parts.length ? 0.34 : 0;  // edges behind strokes
    if (part("edges").checked) shown(lines, gl.LINES, 2e-4, [0.35 + pale, 0.38 + pale, 0.42 + pale, 1]);
    shown(outline, gl.LINES, 4e-4, [ink, ink, ink, 1]);
    gl.bindVertexArray(strokes.bound);
    gl.uniform1f(at("pull"), PULL);
    for (const {first, count: corners, rgb} of strokes.parts) {
      gl.uniform4f(at("line"), ...rgb, 1);
      gl.drawArrays(gl.TRIANGLES, first, corners);
    }
    gl.bindVertexArray(null);
  }
  // place of a node on the canvas in its pixels, and how near it is
  function onCanvas(n) {
    const p = [0, 1, 2].map(k => nodes[3 * n + k] + f * moved[3 * n + k] - c[k]);
    const v = q.map(row => row[0] * p[0] + row[1] * p[1] + row[2] * p[2]), {x, y} = window_();
    const {clientWidth: w, clientHeight: h} = gl.canvas;
    return [0.5 * w * (1 + v[0] * x + px), 0.5 * h * (1 - v[1] * y - py), v[2]];
  }
  // the nearest triangle below a point of the canvas, with the weights of its corners
  function below(x, y) {
    const seen = Array.from({length: count}, (_, n) => onCanvas(n));
    let best = null;
    for (let t = 0; t < triangles.length; t += 3) {
      const [a, b, d] = [seen[triangles[t]], seen[triangles[t + 1]], seen[triangles[t + 2]]];
      const area = (b[0] - a[0]) * (d[1] - a[1]) - (d[0] - a[0]) * (b[1] - a[1]);
      if (area === 0) continue;
      const u = ((x - a[0]) * (d[1] - a[1]) - (d[0] - a[0]) * (y - a[1])) / area;
      const v = ((b[0] - a[0]) * (y - a[1]) - (x - a[0]) * (b[1] - a[1])) / area;
      if (u < -1e-6 || v < -1e-6 || u + v > 1 + 1e-6) continue;
      const near = (1 - u - v) * a[2] + u * b[2] + v * d[2];
      if (!best || near > best.near) best = {near, triangle: t / 3, weights: [1 - u - v, u, v]};
    }
    return best;
  }
  function read(triangle, weights) {
    const mean = of => [0, 1, 2].reduce((sum, k) => sum + weights[k] * of(triangles[3 * triangle + k]), 0);
    const place = [0, 1, 2].map(k => mean(n => nodes[3 * n + k]));
    const found = choices().map(choice => {
      const column = choice.values();
      return {label: choice.label, value: mean(n => column[n])};
    });
    const rows = [["at", place.map(x => Number(x.toPrecision(6))).join(", ")],
      ...found.map(({label, value}) => [label, Number(value.toPrecision(6)).toString()])];
    const table = document.createElement("table");
    table.className = "pairs";
    for (const [label, value] of rows) {
      const row = table.insertRow(), head = document.createElement("th");
      head.textContent = label;
      row.append(head);
      row.insertCell().textContent = value;
    }
    part("picked").replaceChildren(table);
    mark = {triangle, weights};
    return {place, found};
  }
  function pick(x, y) {
    const best = below(x, y);
    return best && read(best.triangle, best.weights);
  }
  const held = new Map();  // pointers that are down
  let far = 0;
  const canvas = gl.canvas;
  canvas.addEventListener("pointerdown", event => {
    canvas.setPointerCapture(event.pointerId);
    if (!held.size) far = 0;
    held.set(event.pointerId, [event.offsetX, event.offsetY]);
  });
  canvas.addEventListener("pointermove", event => {
    if (!held.has(event.pointerId)) return;
    const before = held.get(event.pointerId), now = [event.offsetX, event.offsetY];
    const other = [...held].find(([id]) => id !== event.pointerId);
    const [dx, dy] = [now[0] - before[0], now[1] - before[1]];
    far += Math.hypot(dx, dy);
    held.set(event.pointerId, now);
    if (other) {
      const apart = from => Math.hypot(from[0] - other[1][0], from[1] - other[1][1]);
      if (apart(before) > 0) z *= apart(now) / apart(before);
    } else if (event.shiftKey) {
      px += 2 * dx / canvas.clientWidth;
      py -= 2 * dy / canvas.clientHeight;
    } else {
      q = times(about("x", 0.008 * dy), times(q, about("z", 0.008 * dx)));
    }
    draw();
  });
  const up = event => {
    if (held.delete(event.pointerId) && event.type === "pointerup" && far < 4) pick(event.offsetX, event.offsetY);
  };
  canvas.addEventListener("pointerup", up);
  canvas.addEventListener("pointercancel", up);
  canvas.addEventListener("wheel", event => {
    event.preventDefault();
    z *= Math.exp(-0.0012 * event.deltaY);
    draw();
  }, {passive: false});
  canvas.addEventListener("keydown", event => {
    const turns = {ArrowLeft: ["z", -0.1], ArrowRight: ["z", 0.1], ArrowUp: ["x", -0.1], ArrowDown: ["x", 0.1]};
    const [axis, angle] = turns[event.key] || [];
    if (!axis) return;
    event.preventDefault();
    q = axis === "x" ? times(about(axis, angle), q) : times(q, about(axis, angle));
    draw();
  });
  options(part("frame"), data.states.map(one => one.name));
  if (data.what === "step") part("frame").value = data.states.length - 1;
  part("frame-label").firstChild.textContent = `${data.what} `;
  part("frame-label").hidden = data.states.length < 2;
  options(part("field"), shownFor().map(choice => choice.label));
  part("frame").addEventListener("change", chooseState);
  part("field").addEventListener("change", chooseField);
  part("scale").addEventListener("input", draw);
  part("edges").addEventListener("change", draw);
  part("reset").addEventListener("click", () => { start(); part("scale").value = 1; draw(); });
  new ResizeObserver(draw).observe(canvas);
  start();
  chooseState();
  window.kshellView = {pick, onCanvas, below, read, nodes, triangles};
})();
