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

const kBitmapBytes = 256 * 2 ** 20;
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

/// How many bitmaps are kept: as many as have room, and a few of the largest.
const mostBitmaps = () => Math.max(4, Math.floor(kBitmapBytes / (4 * film.width * film.height)));

function drop(bitmap) {
    bitmap.then((its) => its.close(), () => {});
}

function dropAll() {
    for (const bitmap of bitmaps.values()) drop(bitmap);
    bitmaps = new Map();
}

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
    for (const other of bitmaps.keys()) {
        if (bitmaps.size <= mostBitmaps()) break;
        if (other === frame || other === k) continue;
        drop(bitmaps.get(other));
        bitmaps.delete(other);
    }
    return bitmap;
}

async function show(k) {
    frame = k;
    timeline.value = k;
    const number = film.number;
    byId("time").textContent = `${(k * film.frame_s).toFixed(2)} s, frame ${k}`;
    byId("download").href = `still/${k}.png?film=${number}`;
    byId("download").download = `${film.name}_${Number((k * film.frame_s).toFixed(6))}s.png`;
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
        if (error.message && !(error instanceof TypeError || error instanceof DOMException)) showProblems([{line: null, text: error.message}]);
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
    for (let ahead = 1; ahead <= Math.min(8, mostBitmaps() - 2); ++ahead) bitmapOf((frame + ahead) % film.frames);
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
    else status.textContent = `${state.film.full.join(" x ")}, ${state.film.frames} frames at ${Number(state.film.fps.toFixed(3))} per second`;
}

function take(state) {
    version = state.version;
    if (state.film && (!film || film.number !== state.film.number)) takeFilm(state.film);  // first, to ask for its picture
    document.title = `${state.film ? state.film.name : state.file} - corda watch`;
    byId("name").textContent = state.file.slice(state.file.lastIndexOf("/") + 1);
    byId("name").title = state.file;
    showStatus(state);
    if (!state.busy) showProblems(state.problems);
    showNumbers(state);
    showRender(state.render);
    showSide(state.side);
}

function takeFilm(next) {
    film = next;
    dropAll();
    drawn = -1;
    timeline.max = film.frames - 1;
    byId("plan").replaceChildren(...film.plan.map((line) => make("li", {}, line)));
    seek(Math.min(frame, film.frames - 1));
    readCurves();
}

const sleep = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

/// Asks for the state again and again, and not at all while nobody sees the page: pages share the few
/// connections that a browser opens to a program. An answer comes at the next change, or soon without one.
async function follow() {
    for (;;) {
        if (document.hidden) await new Promise((resolve) => document.addEventListener("visibilitychange", resolve, {once: true}));
        let wait = 0;
        try {
            const response = await fetch(`state?after=${version}`);
            if (response.status === 200) take(await response.json());
            else if (!response.ok) throw new Error("it runs at another address now; open the one that it has printed");
        } catch (error) {
            // The program has ended. It may be started again at this address.
            const isOther = !(error instanceof TypeError);
            byId("status").textContent = isOther ? error.message : "corda watch has ended; this page waits for the next one";
            byId("status").classList.add("bad");
            version = 0;
            wait = 1000;
        }
        if (wait > 0) await sleep(wait);
    }
}

// ---------------------------------------------------------------- size

let fits = true;  // the size follows the room that the page has

function showSide(side) {
    fits = side.fits;
    const select = byId("side");
    const value = fits ? "fit" : String(side.px);
    if (![...select.options].some((option) => option.value === value)) select.append(make("option", {value}, `${side.px} px`));
    if (document.activeElement !== select) select.value = value;
    if (!film) return;
    const [width, height] = film.full;
    canvas.style.aspectRatio = `${width} / ${height}`;
    canvas.style.maxWidth = `min(100%, ${75 * width / height}vh${fits ? "" : `, ${film.width}px`})`;
    if (fits) fit();
}

/// Asks for pictures as large as the page shows them, in steps, so that a window that is resized asks seldom.
function fit() {
    if (!film || document.hidden) return;
    const [width, height] = film.full;
    const room = Math.min(byId("stage").clientWidth, 0.75 * innerHeight * width / height) * Math.max(1, width <= height ? height / width : 1);
    const px = Math.max(160, 64 * Math.ceil(room * devicePixelRatio / 64));
    const most = Math.max(width, height);
    if (Math.min(px, most) !== Math.max(film.width, film.height) && fit.asked !== px) {
        fit.asked = px;
        post("side", {px, fits: true}).catch(() => { fit.asked = 0; });
    }
}

