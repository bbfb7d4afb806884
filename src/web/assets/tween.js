// SPDX-License-Identifier: Apache-2.0
// Between two frames: robots glide from one to the next as long as frames are apart.

const LONGEST_MS = 250;

function turnBetween(a, b, share) {
  const turn = Math.atan2(Math.sin(b - a), Math.cos(b - a));
  return a + turn * share;
}

function placeBetween(a, b, share) {
  return {
    ...b,
    x: a.x + (b.x - a.x) * share,
    y: a.y + (b.y - a.y) * share,
    heading: turnBetween(a.heading, b.heading, share),
  };
}

/** The frame that lies that share (0 to 1) of the way from a to b. */
export function frameBetween(a, b, share) {
  if (!a || share >= 1 || a.robots.length !== b.robots.length) return b;
  return {
    ...b,
    robots: b.robots.map((robot, i) => placeBetween(a.robots[i], robot, share)),
    objects: b.objects.map((object, i) => placeBetween(a.objects[i] ?? object, object, share)),
  };
}

/** Keeps the last two frames; `at` gives what is to be seen now. */
export function createTween() {
  let from = null, to = null, began = 0, span = 100;
  return {
    push(frame, now) {
      const gap = to ? now - began : span;
      span = Math.min(LONGEST_MS, Math.max(16, 0.7 * span + 0.3 * gap));
      from = this.at(now);
      to = frame;
      began = now;
    },
    at(now) {
      return to && frameBetween(from, to, Math.max(0, now - began) / span);
    },
    clear() {
      from = to = null;
    },
  };
}
