"use strict";

const byId = (id) => document.getElementById(id);
const canvas = byId("canvas");
const pen = canvas.getContext("2d");
const timeline = byId("timeline");

let version = 0;
let film = null;       // what the server says of the film that is shown
let frame = 0;         // the frame at the playhead
let drawn = -1;        // the frame on the canvas
let playing = null;    // {since, from}: when and where playing began
let curves = null;

const kMostBitmaps = 120;
let bitmaps = new Map();  // frame -> promise of an ImageBitmap, the oldest first

function make(tag, attributes = {}, ...children) {
    const element = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
    element.append(...children);
    return element;
}

function post(path, body = {}) {
    return fetch(path, {method: "POST", body: JSON.stringify(body)});
}

// ---------------------------------------------------------------- frames

function bitmapOf(k) {
    const kept = bitmaps.get(k);
    if (kept) return kept;
    const number = film.number;
    const bitmap = fetch(`frame/${k}.png?film=${number}`).then(async (response) => {
        if (!response.ok) throw new Error(response.status === 410 || response.status === 503 ? "" : await response.text());
        return createImageBitmap(await response.blob());
    });
    bitmap.catch(() => { if (film.number === number) bitmaps.delete(k); });
    bitmaps.set(k, bitmap);
    if (bitmaps.size > kMostBitmaps) bitmaps.delete(bitmaps.keys().next().value);
    return bitmap;
}

async function show(k) {
    frame = k;
    timeline.value = k;
    const number = film.number;
    byId("time").textContent = `${(k * film.frame_s).toFixed(2)} s, frame ${k}`;
    byId("download").href = `frame/${k}.png?film=${number}`;
    byId("download").download = `frame-${k}.png`;
    markTime();
    try {
        const bitmap = await bitmapOf(k);
        if (film.number !== number || frame !== k) return;
        if (canvas.width !== bitmap.width) canvas.width = bitmap.width;
        if (canvas.height !== bitmap.height) canvas.height = bitmap.height;
        pen.clearRect(0, 0, canvas.width, canvas.height);
        pen.drawImage(bitmap, 0, 0);
        drawn = k;
        canvas.dataset.frame = `${number}:${k}`;
    } catch (error) {
        if (error.message) showProblems([{line: null, text: error.message}]);
        else setTimeout(() => { if (film.number === number && frame === k && drawn !== k) show(k); }, 200);
    }
}

function seek(k) {
    if (!film) return;
    show(Math.max(0, Math.min(film.frames - 1, Math.round(k))));
    if (playing) playing = {since: performance.now(), from: frame};
}

function setPlaying(on) {
    playing = on && film ? {since: performance.now(), from: frame >= film.frames - 1 ? 0 : frame} : null;
    byId("play").textContent = playing ? "Pause" : "Play";
    byId("play").setAttribute("aria-pressed", String(playing !== null));
    if (playing) requestAnimationFrame(play);
}

function play(now) {
    if (!playing) return;
    const speed = Number(byId("speed").value);
    const next = playing.from + Math.max(0, now - playing.since) / 1000 * film.fps * speed;
    const k = Math.floor(next) % film.frames;
    // A film that is drawn more slowly than it plays waits for its frames.
    if (drawn !== frame) playing = {since: now, from: frame};
    else if (k !== frame) show(k);
    for (let ahead = 1; ahead <= 8; ++ahead) bitmapOf((frame + ahead) % film.frames);
    requestAnimationFrame(play);
}

// ---------------------------------------------------------------- state

function showProblems(problems) {
    const box = byId("problems");
    box.hidden = problems.length === 0;
    box.replaceChildren(...problems.map((problem) => make("p", {},
        ...(problem.line === null ? [] : [make("b", {}, `line ${problem.line}, column ${problem.column} `)]),
        problem.text)));
}

function showStatus(state) {
    const status = byId("status");
    status.classList.toggle("bad", state.problems.length > 0);
    if (state.busy) status.textContent = state.progress > 0 ? `simulating, ${Math.round(100 * state.progress)} %` : "loading";
    else if (state.problems.length > 0) status.textContent = state.film ? "the last good film is shown" : "no film yet";
    else status.textContent = `${state.film.width} x ${state.film.height}, ${state.film.frames} frames at ${Number(state.film.fps.toFixed(3))} per second`;
}

