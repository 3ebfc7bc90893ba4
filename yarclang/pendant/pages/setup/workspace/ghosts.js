// Bodies of the draft in the scene, beside the bodies of the file. The chosen body can be dragged by its handles.

import {
  BoxGeometry, CapsuleGeometry, CylinderGeometry, DoubleSide, EdgesGeometry, Euler, Group, LineBasicMaterial, LineSegments, Matrix4, Mesh,
  MeshLambertMaterial, PlaneGeometry, Quaternion, SphereGeometry, TransformControls, Vector3,
} from "/bundles/three.js";
import { matrix } from "/scene/bodies.js";
import { isChanged } from "/setup/workspace/draft.js";

const STEP = 0.001; // step of a drag [m]
const TURN = Math.PI / 180; // step of a rotation [rad]
const REACH = 110; // length of the handles [px]; their touch areas are then at least 44 px wide
const WIDE = 3; // edge of the square that is drawn for a half-space [m]
const HUES = { obstacles: 0xd98b00, allowed: 0x2f9e44, forbidden: 0xd83a3a, slow: 0xd98b00, posture: 0x2f6fde };

export class Ghosts {
  // `began()` is called before a drag, `dragged(key, values)` during it.
  constructor(scene, draft, { began, dragged }) {
    Object.assign(this, { scene, draft, began, dragged, drawn: new Map(), chosen: null, mode: "translate" });
    const { camera } = scene.eye;
    this.handles = new TransformControls(camera, scene.painter.canvas);
    this.handles.setSpace("local");
    this.handles.setTranslationSnap(STEP);
    this.handles.setRotationSnap(TURN);
    this.handles.addEventListener("change", () => scene.invalidate());
    this.handles.addEventListener("dragging-changed", ({ value }) => this.drag(value));
    this.handles.addEventListener("objectChange", () => this.follow());
    scene.painter.scene.add(this.handles.getHelper());
    this.sizes = new ResizeObserver(() => this.fit());
    this.sizes.observe(scene.element);
    this.fit();
  }

  // Give the handles the same size on every screen.
  fit() {
    const unit = ((this.scene.element.clientHeight || 400) * 1.9) / 8; // pixels per unit of the handles; an arrow is half a unit long
    this.handles.setSize(Math.min(4, Math.max(0.4, (2 * REACH) / unit)));
    this.scene.invalidate();
  }

  drag(value) {
    const { controls, view } = this.scene.eye;
    controls.enabled = !value && view !== "tool";
    this.scene.eye.touched = true;
    this.held = value;
    if (value) this.began();
  }

  // Update the entry's values from the dragged body.
  follow() {
    const one = this.drawn.get(this.chosen);
    const item = this.draft.item(this.chosen);
    if (!this.held || !one || !item) return;
    const { position, quaternion } = one.body;
    const values = {};
    if (this.mode === "translate") {
      const before = item.values.xyz ?? [0, 0, 0];
      values.xyz = position.toArray().map((value, at) => near(value, before[at] * item.metre, 1e-6) ? before[at] : rounded(value / item.metre, 1e-5 / item.metre));
    } else {
      const turned = new Euler().setFromQuaternion(quaternion, "ZYX");
      values.rpy = [turned.x, turned.y, turned.z].map((value) => rounded(value / item.radian, 1e-4 * (TURN / item.radian)));
      values.quat = undefined;
    }
    this.dragged(this.chosen, values);
  }

  choose(key, mode = this.mode) {
    this.chosen = key;
    this.mode = mode;
    this.draw();
  }

  // Draw the bodies that differ from the file, and the chosen body.
  draw() {
    const wanted = new Map(this.draft.items.filter((one) => !one.gone && (isChanged(one) || one.key === this.chosen)).map((one) => [one.key, one]));
    for (const [key, one] of this.drawn) if (!wanted.has(key)) this.drop(key, one);
    for (const [key, item] of wanted) this.drawOne(key, item);
    const one = this.drawn.get(this.chosen);
    const item = one && this.draft.item(this.chosen);
    const can = one && this.may && item.metre && (this.mode === "translate" || (item.radian && item.values.shape !== "half-space"));
    if (can) {
      this.handles.setMode(this.mode);
      if (this.handles.object !== one.body) this.handles.attach(one.body);
    } else this.handles.detach();
    this.scene.invalidate();
  }

