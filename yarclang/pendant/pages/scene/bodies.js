// The bodies and frames of the scene. They are created once from the server's description; afterwards only the groups
// that joints move are updated.

import {
  Color, CylinderGeometry, DoubleSide, EdgesGeometry, FrontSide, Group, LineBasicMaterial, LineSegments, Matrix4, Mesh, MeshBasicMaterial,
  MeshLambertMaterial, Quaternion, SRGBColorSpace, Vector3,
} from "/bundles/three.js";
import { geometry } from "/scene/load.js";

const LENGTH = 0.12; // length of a frame's axes, as drawn [m]
const AXES = [[0xd83a3a, [0, 0, -Math.PI / 2]], [0x2f9e44, [0, 0, 0]], [0x2f6fde, [Math.PI / 2, 0, 0]]];
const MOST_EDGED = 3000; // largest number of triangles of a body whose edges are drawn
const AT_ONCE = 6; // number of meshes that are requested at the same time

export function colour([red, green, blue]) {
  return new Color().setRGB(red / 255, green / 255, blue / 255, SRGBColorSpace);
}

export function matrix(rows) {
  return new Matrix4().set(...rows, 0, 0, 0, 1);
}

// Return the switch that shows and hides a frame.
function switchOf(axes) {
  if (!axes.matters) return "others";
  if (axes.joint > 0) return "tools";
  return axes.name === "B" ? "base" : "frames";
}

export class Bodies {
  constructor(scene) {
    this.scene = scene;
    this.geometries = new Map(); // mesh id: promise of its geometry
    this.materials = new Set();
    this.groups = [];
    this.ghosts = [];
    this.items = []; // bodies: {item, mesh, material}
    this.triads = []; // frames: {axes, group}
    this.on = {};
    this.time = null;
    this.ghosted = false;
    this.marked = new Set();
    this.axis = new CylinderGeometry(LENGTH / 32, LENGTH / 32, LENGTH, 8).translate(0, LENGTH / 2, 0);
    this.axisMaterials = AXES.map(([hue]) => this.keep(new MeshBasicMaterial({ color: hue })));
  }

  keep(material) {
    this.materials.add(material);
    return material;
  }

  // Create the described bodies and frames. Meshes that are already loaded are reused.
  async draw(told) {
    const ids = [...new Set(told.items.map(({ mesh }) => mesh))];
    const found = new Map();
    for (let begin = 0; begin < ids.length; begin += AT_ONCE) {
      const some = ids.slice(begin, begin + AT_ONCE);
      const loaded = await Promise.all(some.map((id) => this.loaded(id)));
      some.forEach((id, number) => found.set(id, loaded[number]));
    }
    if (this.closed) return;
    if (this.told?.joints.length !== told.joints.length) this.begin(told);
    this.told = told;
    const wanted = new Map(told.items.map((item, number) => [`${JSON.stringify(item)} ${number}`, item]));
    const here = new Map(this.items.map((one) => [one.key, one]));
    for (const one of this.items) if (!wanted.has(one.key)) this.drop(one);
    this.items = [...wanted].map(([key, item]) => here.get(key) ?? this.addItem(key, item, found.get(item.mesh)));
    for (const { group } of this.triads) group.removeFromParent();
    this.triads = told.axes.map((axes) => this.addAxes(axes));
    for (const [id, asked] of this.geometries) if (!found.has(id)) this.forget(id, asked);
  }

  begin(told) {
    this.clear();
    for (let joint = 0; joint <= told.joints.length; joint += 1) {
      this.groups.push(this.addGroup(true));
      this.ghosts.push(this.addGroup(false));
    }
    this.ghostMaterial ??= this.keep(new MeshLambertMaterial({ color: colour(told.ghost), transparent: true, opacity: 0.38 }));
    this.litMaterial ??= this.keep(new MeshLambertMaterial({ color: colour(told.touching), transparent: true, opacity: 0.75 }));
  }

  loaded(id) {
    if (!this.geometries.has(id)) {
      const asked = geometry(id);
      this.geometries.set(id, asked);
      asked.catch(() => this.geometries.delete(id));
    }
    return this.geometries.get(id);
  }

  addGroup(visible) {
    const made = new Group();
    made.visible = visible;
    made.matrixAutoUpdate = false;
    this.scene.add(made);
    return made;
  }

  addItem(key, item, shape) {
    const clear = item.opacity < 1;
    const zone = item.kind === "zone";
    const material = this.keep(new MeshLambertMaterial({
      color: colour(item.colour), transparent: clear, opacity: item.opacity, depthWrite: !clear, side: clear ? DoubleSide : FrontSide,
    }));
    const mesh = new Mesh(shape, material);
    this.place(mesh, item.pose);
    mesh.name = item.name;
    mesh.renderOrder = zone ? 3 : clear ? 2 : 0;
    this.groups[item.joint].add(mesh);
    const edged = (zone || item.kind === "obstacle") && shape.index.count / 3 <= MOST_EDGED;
    if (edged) mesh.add(this.edges(shape, item, zone));
    let ghost = null;
    if (item.joint > 0 && (item.kind === "robot" || item.kind === "tool")) {
      ghost = new Mesh(shape, this.ghostMaterial);
      this.place(ghost, item.pose);
      ghost.renderOrder = 1;
      this.ghosts[item.joint].add(ghost);
    }
    return { key, item, mesh, material, ghost, shade: material.color.clone() };
  }