function take(state) {
    version = state.version;
    document.title = `${state.film ? state.film.name : state.file} - corda watch`;
    byId("name").textContent = state.file.slice(state.file.lastIndexOf("/") + 1);
    byId("name").title = state.file;
    showStatus(state);
    if (!state.busy) showProblems(state.problems);
    showNumbers(state);
    if (!state.film || (film && film.number === state.film.number)) return;
    film = state.film;
    bitmaps = new Map();
    drawn = -1;
    timeline.max = film.frames - 1;
    byId("plan").replaceChildren(...film.plan.map((line) => make("li", {}, line)));
    seek(Math.min(frame, film.frames - 1));
    readCurves();
}

async function follow() {
    for (;;) {
        try {
            const response = await fetch(`state?after=${version}`);
            const state = await response.json();
            if (!state.ended) {
                take(state);
                continue;
            }
        } catch (error) {
            // The program has ended; it may be started again at this address.
        }
        byId("status").textContent = "corda watch has ended";
        byId("status").classList.add("bad");
        await new Promise((resolve) => setTimeout(resolve, 1000));
    }
}

// ---------------------------------------------------------------- numbers

const rows = new Map();  // key -> the elements of a number
const sending = new Map();  // key -> the value to send next, while a request is on its way

/// Sends the last value of a number; values in between are left out while a request is on its way.
async function send(key, value) {
    const isOnItsWay = sending.has(key);
    sending.set(key, value);
    if (isOnItsWay) return;
    try {
        for (let sent; sending.get(key) !== sent;) {
            sent = sending.get(key);
            const response = await post("number", {key, value: sent});
            if (!response.ok) throw new Error(await response.text());
        }
    } catch (error) {
        showProblems([{line: null, text: error.message}]);
    }
    sending.delete(key);
}

/// The ends and the step of a slider: around the number of the scene, within the range of the key.
function extentOf(number) {
    const size = Math.abs(number.unchanged);
    let [low, high] = number.unchanged > 0 ? [0, 3 * size] : number.unchanged < 0 ? [-3 * size, 3 * size] : [-1, 1];
    if (number.unit === "degrees") [low, high] = [-180, 180];
    if (number.is_integer) high = Math.max(high, low + 10);
    const step = number.is_integer ? 1 : 10 ** Math.floor(Math.log10((high - low) / 200));
    low = Math.max(low, number.low);
    high = Math.min(high, number.high);
    return {low, high, step};
}

function makeRow(number) {
    const {low, high, step} = extentOf(number);
    const id = `number-${rows.size}`;
    const slider = make("input", {type: "range", id, min: low, max: high, step});
    const field = make("input", {type: "number", step: "any", "aria-label": `${number.key}, exact`});
    const label = make("label", {for: id, title: number.meaning}, number.key, " ", make("small", {}, number.unit));
    const box = make("div", {class: "number"}, label, slider, field);
    slider.addEventListener("input", () => {
        field.value = slider.value;
        send(number.key, Number(slider.value));
    });
    field.addEventListener("change", () => send(number.key, field.value === "" ? null : Number(field.value)));
    return {box, slider, field, signature: signatureOf(number)};
}

const signatureOf = (number) => `${number.unchanged} ${number.unit} ${number.low} ${number.high}`;

function showNumbers(state) {
    const keys = new Set(state.numbers.map((number) => number.key));
    for (const key of rows.keys()) if (!keys.has(key)) rows.delete(key);
    const active = document.activeElement;
    for (const number of state.numbers) {
        const row = rows.get(number.key);
        if (!row || row.signature !== signatureOf(number)) rows.set(number.key, makeRow(number));
        const {box, slider, field} = rows.get(number.key);
        box.classList.toggle("changed", number.value !== number.unchanged);
        if (slider !== active && !sending.has(number.key)) slider.value = number.value;
        if (field !== active && !sending.has(number.key)) field.value = number.value;
    }
    const boxes = state.numbers.map((number) => rows.get(number.key).box);
    const panel = byId("numbers");
    if (boxes.length !== panel.children.length || boxes.some((box, i) => box !== panel.children[i]))
        panel.replaceChildren(...boxes);
    byId("writing").hidden = state.changes === 0;
    byId("changes").textContent = state.changes === 1 ? "1 number differs from the file" : `${state.changes} numbers differ from the file`;
}

