// Poses as 4x4 matrices, row by row; lengths in m.

export function times(a, b) {
  return a.map((row) => b[0].map((_, j) => row.reduce((sum, value, k) => sum + value * b[k][j], 0)));
}

export function inverse(pose) {
  const [p, q, r] = pose;
  const back = [0, 1, 2].map((j) => -(p[j] * p[3] + q[j] * q[3] + r[j] * r[3]));
  return [0, 1, 2].map((j) => [p[j], q[j], r[j], back[j]]).concat([[0, 0, 0, 1]]);
}

export function matrix(values) {
  return [0, 1, 2, 3].map((row) => values.slice(4 * row, 4 * row + 4));
}

// Return x y z [mm] and roll pitch yaw [deg] of a pose, with R = Rz(yaw) Ry(pitch) Rx(roll).
export function numbers(pose) {
  const [[xx, xy], [yx, yy], [zx, zy, zz]] = pose;
  const deg = 180 / Math.PI;
  const pitch = Math.atan2(-zx, Math.hypot(xx, yx));
  const [roll, yaw] =
    Math.hypot(xx, yx) > 1e-9 ? [Math.atan2(zy, zz), Math.atan2(yx, xx)] : [Math.atan2(-xy * Math.sign(zx), yy), 0];
  return [pose[0][3] * 1e3, pose[1][3] * 1e3, pose[2][3] * 1e3, roll * deg, pitch * deg, yaw * deg];
}