document.addEventListener("visibilitychange", () => { fit.asked = 0; if (fits) fit(); });
globalThis.onresize = () => {
    if (fits) fit();
    showCurves();
};

// ---------------------------------------------------------------- video

let isRunning = false;  // a render is

function showRender(render) {
    isRunning = render !== null && render.is_running;
    byId("rendering").hidden = !isRunning;
    byId("render").textContent = isRunning ? "Stop" : "Render";
    byId("ending").disabled = isRunning;
    if (render === null) return;
    byId("rendering").value = render.progress;
    byId("rendered").textContent = isRunning ? `${Math.round(100 * render.progress)} % of ${render.path}` : `${render.path}: ${render.text}`;
}

byId("render").addEventListener("click", async () => {
    if (isRunning) return post("stop");
    const ending = byId("ending").value;
    let response = await post("render", {ending});
    if (response.status === 409 && response.headers.get("content-type").startsWith("application/json")) {
        if (!confirm(`${(await response.json()).exists} exists. Replace it?`)) return;
        response = await post("render", {ending, force: true});
    }
    if (!response.ok) byId("rendered").textContent = await response.text();
});

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

/// The ends and the step of a slider: around the number of the scene, within the range of the key. The steps
/// are counted from the number, so that it is always one of them.
function extentOf(number, value = number.unchanged) {
    const size = Math.abs(value);
    const most = Math.max(number.low, -1e300), least = Math.min(number.high, 1e300);
    let [low, high] = value > 0 ? [0, 3 * size] : value < 0 ? [-3 * size, 3 * size] : [-1, 1];
    if (number.unit === "degrees" && (size >= 1 || size === 0)) [low, high] = [Math.min(-180, 180 * Math.floor(value / 180)), Math.max(180, 180 * Math.ceil(value / 180))];
    if (number.is_integer) high = Math.max(high, low + 10);
    low = Math.max(low, most);
    high = Math.min(high, least);
    let exponent = number.is_integer ? 0 : Math.floor(Math.log10((high - low) / 200));
    // A step that the number itself is a multiple of, if there is one that is not too small.
    const isMultiple = () => Math.abs(value / 10 ** exponent - Math.round(value / 10 ** exponent)) < 1e-6;
    if (!number.is_integer) for (let finer = 0; finer < 2 && !isMultiple(); ++finer) --exponent;
    const step = 10 ** exponent;
    const digits = (its) => Math.abs(its) < 1e-6 * step ? 0 : Number(its.toPrecision(12));
    const at = (end) => digits(value + Math.sign(end - value) * step * Math.floor(Math.abs(end - value) / step + 1e-6));
    low = at(low);
    if (low < number.low || (number.low_open && low === number.low)) low = digits(low + step);
    return {low, high: at(high), step: digits(step)};
}

/// Shows a value on its slider, which is made to have it if it does not.
function place(slider, number) {
    slider.value = number.value;
    if (Math.abs(Number(slider.value) - number.value) <= 1e-9 * Math.abs(number.value)) return;
    const {low, high, step} = extentOf(number, number.value);
    Object.assign(slider, {min: low, max: high, step});
    slider.value = number.value;
}

function makeRow(number) {
    const {low, high, step} = extentOf(number);
    const id = `number-${rows.size}`;
    const slider = make("input", {type: "range", id, min: low, max: high, step});
    const field = make("input", {type: "number", step: "any", "aria-label": `${number.key}, exact`});
    const label = make("label", {for: id, title: number.meaning}, number.key, " ", make("small", {}, number.unit));
    const box = make("div", {class: "number"}, label, slider, field);
    slider.addEventListener("pointerup", () => slider.blur());  // so that keys go to the film again
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
        if (slider !== active && !sending.has(number.key)) place(slider, number);
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

const kHeight = 170;
const kLeft = 52, kRight = 10, kTop = 8, kBottom = 34;  // room for numbers and units

function svg(tag, attributes, text = "") {
    const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
    for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
    element.textContent = text;
    return element;
}

const shown = (value) => Number(value.toPrecision(4)).toString().replace("-", "\u2212");

/// The multiples of 1, 2 or 5 times a power of ten within a range: `count` at most.
function ticksOf(low, high, count) {
    const power = 10 ** Math.floor(Math.log10((high - low) / count));
    const step = power * [1, 2, 5, 10].find((factor) => factor * power * count >= high - low);
    const ticks = [];
    for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k) ticks.push(k * step);
    return ticks;
}