byId("write").addEventListener("click", async () => {
    const response = await post("write");
    if (!response.ok) showProblems([{line: null, text: await response.text()}]);
});

byId("discard").addEventListener("click", () => {
    for (const key of rows.keys()) post("number", {key, value: null});
});

// ---------------------------------------------------------------- curves

const kWidth = 600;
const kHeight = 130;

function svg(tag, attributes) {
    const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
    for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
    return element;
}

const shown = (value) => Number(value.toPrecision(4)).toString().replace("-", "\u2212");

function drawCurves(title, unit, series) {
    const all = series.flatMap(([, values]) => values);
    let low = Math.min(...all), high = Math.max(...all);
    if (!(high > low)) [low, high] = [low - 1, high + 1];
    const x = (t) => t / curves.end * kWidth;
    const y = (value) => kHeight - 4 - (value - low) / (high - low) * (kHeight - 8);
    const picture = svg("svg", {viewBox: `0 0 ${kWidth} ${kHeight}`, preserveAspectRatio: "none", role: "img", "aria-label": title});
    if (low < 0 && high > 0) picture.append(svg("line", {class: "axis", x1: 0, x2: kWidth, y1: y(0), y2: y(0)}));
    series.forEach(([, values], i) => picture.append(svg("path", {
        class: `s${i + 1}`, d: values.map((value, k) => `${k ? "L" : "M"}${x(curves.t[k]).toFixed(1)} ${y(value).toFixed(1)}`).join("")})));
    picture.append(svg("line", {class: "now", x1: 0, x2: 0, y1: 0, y2: kHeight}));
    const seekHere = (event) => {
        if (event.type === "pointermove" && event.buttons === 0) return;
        const box = picture.getBoundingClientRect();
        seek((event.clientX - box.left) / box.width * curves.end / film.frame_s);
    };
    picture.addEventListener("pointerdown", seekHere);
    picture.addEventListener("pointermove", seekHere);
    const names = series.map(([name], i) => make("span", {class: `s${i + 1}`}, name));
    return make("figure", {}, make("figcaption", {}, make("b", {}, `${title} (${unit})`), ...(series.length > 1 ? names : [])), picture,
        make("div", {class: "range"}, make("span", {}, `0 s`), make("span", {}, `${shown(low)} to ${shown(high)}${unit === "°" ? "" : " "}${unit}`), make("span", {}, `${shown(curves.end)} s`)));
}

async function readCurves() {
    const number = film.number;
    const response = await fetch(`curves?film=${number}`);
    if (film.number !== number) return;
    if (response.status === 503) return readCurves();
    if (!response.ok) return;
    curves = await response.json();
    curves.end = Math.max(curves.t[curves.t.length - 1], film.frame_s);
    const total = curves.kinetic_j.map((value, k) => value + curves.potential_j[k]);
    const figures = [];
    if (curves.angle_deg.length > 0) figures.push(drawCurves("Angle of the free end", "°", [["angle", curves.angle_deg]]));
    if (total.every(Number.isFinite) && total.length > 0)
        figures.push(drawCurves("Energy", "J", [["kinetic", curves.kinetic_j], ["potential", curves.potential_j], ["total", total]]));
    byId("curves").replaceChildren(...figures);
    markTime();
}

function markTime() {
    if (!curves) return;
    const x = frame * film.frame_s / curves.end * kWidth;
    for (const line of document.querySelectorAll("#curves .now")) {
        line.setAttribute("x1", x);
        line.setAttribute("x2", x);
    }
}

// ---------------------------------------------------------------- controls

timeline.addEventListener("input", () => seek(Number(timeline.value)));
byId("play").addEventListener("click", () => setPlaying(!playing));
byId("speed").addEventListener("change", () => seek(frame));
byId("side").addEventListener("change", (event) => post("side", {px: Number(event.target.value)}));
document.addEventListener("keydown", (event) => {
    if (!film || event.ctrlKey || event.metaKey || event.altKey || event.target.closest("input, select, button, a")) return;
    const step = event.shiftKey ? 10 : 1;
    const actions = {
        " ": () => setPlaying(!playing),
        ArrowLeft: () => seek(frame - step),
        ArrowRight: () => seek(frame + step),
        Home: () => seek(0),
        End: () => seek(film.frames - 1),
    };
    if (!actions[event.key]) return;
    event.preventDefault();
    actions[event.key]();
});

follow();
