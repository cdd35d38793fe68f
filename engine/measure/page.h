#pragma once
#include <string_view>

// The parts of report.html that do not depend on the run. Plain CSS and JavaScript, no library, no network.
namespace etalon::page {

inline constexpr std::string_view kStyle = R"css(
:root { color-scheme: light dark; --line: #8885; --good: #1a7f37; --bad: #cf222e; --soft: #8882; }
@media (prefers-color-scheme: dark) { :root { --good: #3fb950; --bad: #ff7b72; } }
body { font: 15px/1.45 system-ui, sans-serif; margin: 0 auto; padding: 1rem; max-width: 76rem; }
h1 { font-size: 1.35rem; overflow-wrap: anywhere; } h2 { font-size: 1.1rem; margin-top: 2rem; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { padding: .25rem .7rem; text-align: left; border-bottom: 1px solid var(--line); vertical-align: top; }
.scroll { overflow-x: auto; }
.grid { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(22rem, 100%), 1fr)); gap: 1rem; }
figure { margin: 0; } figure img { width: 100%; height: auto; image-rendering: pixelated; background: var(--soft); }
figcaption { font-size: .9rem; }
.good { color: var(--good); font-weight: 600; } .bad { color: var(--bad); font-weight: 600; }
canvas { width: 100%; height: auto; image-rendering: pixelated; background: var(--soft); touch-action: none; cursor: crosshair; }
.grid img { max-height: 80vh; object-fit: contain; }
.controls { display: flex; flex-wrap: wrap; gap: .4rem 1.2rem; margin: .5rem 0; align-items: center; }
#readout { min-height: 7em; } svg { background: var(--soft); } svg rect { fill: currentColor; }
summary { cursor: pointer; }
)css";

/// Reads the JSON of #data: width, height, exposure in EV, runs with `radiance` and `deviation` as PNG data URIs that
/// hold shared-exponent values: 8-bit mantissas in the upper half, the exponent + 128 in red of the lower half.
inline constexpr std::string_view kScript = R"js(
"use strict";
const data = JSON.parse(document.getElementById("data").textContent);
const get = id => document.getElementById(id);
const view = get("view"), context = view.getContext("2d");
const state = { zoom: 1, x: 0, y: 0, pixel: null };

async function decode(uri) {
  const image = new Image();
  image.src = uri;
  await image.decode();
  const canvas = document.createElement("canvas");
  canvas.width = image.width; canvas.height = image.height;
  const draw = canvas.getContext("2d", { colorSpace: "srgb" });
  draw.drawImage(image, 0, 0);
  const bytes = draw.getImageData(0, 0, image.width, image.height).data;
  const count = image.width * image.height / 2, values = new Float32Array(3 * count);
  for (let i = 0; i < count; ++i) {
    const exponent = bytes[4 * (count + i)];
    const scale = exponent === 255 ? NaN : exponent === 0 ? 0 : 2 ** (exponent - 128 - 8);
    for (let c = 0; c < 3; ++c) values[3 * i + c] = bytes[4 * i + c] * scale;
  }
  return values;
}

const coded = v => !(v === v) ? -1 : v <= 0 ? 0 : v >= 1 ? 255 : 255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055);
const hot = t => [Math.min(255, 765 * t), Math.min(255, Math.max(0, 765 * t - 255)), Math.max(0, 765 * t - 510)];

function colour(out, o, a, b, i, left, gain) {
  if (get("mode").value === "difference") {
    let difference = 0, magnitude = 0;
    for (let c = 0; c < 3; ++c) {
      difference += Math.abs(a[3 * i + c] - b[3 * i + c]);
      magnitude += (Math.abs(a[3 * i + c]) + Math.abs(b[3 * i + c])) / 2;
    }
    const [r, g, bl] = hot(Math.min(1, gain * difference / (magnitude + 1e-20)));
    out[o] = r; out[o + 1] = g; out[o + 2] = bl;
    return;
  }
  const source = left ? a : b;
  for (let c = 0; c < 3; ++c) {
    const v = coded(gain * source[3 * i + c]);
    out[o + c] = v < 0 ? (c === 1 ? 0 : 255) : v;
  }
}

function paint() {
  const a = data.runs[get("a").value].values, b = data.runs[get("b").value].values;
  const gain = 2 ** get("exposure").valueAsNumber, wipe = get("wipe").valueAsNumber / 100 * data.width;
  const picture = context.createImageData(data.width, data.height);
  for (let y = 0; y < data.height; ++y)
    for (let x = 0; x < data.width; ++x) {
      const sx = Math.floor(state.x + x / state.zoom), sy = Math.floor(state.y + y / state.zoom);
      const o = 4 * (y * data.width + x);
      colour(picture.data, o, a, b, sy * data.width + sx, x < wipe, gain);
      picture.data[o + 3] = 255;
    }
  context.putImageData(picture, 0, 0);
  get("shown").textContent = `${get("exposure").valueAsNumber.toFixed(1)} EV, ${state.zoom}×`;
  read();
}

function read() {
  if (!state.pixel) return;
  const [x, y] = state.pixel, i = y * data.width + x;
  const rows = data.runs.map(run => {
    const cell = c => run.values[3 * i + c].toPrecision(4) + (run.errors ? " ± " + run.errors[3 * i + c].toPrecision(2) : "");
    return [run.name, cell(0), cell(1), cell(2)];
  });
  const table = document.createElement("table");
  for (const row of [[`pixel ${x}, ${y}`, "red", "green", "blue"], ...rows]) {
    const line = table.insertRow();
    for (const text of row) line.insertCell().textContent = text;
  }
  get("readout").replaceChildren(table);
}

function aim(x, y) {
  const clamp = (v, size) => Math.max(0, Math.min(size - 1, v));
  state.pixel = [clamp(x, data.width), clamp(y, data.height)];
  read();
}

function zoom(factor) {
  const [px, py] = state.pixel || [data.width >> 1, data.height >> 1];
  state.zoom = Math.max(1, Math.min(32, state.zoom * factor));
  const place = (p, size) => Math.max(0, Math.min(size - size / state.zoom, p - size / state.zoom / 2));
  state.x = place(px, data.width); state.y = place(py, data.height);
  paint();
}

function from_event(event) {
  const box = view.getBoundingClientRect();
  return [Math.floor(state.x + (event.clientX - box.left) / box.width * data.width / state.zoom),
          Math.floor(state.y + (event.clientY - box.top) / box.height * data.height / state.zoom)];
}

async function start() {
  get("inspect").hidden = false;
  await Promise.all(data.runs.map(async run => {
    run.values = await decode(run.radiance);
    run.errors = run.deviation ? await decode(run.deviation) : null;
  }));
  for (const run of data.runs)
    for (const id of ["a", "b"]) get(id).add(new Option(run.name, data.runs.indexOf(run)));
  get("b").selectedIndex = Math.min(1, data.runs.length - 1);
  view.width = data.width; view.height = data.height;
  view.style.maxWidth = `${80 * data.width / data.height}vh`;
  get("exposure").valueAsNumber = data.exposure;
  for (const id of ["a", "b", "mode", "exposure", "wipe"]) get(id).addEventListener("input", paint);
  view.addEventListener("pointermove", event => aim(...from_event(event)));
  view.addEventListener("wheel", event => { event.preventDefault(); aim(...from_event(event)); zoom(event.deltaY < 0 ? 2 : 0.5); }, { passive: false });
  view.addEventListener("keydown", event => {
    const [x, y] = state.pixel || [data.width >> 1, data.height >> 1];
    const move = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    if (move) aim(x + move[0], y + move[1]);
    else if (event.key === "+" || event.key === "=") zoom(2);
    else if (event.key === "-") zoom(0.5);
    else return;
    event.preventDefault();
  });
  paint();
}
start();
)js";

/// The inspector: shown by the script once it has its data.
inline constexpr std::string_view kInspector = R"html(
<section id="inspect" hidden>
<h2>Inspect</h2>
<div class="controls">
<label>A (left) <select id="a"></select></label>
<label>B (right) <select id="b"></select></label>
<label>show <select id="mode"><option value="wipe">A | B</option><option value="difference">relative difference × 2^EV</option></select></label>
<label>wipe <input id="wipe" type="range" min="0" max="100" value="50"></label>
<label>exposure <input id="exposure" type="range" min="-20" max="20" step="0.5" value="0"></label>
<output id="shown"></output>
</div>
<canvas id="view" tabindex="0" aria-label="Pictures A and B, side by side at the wipe. Arrow keys move the read-out, plus and minus zoom."></canvas>
<div id="readout" aria-live="polite">Point at a pixel, or focus the picture and use the arrow keys; + and − or the wheel zoom.</div>
</section>
)html";

}  // namespace etalon::page
