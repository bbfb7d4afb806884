// SPDX-License-Identifier: Apache-2.0
// Where each robot has been.  New pieces are added to the ground; only when one looks from
// elsewhere all of it is drawn again.

const POINTS_ALL = 60000;
const POINTS_MAX = 6000;
const LEAST = 0.01; /* metres between two points */
const DASHES = [0, 8, 3]; /* points, by pattern */
const JUMP = 1.0; /* metres in a step, too many to drive: it was put there */

function createTrail(capacity) {
  return {xs: new Float32Array(capacity), ys: new Float32Array(capacity), count: 0, first: 0};
}

export function createTrails() {
  let trails = [], capacity = POINTS_MAX, drawn = [];

  function add(trail, x, y) {
    const at = trail.count % capacity;
    const before = (trail.count + capacity - 1) % capacity;
    if (trail.count > 0 && Math.hypot(x - trail.xs[before], y - trail.ys[before]) < LEAST) return;
    trail.xs[at] = x;
    trail.ys[at] = y;
    trail.count++;
  }

  /* The pieces of a line that is dashed or dotted are points, so that it can be drawn piece by piece. */
  const isGap = (at, pattern) => pattern > 0 && Math.floor(at / DASHES[pattern]) % 2 === 1;

  function stroke(context, trail, from, color, pattern) {
    const first = Math.max(from, trail.count - capacity + 1, 0);
    context.beginPath();
    for (let i = first; i < trail.count; i++) {
      const at = i % capacity, before = (i + capacity - 1) % capacity;
      const jumps = i > first && Math.hypot(trail.xs[at] - trail.xs[before], trail.ys[at] - trail.ys[before]) > JUMP;
      if (i === first || jumps || isGap(i, pattern)) context.moveTo(trail.xs[at], trail.ys[at]);
      else context.lineTo(trail.xs[at], trail.ys[at]);
    }
    context.strokeStyle = color;
    context.stroke();
  }

  return {
    clear(robots = []) {
      capacity = Math.max(200, Math.min(POINTS_MAX, Math.floor(POINTS_ALL / Math.max(1, robots.length))));
      trails = robots.map((robot) => {
        const trail = createTrail(capacity);
        add(trail, robot.start[0], robot.start[1]);
        return trail;
      });
      drawn = robots.map(() => 0);
    },
    /** Starts again with where they were up to a step: {steps, robots: [x, y, x, y, ...] in mm}. */
    restart(tracks, step) {
      const behind = tracks.steps.findIndex((at) => at > step);
      const count = behind < 0 ? tracks.steps.length : behind;
      trails = trails.map((_, i) => {
        const trail = createTrail(capacity), track = tracks.robots[i] ?? [];
        for (let n = 0; n < count && track.length; n++) add(trail, track[2 * n] / 1000, track[2 * n + 1] / 1000);
        return trail;
      });
      drawn = trails.map(() => 0);
    },
    add(frame) {
      frame.robots.forEach((robot, i) => trails[i] && add(trails[i], robot.x, robot.y));
    },
    /** again: the picture was begun anew, and has no trails yet. */
    draw(context, camera, robots, colors, again, ratio) {
      camera.enter(context, ratio);
      context.lineWidth = 2.2 / camera.scale;
      context.lineJoin = context.lineCap = 'round';
      context.globalAlpha = 0.75;
      trails.forEach((trail, i) => {
        const from = again ? 0 : drawn[i] - 1;
        if (again || trail.count > drawn[i]) stroke(context, trail, from, colors[i], robots[i].identity.pattern);
        drawn[i] = trail.count;
      });
      context.globalAlpha = 1;
    },
    get grew() {
      return trails.some((trail, i) => trail.count > drawn[i]);
    },
  };
}
