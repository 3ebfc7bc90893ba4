// The camera: one finger orbits, two fingers pan and zoom, and there are named views.

import { OrbitControls, PerspectiveCamera, Vector3 } from "/bundles/three.js";
import { matrix } from "/scene/bodies.js";

export const VIEWS = [["iso", "3D"], ["front", "Front"], ["side", "Side"], ["top", "Top"], ["tool", "Tool"], ["fit", "Fit"]];

const FROM = { front: [1, 0, 0.12], side: [0, -1, 0.12], top: [0, -0.0008, 1] };
const MARGIN = 1.2;

export class Eye {
  constructor(element, changed) {
    this.camera = new PerspectiveCamera(45, 1, 0.02, 200);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, element);
    this.controls.minDistance = 0.08;
    this.controls.maxDistance = 60;
    this.controls.addEventListener("change", changed);
    this.controls.addEventListener("start", () => (this.touched = true));
    this.touched = false;
    this.view = "iso";
    this.changed = changed;
  }

  resize(width, height) {
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
  }

  // Show one of VIEWS. `told` is the scene's description.
  take(view, told) {
    this.view = view;
    this.touched = false;
    this.controls.enabled = view !== "tool";
    this.camera.up.set(0, 0, 1);
    if (view === "tool") {
      this.changed();
      return;
    }
    const whole = view === "fit";
    const [low, high] = whole ? [told.low, told.high] : [told.robot_low, told.robot_high];
    const middle = new Vector3(...low).add(new Vector3(...high)).multiplyScalar(0.5);
    const eye = new Vector3(...told.eye).sub(new Vector3(...told.target));
    const from = FROM[view] ? new Vector3(...FROM[view]) : whole ? this.direction() : eye;
    this.controls.target.copy(middle);
    this.camera.position.copy(middle).addScaledVector(from.normalize(), this.away(from, new Vector3(...low).sub(middle)));
    this.controls.update();
    this.changed();
  }

  // Return the distance [m] from which all corners of a box are visible. `half` is the vector from the box's middle to
  // a corner.
  away(from, half) {
    const right = new Vector3(0, 0, 1).cross(from).normalize();
    const up = from.clone().cross(right);
    const high = Math.tan((this.camera.fov * Math.PI) / 360) / MARGIN;
    const wide = high * this.camera.aspect;
    let found = 0.3;
    for (let corner = 0; corner < 8; corner += 1) {
      const place = new Vector3(half.x * (corner & 1 ? 1 : -1), half.y * (corner & 2 ? 1 : -1), half.z * (corner & 4 ? 1 : -1));
      found = Math.max(found, place.dot(from) + Math.max(Math.abs(place.dot(right)) / wide, Math.abs(place.dot(up)) / high));
    }
    return found;
  }

  direction() {
    const found = this.camera.position.clone().sub(this.controls.target);
    return found.lengthSq() > 1e-9 ? found : new Vector3(1, 0.8, 0.5);
  }

  // Move the camera with the tool, looking along the tool's axis. `group` is the group that the last joint moves.
  ride(group, told) {
    if (this.view !== "tool") return;
    const origin = new Vector3().setFromMatrixPosition(matrix(told.tool_pose));
    const axis = new Vector3(...told.tool_axis).normalize();
    const up = Math.abs(axis.z) > 0.9 ? new Vector3(1, 0, 0) : new Vector3(0, 0, 1);
    up.addScaledVector(axis, -axis.dot(up)).normalize();
    const eye = origin.clone().addScaledVector(axis, -0.3).addScaledVector(up, 0.24);
    const target = origin.addScaledVector(axis, 0.12);
    this.camera.up.copy(up).transformDirection(group.matrix);
    this.camera.position.copy(eye.applyMatrix4(group.matrix));
    this.camera.lookAt(target.applyMatrix4(group.matrix));
  }

  close() {
    this.controls.dispose();
  }
}
