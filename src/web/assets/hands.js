// SPDX-License-Identifier: Apache-2.0
// Hands by mouse and keys: a body is dragged to where it is to be, or pushed; arrows do the same to
// the picked robot.  What is held is drawn as a ghost; the world changes when it is let go.

import {drawLabel, labelOf, outlinePath, outlineReach} from './shapes.js';
import {number} from './world.js';

const REACH_PX = 8;
const FORCE_N = 100; /* of a metre of arrow, and of a key */
const STEP_M = 0.1;
const TURN_DEG = 15;
const ARROWS = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1]};

/** bodiesOf: all bodies as {name, shape, pose}; order: sends one; canAct: whether that is allowed. */
export function createHands({camera, bodiesOf, order, canAct}) {
  let held = null; /* {body, pushes, from: [x, y], to: [x, y]}, metres */
  const hands = {on: false};

  function bodyAt(px, py) {
    let best = null, nearest = REACH_PX;
    for (const body of bodiesOf()) {
      const [x, y] = camera.toScreen(body.pose.x, body.pose.y);
      const away = Math.hypot(px - x, py - y) - outlineReach(body.shape) * camera.scale;
      if (away < nearest) [best, nearest] = [body, away];
    }
    return best;
  }

  const moved = () => [held.to[0] - held.from[0], held.to[1] - held.from[1]];

  function orderOf() {
    const [dx, dy] = moved(), {name, pose} = held.body;
    return held.pushes ? `push ${name} ${number(FORCE_N * dx)} ${number(FORCE_N * dy)}`
      : `place ${name} ${number(pose.x + dx)} ${number(pose.y + dy)}`;
  }

  function drawArrow(context, ink) {
    const [x0, y0] = camera.toScreen(...held.from), [x1, y1] = camera.toScreen(...held.to);
    const angle = Math.atan2(y1 - y0, x1 - x0);
    context.beginPath();
    context.moveTo(x0, y0);
    context.lineTo(x1, y1);
    for (const side of [-0.5, 0.5]) {
      context.moveTo(x1, y1);
      context.lineTo(x1 - 14 * Math.cos(angle + side), y1 - 14 * Math.sin(angle + side));
    }
    context.strokeStyle = ink.ink;
    context.lineWidth = 3;
    context.stroke();
  }

  function drawGhost(context, ink, ratio) {
    const {body} = held, [dx, dy] = moved();
    camera.enter(context, ratio);
    context.translate(body.pose.x + dx, body.pose.y + dy);
    context.rotate(body.pose.heading);
    context.setLineDash([6 / camera.scale, 4 / camera.scale]);
    context.lineWidth = 2 / camera.scale;
    context.strokeStyle = ink.ink;
    context.stroke(outlinePath(body.shape));
    context.setLineDash([]);
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
  }

  return Object.assign(hands, {
    /** Takes hold of what is there.  @return whether something is */
    grab(px, py, pushes) {
      const body = hands.on && canAct() ? bodyAt(px, py) : null;
      const at = camera.toWorld(px, py);
      held = body && {body, pushes, from: pushes ? [body.pose.x, body.pose.y] : at, to: at};
      return Boolean(held);
    },
    drag(px, py) {
      if (held) held.to = camera.toWorld(px, py);
    },
    /** @param moves  false: it was a click, and nothing is to be done */
    drop(moves) {
      if (held && moves) order(orderOf());
      held = null;
    },
    cancel() {
      held = null;
    },
    /** A key, for one robot {name, pose}.  @return whether it is one of the hands' */
    key(key, shift, robot) {
      if (!hands.on || !robot || !canAct()) return false;
      const {name, pose} = robot, arrow = ARROWS[key];
      const turned = pose.heading * 180 / Math.PI + (key === '[' ? TURN_DEG : -TURN_DEG);
      if (arrow && shift) order(`push ${name} ${FORCE_N * arrow[0]} ${FORCE_N * arrow[1]}`);
      else if (arrow) order(`place ${name} ${number(pose.x + STEP_M * arrow[0])} ${number(pose.y + STEP_M * arrow[1])}`);
      else if (key === '[' || key === ']') order(`place ${name} ${number(pose.x)} ${number(pose.y)} ${number(turned)}`);
      else return false;
      return true;
    },
    draw(context, ink, ratio) {
      if (!held) return;
      context.setTransform(ratio, 0, 0, ratio, 0, 0);
      if (held.pushes) drawArrow(context, ink);
      else drawGhost(context, ink, ratio);
      const [x, y] = camera.toScreen(...held.to);
      drawLabel(context, labelOf(orderOf(), '600 14px system-ui, sans-serif', ink.ink, ink.halo, ratio), x, y - 16);
    },
  });
}