  drop({ mesh, material, ghost }) {
    for (const edges of mesh.children) {
      edges.geometry.dispose();
      edges.material.dispose();
      this.materials.delete(edges.material);
    }
    mesh.removeFromParent();
    ghost?.removeFromParent();
    material.dispose();
    this.materials.delete(material);
  }

  edges(shape, item, zone) {
    const hue = zone ? colour(item.colour) : colour(item.colour).multiplyScalar(0.45);
    const material = this.keep(new LineBasicMaterial({ color: hue, transparent: true, opacity: zone ? 0.9 : 0.5 }));
    const made = new LineSegments(new EdgesGeometry(shape, 30), material);
    made.renderOrder = zone ? 4 : 0;
    return made;
  }

  addAxes(axes) {
    const made = new Group();
    this.place(made, axes.pose);
    const size = axes.joint === 0 ? 1 : 0.7;
    AXES.forEach(([, turn], number) => {
      const line = new Mesh(this.axis, this.axisMaterials[number]);
      line.rotation.set(...turn);
      line.scale.setScalar(size);
      made.add(line);
    });
    this.groups[axes.joint].add(made);
    return { axes, group: made };
  }

  place(object, rows) {
    matrix(rows).decompose(object.position, object.quaternion, object.scale);
  }

  // The kinds that occur in the scene.
  get kinds() {
    return new Set([...this.items.map(({ item }) => item.kind), ...this.triads.map(({ axes }) => switchOf(axes))]);
  }

  // Show and hide kinds of bodies and frames. `on` has true or false for each kind.
  show(on) {
    this.on = on;
    for (const { axes, group } of this.triads) group.visible = on[switchOf(axes)] !== false;
    this.at(this.time);
  }

  // Show the bodies that exist at a time of the program [s]; null: before its beginning. Return true if this changes
  // the visible bodies.
  at(time) {
    this.time = time;
    const now = time ?? -Infinity;
    let other = false;
    for (const { item, mesh } of this.items) {
      const seen = this.on[item.kind] !== false && (item.begins_s ?? -Infinity) <= now && now < (item.ends_s ?? Infinity);
      other ||= seen !== mesh.visible;
      mesh.visible = seen;
    }
    this.carry();
    return other;
  }

  // Attach held parts to the translucent robot if it is shown, otherwise to the robot.
  carry() {
    for (const { item, mesh } of this.items) {
      if (item.kind !== "part" || item.joint === 0) continue;
      const place = (this.ghosted ? this.ghosts : this.groups)[item.joint];
      if (mesh.parent !== place) place.add(mesh);
    }
  }

  // Move the links to their poses: 7 numbers (position and quaternion) for each joint.
  moveTo(links, groups = this.groups) {
    const place = new Vector3();
    const turn = new Quaternion();
    const one = new Vector3(1, 1, 1);
    for (let joint = 1; joint < groups.length; joint += 1) {
      const at = 7 * (joint - 1);
      place.set(links[at], links[at + 1], links[at + 2]);
      turn.set(links[at + 3], links[at + 4], links[at + 5], links[at + 6]);
      groups[joint].matrix.compose(place, turn, one);
      groups[joint].matrixWorldNeedsUpdate = true;
    }
  }

  // Show a second, translucent robot at the links' poses; null: hide it.
  ghost(links) {
    this.ghosted = links !== null;
    for (const group of this.ghosts) group.visible = this.ghosted;
    if (links) this.moveTo(links, this.ghosts);
    this.carry();
  }

  // Colour bodies that touch or stop the robot (`names`) and marked bodies; all grey if the data is stale. A marked
  // link is coloured on the translucent robot, if that is shown.
  light(names, marked, stale) {
    if (!this.told) return;
    this.marked = marked;
    const [bad, grey] = [colour(this.told.touching), colour(this.told.stale)];
    for (const one of this.items) {
      const { item, material, shade, ghost } = one;
      const lit = names.has(item.name) || (marked.has(item.name) && this.standsFor(one) !== ghost);
      material.color.copy(stale ? grey : lit ? bad : shade);
      material.opacity = lit && item.kind === "zone" ? 0.4 : item.opacity;
      if (ghost) ghost.material = marked.has(item.name) ? this.litMaterial : this.ghostMaterial;
    }
  }

  // Return the mesh at which a label for a body stands: for a marked link, that of the translucent robot.
  standsFor({ item, mesh, ghost }) {
    return ghost && this.ghosted && this.marked.has(item.name) ? ghost : mesh;
  }

  forget(id, asked) {
    this.geometries.delete(id);
    asked.then((one) => one.dispose(), () => {});
  }

  clear() {
    for (const one of this.items) this.drop(one);
    for (const group of [...this.groups, ...this.ghosts]) this.scene.remove(group);
    [this.groups, this.ghosts, this.items, this.triads] = [[], [], [], []];
  }

  close() {
    this.closed = true;
    this.clear();
    for (const material of this.materials) material.dispose();
    for (const [id, asked] of this.geometries) this.forget(id, asked);
    this.axis.dispose();
  }
}
