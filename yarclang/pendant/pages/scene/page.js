// The page 3D: the scene, its views, and switches for its bodies.

import { button, h, put } from "/dom.js";
import { VIEWS } from "/scene/eye.js";
import { FIRST, Scene3D } from "/scene/scene.js";

const SWITCHES = [
  ["robot", "Robot"], ["tool", "Tool"], ["part", "Parts"], ["obstacle", "Obstacles"], ["zone", "Zones"], ["shape", "Collision shapes"],
  ["base", "Base frame"], ["tools", "Tool frames"], ["frames", "Cell frames"], ["others", "Other frames"], ["way", "Path"], ["labels", "Names"], ["grid", "Floor"],
];
const ALWAYS = new Set(["way", "labels", "grid"]);

export function scenePage(place, app) {
  const made = picture(app);
  put(place, h("h1", { class: "hidden" }, "3D"), made.element);
  return made.open();
}

// Create a three-dimensional view with its buttons. `open` begins to draw, and returns a function that ends it.
export function picture(app) {
  const view = h("div", { class: "scene-view" });
  const notes = h("p", { class: "scene-notes", role: "status", hidden: true });
  const boxes = h("div", { class: "scene-switches", hidden: true, role: "group", "aria-label": "What is shown" });
  const shows = button("Show", () => toggle(), { class: "scene-show", "aria-expanded": "false" });
  const bar = h("div", { class: "scene-bar" });
  const element = h("div", { class: "scene-frame" }, view, notes, bar, boxes);
  const on = { ...FIRST, ...app.recall("scene") };
  let scene = null;

  function toggle() {
    boxes.hidden = !boxes.hidden;
    shows.setAttribute("aria-expanded", String(!boxes.hidden));
  }

  function look(name) {
    scene.look(name);
    mark(name);
  }

  function mark(name) {
    for (const one of bar.querySelectorAll("[data-view]")) one.setAttribute("aria-pressed", String(one.dataset.view === name));
  }

  function draw(told) {
    const { kinds } = scene.bodies;
    put(boxes, SWITCHES.filter(([kind]) => kinds.has(kind) || ALWAYS.has(kind)).map(([kind, label]) =>
      h("label", {}, h("input", { type: "checkbox", checked: on[kind], onchange: ({ target }) => change(kind, target.checked) }), label)));
    // name what the scene can't show: otherwise it might be taken for free space
    put(notes, told.notes.map((one) => h("span", {}, one)));
    notes.hidden = !told.notes.length;
  }

  function change(kind, shown) {
    on[kind] = shown;
    app.remember("scene", on);
    scene.show({ [kind]: shown });
  }

  function open() {
    scene = new Scene3D(view, app);
    scene.show(on);
    put(bar, VIEWS.map(([name, label]) => button(label, () => look(name), { "data-view": name, "aria-pressed": String(name === "iso") })), shows);
    view.addEventListener("drawn", ({ detail }) => draw(detail));
    view.addEventListener("pointerdown", () => scene.eye?.view !== "tool" && mark(""));
    bar.hidden = Boolean(scene.failed);
    return () => scene.close();
  }

  return { element, open, get scene() { return scene; } };
}

// Show a three-dimensional view beside another page, if the screen is wide enough. Return a function that ends it.
export function beside(place, app) {
  const wide = matchMedia("(min-width: 1100px)");
  let end = null;
  const fit = () => {
    if (wide.matches && !end) {
      const made = picture(app);
      put(place, made.element);
      end = made.open();
    } else if (!wide.matches && end) {
      end();
      end = null;
      put(place);
    }
    place.hidden = !wide.matches;
  };
  wide.addEventListener("change", fit);
  fit();
  return () => {
    wide.removeEventListener("change", fit);
    end?.();
  };
}
