"use strict";

const byId = (id) => document.getElementById(id);
const views = ["Side by side", "Difference", "Blink", "Slider", "Onion skin"];

let pictures = [];
let at = 0;                 // index of the picture that is shown
let view = 0;               // index in views
let blinking = 0;           // timer

function make(tag, attributes = {}, ...children) {
    const element = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
    element.append(...children);
    return element;
}

const post = (path, body = {}) => fetch(path, {method: "POST", body: JSON.stringify(body)});
const stateOf = (picture) => picture.accepted ? "written" : picture.mark || "open";

/// The server keeps marks, so that a page that is opened again has them.
function mark(marked, choice) {
    for (const picture of marked) picture.mark = choice;
    post("mark", {marks: Object.fromEntries(marked.map((picture) => [picture.name, choice]))})
        .catch(() => { byId("outcome").textContent = "the program has ended; this mark is not kept"; });
}

// ---------------------------------------------------------------- the list

function showGroups() {
    const groups = new Map();
    pictures.forEach((picture, i) => {
        if (!groups.has(picture.group)) groups.set(picture.group, []);
        groups.get(picture.group).push(i);
    });
    byId("list").replaceChildren(...[...groups].map(([group, members]) => make("section", {}, make("h2", {}, group),
        make("ol", {}, ...members.map((i) => {
            const button = make("button", {type: "button", class: stateOf(pictures[i]), ...(i === at ? {"aria-current": "true"} : {})},
                make("span", {}, pictures[i].name), make("small", {}, stateOf(pictures[i])));
            button.addEventListener("click", () => show(i));
            return make("li", {}, button);
        })))));
    const chosen = pictures.filter((picture) => stateOf(picture) === "accept").length;
    const open = pictures.filter((picture) => stateOf(picture) === "open").length;
    byId("status").textContent = pictures.length === 0 ? "all pictures passed" : `${pictures.length} failed, ${open} open`;
    byId("apply").disabled = chosen === 0;
    byId("apply").textContent = chosen === 1 ? "Apply: write 1 picture" : `Apply: write ${chosen} pictures`;
    const current = document.querySelector("#list [aria-current]");
    if (current) current.scrollIntoView({block: "nearest"});
}

// ---------------------------------------------------------------- the picture

function image(kind, caption) {
    return make("figure", {class: kind}, make("img", {src: `picture/${at}/${kind}.png`, alt: `${pictures[at].name}: ${caption}`}),
        make("figcaption", {}, caption));
}

function showPair() {
    clearInterval(blinking);
    const {has_reference: hasReference, has_new: hasNew} = pictures[at];
    const pair = byId("pair");
    const isPair = hasReference && hasNew;
    const shown = isPair ? view : 0;
    pair.className = ["beside", "single", "stack blink", "stack slider", "stack onion"][shown];
    const parts = [];
    if (shown === 1) {
        parts.push(image("difference", "sixteen times the difference"));
    } else {
        if (hasReference) parts.push(image("reference", "reference"));
        if (hasNew) parts.push(image("new", "new"));
    }
    pair.replaceChildren(...parts);
    byId("opacity").hidden = shown < 3;
    byId("modes").replaceChildren(...views.map((name, i) => {
        const button = make("button", {type: "button", role: "radio", "aria-checked": String(i === shown)}, name);
        button.disabled = !isPair;
        button.addEventListener("click", () => setView(i));
        return button;
    }));
    if (shown === 2) blinking = setInterval(() => pair.classList.toggle("is-new"), 500);
    mix();
}

function mix() {
    byId("pair").style.setProperty("--mix", `${byId("mix").value}%`);
}

function setView(i) {
    view = i;
    showPair();
}

function show(i) {
    if (pictures.length === 0) return showGroups();
    at = Math.max(0, Math.min(pictures.length - 1, i));
    const picture = pictures[at];
    byId("title").textContent = `${picture.name}: ${picture.result}`;
    byId("cause").textContent = [picture.figures, picture.cause].filter(Boolean).join("; ");
    byId("accept").disabled = byId("accept-all").disabled = !picture.has_new;
    showPair();
    showGroups();
}

// ---------------------------------------------------------------- decisions

function choose(choice) {
    const picture = pictures[at];
    if (picture.accepted || (choice === "accept" && !picture.has_new)) return;
    mark([picture], picture.mark === choice ? "" : choice);
    show(at + (picture.mark && at + 1 < pictures.length ? 1 : 0));
}

function chooseAll() {
    const {group} = pictures[at];
    mark(pictures.filter((picture) => picture.group === group && picture.has_new && !picture.accepted), "accept");
    showGroups();
}

async function apply() {
    delete byId("end").dataset.asked;
    const accept = pictures.filter((picture) => stateOf(picture) === "accept").map((picture) => picture.name);
    byId("apply").disabled = true;
    const response = await post("apply", {accept});
    const outcome = response.ok ? `${(await response.json()).changed} written` : await response.text();
    await load();
    byId("outcome").textContent = outcome;
}

async function end() {
    const marked = pictures.filter((picture) => stateOf(picture) === "accept").length;
    if (marked > 0 && !byId("end").dataset.asked) {
        byId("end").dataset.asked = "yes";
        byId("outcome").textContent = `${marked} accepted ${marked === 1 ? "picture is" : "pictures are"} not written: Apply writes, Finish ends without`;
        return;
    }
    await post("end").catch(() => {});  // the program may end before it has answered
    byId("status").textContent = "the review has ended";
    for (const button of document.querySelectorAll("button")) button.disabled = true;
}

byId("accept").addEventListener("click", () => choose("accept"));
byId("reject").addEventListener("click", () => choose("reject"));
byId("accept-all").addEventListener("click", chooseAll);
byId("apply").addEventListener("click", apply);
byId("end").addEventListener("click", end);
byId("mix").addEventListener("input", mix);
byId("mix").addEventListener("pointerup", () => byId("mix").blur());  // so that keys go to the page again
document.addEventListener("keydown", (event) => {
    if (pictures.length === 0 || event.ctrlKey || event.metaKey || event.altKey || event.target.closest("input")) return;
    const actions = {
        ArrowDown: () => show(at + 1), ArrowRight: () => show(at + 1),
        ArrowUp: () => show(at - 1), ArrowLeft: () => show(at - 1),
        a: () => choose("accept"), r: () => choose("reject"), A: chooseAll,
    };
    const action = actions[event.key] || (views[event.key - 1] && (() => setView(event.key - 1)));
    if (!action) return;
    event.preventDefault();
    action();
});

async function load() {
    pictures = await (await fetch("pictures")).json();
    show(at);
}

load();