function drawCurves({title, unit, series}, width) {
    const all = series.flatMap(([, values]) => values);
    let low = Math.min(...all), high = Math.max(...all);
    if (!(high > low)) [low, high] = [low - 1, high + 1];
    const x = (t) => kLeft + t / curves.end * (width - kLeft - kRight);
    const y = (value) => kTop + (high - value) / (high - low) * (kHeight - kTop - kBottom);
    const picture = svg("svg", {width, height: kHeight, role: "img", "aria-label": `${title} in ${unit} over time`});
    for (const value of ticksOf(low, high, 4)) {
        picture.append(svg("line", {class: "axis", x1: kLeft, x2: width - kRight, y1: y(value), y2: y(value)}),
            svg("text", {x: kLeft - 6, y: y(value) + 4, "text-anchor": "end"}, shown(value)));
    }
    for (const t of ticksOf(0, curves.end, Math.max(2, Math.floor(width / 90)))) {
        picture.append(svg("line", {class: "axis", x1: x(t), x2: x(t), y1: kTop, y2: kHeight - kBottom}),
            svg("text", {x: x(t), y: kHeight - kBottom + 14, "text-anchor": "middle"}, shown(t)));
    }
    picture.append(svg("text", {x: (kLeft + width - kRight) / 2, y: kHeight - 3, "text-anchor": "middle"}, "time in s"));
    series.forEach(([, values], i) => picture.append(svg("path", {
        class: `s${i + 1}`, d: values.map((value, k) => `${k ? "L" : "M"}${x(curves.t[k]).toFixed(1)} ${y(value).toFixed(1)}`).join("")})));
    picture.append(svg("line", {class: "now", y1: kTop, y2: kHeight - kBottom}));
    picture.xOf = x;
    const seekHere = (event) => {
        if (event.type === "pointermove" && event.buttons === 0) return;
        const box = picture.getBoundingClientRect();
        seek((event.clientX - box.left - kLeft) / (width - kLeft - kRight) * curves.end / film.frame_s);
    };
    picture.addEventListener("pointerdown", seekHere);
    picture.addEventListener("pointermove", seekHere);
    const names = series.map(([name], i) => make("span", {class: `s${i + 1}`}, name));
    return make("figure", {}, make("figcaption", {}, make("b", {}, `${title} in ${unit}`), ...(series.length > 1 ? names : [])), picture);
}

function showCurves() {
    if (!curves) return;
    const total = curves.kinetic_j.map((value, k) => value + curves.potential_j[k]);
    const plots = [];
    if (curves.angle_deg.length > 0) plots.push({title: "Angle of the free end", unit: "degrees", series: [["angle", curves.angle_deg]]});
    if (total.every(Number.isFinite) && total.length > 0)
        plots.push({title: "Energy", unit: "J", series: [["kinetic", curves.kinetic_j], ["potential", curves.potential_j], ["total", total]]});
    const panel = byId("curves");
    panel.replaceChildren(...plots.map(() => make("figure")));  // for the widths that they get
    const widths = [...panel.children].map((figure) => Math.max(160, figure.clientWidth - 26));
    panel.replaceChildren(...plots.map((plot, i) => drawCurves(plot, widths[i])));
    markTime();
}

async function readCurves() {
    const number = film.number;
    const response = await fetch(`curves?film=${number}`);
    if (film.number !== number) return;
    if (response.status === 503) return readCurves();
    if (!response.ok) return;
    curves = await response.json();
    curves.end = Math.max(curves.t[curves.t.length - 1], film.frame_s);
    showCurves();
}

function markTime() {
    for (const picture of document.querySelectorAll("#curves svg")) {
        const x = picture.xOf(frame * film.frame_s);
        const line = picture.querySelector(".now");
        line.setAttribute("x1", x);
        line.setAttribute("x2", x);
    }
}

// ---------------------------------------------------------------- controls

timeline.addEventListener("input", () => seek(Number(timeline.value)));
byId("play").addEventListener("click", () => setPlaying(!playing));
byId("speed").addEventListener("change", () => seek(frame));
byId("side").addEventListener("change", (event) => {
    fits = event.target.value === "fit";
    fit.asked = 0;
    post("side", {px: fits ? Math.max(film.width, film.height) : Number(event.target.value), fits});
});
for (const select of document.querySelectorAll("select")) select.addEventListener("change", () => select.blur());
document.addEventListener("keydown", (event) => {
    if (!film || event.ctrlKey || event.metaKey || event.altKey) return;
    const target = event.target;
    // A field takes all keys, a slider that the Tab key has chosen its own, and a button or link the space bar.
    if (target.type === "number" || (target.type === "range" && target !== timeline && event.key !== " ")) return;
    if (event.key === " " && target.closest("button, a, select")) return;
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
