// What the server says of the scene: its description, its meshes, and where links are at joint positions.

import { get } from "/api.js";
import { BufferAttribute, BufferGeometry } from "/bundles/three.js";

// Joint positions in one question.
const MOST_ROWS = 2000;

// Of the robot in the cell of its session, or of a loaded program, by its number.
export const describe = (program = null) => get(program === null ? "/api/scene" : `/api/scene?program=${program}`);

// Answers that are bytes; a login that has ended is told to the page like everywhere.
async function bytes(path, options = {}) {
  const answer = await fetch(path, { credentials: "same-origin", ...options });
  if (answer.ok) return answer.arrayBuffer();
  const told = await answer.json().catch(() => ({ error: `the server answers ${answer.status}` }));
  if (answer.status === 401) document.dispatchEvent(new CustomEvent("loggedout", { detail: told }));
  throw new Error(told.error);
}

// A mesh as a geometry: V, F, corners, triangles, normals.
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

// Placements (7 numbers a joint) for lists of joint positions, in the order of the robot's joints.
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
