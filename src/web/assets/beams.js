// SPDX-License-Identifier: Apache-2.0
// What sonars and lasers read, as they stand on their body.

const NEAR_M = 0.5;

/** The mount's pose in the world. */
function mountPose(robot, [x, y, heading]) {
  const c = Math.cos(robot.heading), s = Math.sin(robot.heading);
  return [robot.x + c * x - s * y, robot.y + s * x + c * y, robot.heading + heading];
}

function drawCone(context, robot, mount, range, ink) {
  const [x, y, heading] = mountPose(robot, mount);
  const half = Math.max(0.03, mount[3] / 2);
  const reach = Math.min(range, mount[4]);
  context.beginPath();
  context.moveTo(x, y);
  context.arc(x, y, reach, heading - half, heading + half);
  context.closePath();
  context.fillStyle = range < NEAR_M ? ink.near : ink.beam;
  context.fill();
  if (range >= mount[4]) return;
  context.beginPath();
  context.arc(x, y, reach, heading - half, heading + half);
  context.strokeStyle = ink.beamEdge;
  context.stroke();
}

/** Readings go from right to left over the field of view. */
function drawFan(context, robot, mount, ranges, ink) {
  const [x, y, heading] = mountPose(robot, mount);
  const steps = Math.max(1, ranges.length - 1);
  context.beginPath();
  context.moveTo(x, y);
  for (let i = 0; i < ranges.length; i++) {
    const angle = heading - mount[3] / 2 + mount[3] * i / steps;
    const reach = Math.min(ranges[i], mount[4]);
    context.lineTo(x + reach * Math.cos(angle), y + reach * Math.sin(angle));
  }
  context.closePath();
  context.fillStyle = ink.beam;
  context.fill();
  context.strokeStyle = ink.beamEdge;
  context.stroke();
}

/* What shines more than a wall does: a dot where the beam ends. */
function drawReflectors(context, robot, mount, ranges, intensity, ink) {
  const [x, y, heading] = mountPose(robot, mount);
  const steps = Math.max(1, ranges.length - 1);
  context.fillStyle = ink.beamEdge;
  for (let i = 0; i < intensity.length; i++) {
    if (intensity[i] <= 1) continue;
    const angle = heading - mount[3] / 2 + mount[3] * i / steps;
    context.beginPath();
    context.arc(x + ranges[i] * Math.cos(angle), y + ranges[i] * Math.sin(angle), 3 * context.lineWidth, 0, 2 * Math.PI);
    context.fill();
  }
}

/** Draws the beams of one robot of a frame. */
export function drawBeams(context, camera, figure, frame, index, ink) {
  const robot = frame.robots[index];
  const sonar = frame.lists.sonar.get(index), laser = frame.lists.laser.get(index);
  context.lineWidth = 1 / camera.scale;
  const intensity = frame.lists['laser-intensity'].get(index);
  if (laser && figure.lasers[0]) drawFan(context, robot, figure.lasers[0], laser, ink);
  if (laser && intensity && figure.lasers[0]) drawReflectors(context, robot, figure.lasers[0], laser, intensity, ink);
  if (!sonar) return;
  const count = Math.min(sonar.length, figure.sonars.length);
  for (let i = 0; i < count; i++) drawCone(context, robot, figure.sonars[i], sonar[i], ink);
}
