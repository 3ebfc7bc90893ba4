// Labels with names in the scene: HTML texts over the canvas. No two of them overlap.

import { Quaternion, Vector3 } from "/bundles/three.js";
import { h, text } from "/dom.js";

const CHARACTER = 7.6; // width of a character [px]
const HIGH = 19;
const SPOT = 0.06; // frames that are nearer together than this share one label [m]

export class Labels {
  constructor(element) {
    this.layer = h("div", { class: "scene-labels", "aria-hidden": "true" });
    element.append(this.layer);
    this.labels = [];
    this.at = new Vector3();
  }

  // Set the labels: [{text, object, offset, kind, weight}]. Labels with a larger weight take precedence. Existing
  // elements are reused.
  set(wanted) {
    const sorted = [...wanted].sort((a, b) => b.weight - a.weight);
    while (this.labels.length > sorted.length) this.labels.pop().element.remove();
    sorted.forEach((one, number) => {
      this.labels[number] ??= { element: this.layer.appendChild(h("span", {})) };
      const label = Object.assign(this.labels[number], one, { wide: CHARACTER * one.text.length + 12 });
      text(label.element, one.text);
      label.element.className = `label3d ${one.kind}`;
    });
  }

  // Place each label at its body, if there is room. Return the number of visible labels.
  place(camera, width, height) {
    const taken = [];
    for (const label of this.labels) {
      this.at.copy(label.offset);
      label.object.localToWorld(this.at);
      this.at.project(camera);
      const x = (this.at.x * 0.5 + 0.5) * width - label.wide / 2;
      const y = (0.5 - this.at.y * 0.5) * height - HIGH - 4;
      const seen = this.at.z < 1 && x > -label.wide / 2 && x + label.wide / 2 < width && y > 0 && y + HIGH < height;
      const box = [x, y, x + label.wide, y + HIGH];
      const free = seen && shown(label.object) && !taken.some((other) => box[0] < other[2] && other[0] < box[2] && box[1] < other[3] && other[1] < box[3]);
      if (label.element.hidden === free) label.element.hidden = !free;
      if (!free) continue;
      taken.push(box);
      const left = Math.min(Math.max(x, 2), Math.max(width - label.wide - 2, 2));
      label.element.style.transform = `translate(${left.toFixed(0)}px, ${y.toFixed(0)}px)`;
    }
    return taken.length;
  }

  show(on) {
    this.layer.hidden = !on;
  }

  close() {
    this.layer.remove();
    this.labels = [];
  }
}

function shown(object) {
  for (let one = object; one; one = one.parent) if (!one.visible) return false;
  return true;
}

// Return the labels of a scene: frames, bodies with a visible name, and highlighted bodies. `tool` is the followed
// frame; `chosen` are the frames for jogging and display, which are marked.
export function namesOf(bodies, tool, lit, chosen) {
  const seen = new Set();
  const wanted = bodies.items.filter(({ item, mesh }) => mesh.visible && (item.named || lit.has(item.name)) && item.kind !== "shape" && !seen.has(item.name) && seen.add(item.name));
  const named = wanted.map((one) => [one.item, bodies.standsFor(one)]).map(([item, mesh]) => ({
    text: item.name, object: mesh, offset: top(mesh), kind: lit.has(item.name) ? "lit" : item.kind, weight: lit.has(item.name) ? 9 : item.kind === "part" ? 3 : 1.5,
  }));
  return [...spots(bodies.triads, tool, chosen), ...named];
}

// Return the labels of frames. Frames at the same place share one label.
function spots(triads, tool, chosen) {
  const found = [];
  const first = triads.filter(({ group }) => group.visible).sort((a, b) => (b.axes.name === tool) - (a.axes.name === tool));
  for (const { axes, group } of first) {
    const near = found.find(({ joint, object }) => joint === axes.joint && object.position.distanceTo(group.position) < SPOT);
    const name = `{${axes.name}}`;
    const one = near ?? { text: name, object: group, offset: new Vector3(), kind: "frame", weight: axes.name === tool ? 4 : axes.name === "FLANGE" ? 0.5 : 2, joint: axes.joint };
    if (near) near.text += ` ${name}`;
    else found.push(one);
    if (chosen.has(name)) Object.assign(one, { kind: "frame chosen", weight: 5 });
  }
  return found;
}

// Return the highest point above the middle of a body, in the body's own frame.
function top(mesh) {
  const box = mesh.geometry.boundingBox;
  const middle = box.getCenter(new Vector3());
  const up = new Vector3(0, 0, 1).applyQuaternion(new Quaternion().copy(mesh.quaternion).invert());
  const size = box.getSize(new Vector3());
  return middle.addScaledVector(up, (Math.abs(up.x) * size.x + Math.abs(up.y) * size.y + Math.abs(up.z) * size.z) / 2);
}
