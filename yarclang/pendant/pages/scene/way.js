// The path of the tool in a program, coloured by speed, and the poses of the links along it.

import { LineMaterial, LineSegments2, LineSegmentsGeometry, Quaternion, Vector3 } from "/bundles/three.js";
import { colour, matrix } from "/scene/bodies.js";
import { placements } from "/scene/load.js";

const WIDTH = 3.5; // width of the path, as drawn [px]

// `course` is {times [s], joints: [[deg or mm]]}; `told` is the scene's description.
export async function wayOf(course, told) {
  const links = await placements(course.joints);
  const tool = new Vector3().setFromMatrixPosition(matrix(told.tool_pose));
  const last = 7 * (told.joints.length - 1);
  const points = links.map((one) =>
    tool.clone().applyQuaternion(new Quaternion(one[last + 3], one[last + 4], one[last + 5], one[last + 6])).add(new Vector3(one[last], one[last + 1], one[last + 2])));
  return new Way(course, links, points, told);
}

export class Way {
  constructor(course, links, points, told) {
    Object.assign(this, { course, links, points });
    const speeds = points.slice(1).map((point, number) => {
      const time = (course.times?.[number + 1] ?? number + 1) - (course.times?.[number] ?? number);
      return time > 1e-9 ? point.distanceTo(points[number]) / time : 0;
    });
    this.fastest = speeds.reduce((most, one) => Math.max(most, one), 0);
    const ramp = told.speeds.map(colour);
    const [places, hues] = [[], []];
    speeds.forEach((speed, number) => {
      const share = this.fastest > 0 ? (speed / this.fastest) * (ramp.length - 1) : 0;
      const low = Math.min(Math.floor(share), ramp.length - 2);
      const hue = ramp[low].clone().lerp(ramp[low + 1], share - low);
      places.push(...points[number], ...points[number + 1]);
      hues.push(...hue, ...hue);
    });
    this.geometry = new LineSegmentsGeometry();
    this.material = new LineMaterial({ vertexColors: true, linewidth: WIDTH });
    if (places.length) this.geometry.setPositions(places).setColors(hues);
    this.line = new LineSegments2(this.geometry, this.material);
    this.line.visible = places.length > 0;
    this.line.frustumCulled = false;
  }

  // Return the poses of the links at joint positions that differ from some of the course by less than `within`; null:
  // there are none.
  near(joints, within) {
    let [best, found] = [within, null];
    this.course.joints.forEach((row, number) => {
      let apart = 0;
      for (let joint = 0; joint < row.length && apart < best; joint += 1) apart = Math.max(apart, Math.abs(row[joint] - joints[joint]));
      if (apart < best) [best, found] = [apart, this.links[number]];
    });
    return found;
  }

  close() {
    this.line.removeFromParent();
    this.geometry.dispose();
    this.material.dispose();
  }
}