  drawOne(key, item) {
    const form = JSON.stringify([item.values.shape, item.values.size, item.values.radius, item.values.length, item.values.frame, item.values.rule, item.metre]);
    let one = this.drawn.get(key);
    if (one && one.form !== form) {
      this.drop(key, one);
      one = null;
    }
    if (!one) {
      const place = this.placeOf(item);
      const made = place && bodyOf(item, this.meshOf(item));
      if (!made) return;
      place.add(made.body);
      one = { ...made, place, form };
      this.drawn.set(key, one);
    }
    if (!(this.held && key === this.chosen)) pose(one.body, item);
  }

  // Return a group at the entry's frame: stationary, or attached to the flange. Its children use the frame's
  // coordinates.
  placeOf({ values, metre }) {
    const frame = this.draft.told.frames.find(({ name }) => name === String(values.frame).toUpperCase());
    if (!frame || !metre) return null;
    const place = new Group();
    const rows = matrix(frame.pose);
    const { told, bodies } = this.scene;
    const flange = told?.axes.find(({ name }) => name === "FLANGE");
    if (frame.on_flange && !flange) return null;
    const whole = frame.on_flange ? new Matrix4().multiplyMatrices(matrix(flange.pose), rows) : rows;
    whole.decompose(place.position, place.quaternion, place.scale);
    (frame.on_flange ? bodies.groups[flange.joint] : this.scene.painter.scene).add(place);
    return place;
  }

  meshOf({ base }) {
    return this.scene.bodies.items.find(({ item }) => base && item.name === String(base.name).toUpperCase())?.mesh.geometry;
  }

  drop(key, { body, place, materials, geometries }) {
    if (this.handles.object === body) this.handles.detach();
    place.removeFromParent();
    for (const one of [...materials, ...geometries]) one.dispose();
    this.drawn.delete(key);
  }

  close() {
    this.sizes.disconnect();
    for (const [key, one] of this.drawn) this.drop(key, one);
    this.handles.detach();
    this.handles.getHelper().removeFromParent();
    this.handles.dispose();
  }
}

function bodyOf({ table, values, metre }, mesh) {
  const shape = geometryOf(values, metre, mesh);
  if (!shape) return null;
  const hue = HUES[table === "zones" ? values.rule : table] ?? HUES.obstacles;
  const skin = new MeshLambertMaterial({ color: hue, transparent: true, opacity: 0.35, depthWrite: false, side: DoubleSide });
  const line = new LineBasicMaterial({ color: hue });
  const edges = new EdgesGeometry(shape, 30);
  const body = new Mesh(shape, skin);
  body.renderOrder = 5;
  body.add(new LineSegments(edges, line));
  return { body, materials: [skin, line], geometries: [edges, ...(shape === mesh ? [] : [shape])] };
}

function geometryOf({ shape, size, radius, length }, metre, mesh) {
  const up = (made) => made.rotateX(Math.PI / 2); // cylinders of three.js are along y
  const sound = (value) => typeof value === "number" && value > 0 && value * metre < 1e3;
  if (shape === "box" && size?.length === 3 && size.every(sound)) return new BoxGeometry(...size.map((one) => one * metre));
  if (shape === "half-space") return new PlaneGeometry(WIDE, WIDE, 6, 6);
  if (shape === "mesh") return mesh ?? null;
  if (!sound(radius)) return null;
  if (shape === "sphere") return new SphereGeometry(radius * metre, 32, 20);
  if (!sound(length)) return null;
  if (shape === "cylinder") return up(new CylinderGeometry(radius * metre, radius * metre, length * metre, 32));
  return shape === "capsule" ? up(new CapsuleGeometry(radius * metre, length * metre, 8, 24)) : null;
}

function pose(body, { values, metre, radian }) {
  body.position.fromArray((values.xyz ?? [0, 0, 0]).map((one) => one * metre));
  if (values.shape === "half-space") body.quaternion.setFromUnitVectors(new Vector3(0, 0, 1), new Vector3(...(values.normal ?? [0, 0, 1])).normalize());
  else if (values.quat) body.quaternion.copy(new Quaternion(...values.quat).normalize());
  else body.setRotationFromEuler(new Euler(...(values.rpy ?? [0, 0, 0]).map((one) => one * (radian ?? 0)), "ZYX"));
}

function near(a, b, by) {
  return Math.abs(a - b) <= by;
}

function rounded(value, step) {
  return Number((Math.round(value / step) * step).toFixed(6));
}
