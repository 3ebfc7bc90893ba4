// Requests for the scene: its description, its meshes, and the poses of links at given joint positions.

import { get } from "/api.js";
import { BufferAttribute, BufferGeometry } from "/bundles/three.js";

// Largest number of joint positions in one request.
const MOST_ROWS = 2000;

// Request the scene of a loaded program by its number; null: the scene of the robot in the session's cell.
export const describe = (program = null) => get(program === null ? "/api/scene" : `/api/scene?program=${program}`);

// Request binary data. If the login has ended, the login page is shown, as after every other request.
async function bytes(path, options = {}) {
  const answer = await fetch(path, { credentials: "same-origin", ...options });
  if (answer.ok) return answer.arrayBuffer();
  const told = await answer.json().catch(() => ({ error: `the server answers ${answer.status}` }));
  if (answer.status === 401) document.dispatchEvent(new CustomEvent("loggedout", { detail: told }));
  throw new Error(told.error);
}

// Request a mesh and convert it to a geometry. Its format: V, F, corners, triangles, normals.
export async function geometry(id) {
  const content = await bytes(`/api/scene/mesh/${encodeURIComponent(id)}`);
  const [count, triangles] = new Uint32Array(content, 0, 2);
  const made = new BufferGeometry();
  made.setAttribute("position", new BufferAttribute(new Float32Array(content, 8, 3 * count), 3));
  made.setIndex(new BufferAttribute(new Uint32Array(content, 8 + 12 * count, 3 * triangles), 1));
  made.setAttribute("normal", new BufferAttribute(new Int8Array(content, 8 + 12 * count + 12 * triangles, 3 * count), 3, true));
  made.computeBoundingSphere();
  made.computeBoundingBox();
  return made;
}

// Request the poses of the links (7 numbers for each joint) at several joint positions, in the order of the robot's
// joints.
export async function placements(rows) {
  const found = [];
  for (let begin = 0; begin < rows.length; begin += MOST_ROWS) {
    const some = rows.slice(begin, begin + MOST_ROWS);
    const content = await bytes("/api/scene/placements", {
      method: "POST",
      headers: { "content-type": "application/json" },
      body: JSON.stringify({ joints: some }),
    });
    const all = new Float32Array(content);
    const each = all.length / some.length;
    for (let row = 0; row < some.length; row += 1) found.push(all.subarray(row * each, (row + 1) * each));
  }
  return found;
}
