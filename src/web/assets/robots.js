// SPDX-License-Identifier: Apache-2.0
// Robots and things, their names, states, stalls and goals.

import {drawLabel, labelOf, outlinePath, outlineReach} from './shapes.js';

const SMALLEST_PX = 7;
const LABEL_PX = 17;
const EDGE_PX = 10; /* of the picture: no name comes nearer */
const NAME_WEIGHT = 3; /* it hides rather that many bodies than another name */
const FILLS = [1, 0.15, 0.5]; /* by pattern: full, hollow, between */
const LABELS_MAX = 24; /* of so many robots all names are shown; of more, those near */

/** What of a figure does not change from frame to frame. */
function bodyOf(figure) {
  return {path: outlinePath(figure.shape), reach: outlineReach(figure.shape)};
}

function drawBody(context, camera, robot, body, look) {
  const factor = Math.max(1, SMALLEST_PX / (body.reach * camera.scale));
  const px = 1 / (camera.scale * factor);
  context.save();
  context.translate(robot.x, robot.y);
  context.rotate(robot.heading);
  context.scale(factor, factor);
  context.fillStyle = look.gone ? look.ink.wall : look.color;
  context.globalAlpha = FILLS[look.pattern] * (robot.state === 'absent' ? 0.25 : robot.state === 'standby' ? 0.55 : 1);
  context.fill(body.path);
  context.globalAlpha = 1;
  if (look.gone) {
    context.restore();
    return;
  }
  context.strokeStyle = look.picked ? look.ink.ink : look.pattern ? look.color : look.ink.halo;
  context.lineWidth = (look.picked || look.pattern ? 3 : 1.5) * px;
  if (robot.state === 'absent') context.setLineDash([4 * px, 4 * px]);
  context.stroke(body.path);
  context.setLineDash([]);
  const nose = body.reach;
  context.beginPath();
  context.moveTo(0.62 * nose, 0);
  context.lineTo(0, 0.30 * nose);
  context.lineTo(0, -0.30 * nose);
  context.closePath();
  context.fillStyle = look.ink.floor;
  context.fill();
  context.restore();
}

/* Two bars: it was told to stand.  A hollow ring: it has not begun. */
function drawState(context, x, y, reach, robot, ink) {
  if (robot.state === 'suspended') {
    context.fillStyle = ink.ink;
    context.strokeStyle = ink.halo;
    context.lineWidth = 3;
    const high = Math.min(7, Math.max(4, 0.7 * reach)), wide = high * 0.55;
    for (const dx of [-1.5 * wide, 0.5 * wide]) {
      context.strokeRect(x + dx, y - high, wide, 2 * high);
      context.fillRect(x + dx, y - high, wide, 2 * high);
    }
  }
  if (robot.stalled) {
    context.beginPath();
    context.arc(x, y, reach + 6, 0, 2 * Math.PI);
    context.strokeStyle = ink.bad;
    context.lineWidth = 3;
    context.setLineDash([6, 4]);
    context.stroke();
    context.setLineDash([]);
  }
}

/* Says whose name it is, where bodies are close to each other. */
function drawDot(context, x, y, look) {
  context.beginPath();
  context.arc(x, y, 5, 0, 2 * Math.PI);
  context.fillStyle = look.color;
  context.strokeStyle = look.ink.halo;
  context.lineWidth = 2;
  context.stroke();
  context.fill();
}

/** Robots and things of one scene. */
export function createRobots() {
  let scene = null, bodies = [], things = [], taken = [];
  function load(next) {
    scene = next;
    bodies = scene.robots.map(bodyOf);
    things = scene.objects.map(bodyOf);
  }

  function drawThings(context, camera, frame, ink) {
    frame.objects.forEach((object, i) => {
      const body = things[i];
      if (!body) return;
      context.save();
      context.translate(object.x, object.y);
      context.rotate(object.heading);
      context.fillStyle = scene.objects[i].shape.rgb;
      context.fill(body.path);
      context.strokeStyle = ink.soft;
      context.lineWidth = 1 / camera.scale;
      context.stroke(body.path);
      context.restore();
    });
  }

  function drawGoal(context, camera, frame, minds, i, look) {
    const home = minds.placeOf(i);
    if (!home) return;
    const [x, y] = camera.toScreen(home.x, home.y);
    context.beginPath();
    context.moveTo(x, y);
    context.lineTo(x, y - 22);
    context.lineTo(x + 14, y - 17);
    context.lineTo(x, y - 12);
    context.fillStyle = look.color;
    context.strokeStyle = look.ink.ink;
    context.lineWidth = 1.5;
    context.fill();
    context.stroke();
  }

  /* Above the body, else below it, else beside it: where it hides least of other names and bodies;
   * never half outside. */
  function placeLabel(camera, width, x, y, reach) {
    const inside = ([cx, by]) => [Math.max(width / 2 + EDGE_PX, Math.min(camera.width - width / 2 - EDGE_PX, cx)), Math.max(22, by)];
    const tries = [[x, y - reach - 7], [x, y + reach + 22], [x + reach + width / 2 + 8, y + 7],
      [x - reach - width / 2 - 8, y + 7], [x, y - reach - 9 - LABEL_PX], [x, y + reach + 24 + LABEL_PX]].map(inside);
    const hides = ([cx, by], {x: ox, y: oy, width: wide, height}) =>
      Math.abs(ox - cx) < (wide + width) / 2 && Math.abs(oy - by + LABEL_PX / 2) < (height + LABEL_PX) / 2;
    const hidden = (at) => taken.reduce((sum, other) => sum + (hides(at, other) ? other.weight : 0), 0);
    const costs = tries.map(hidden), at = tries[costs.indexOf(Math.min(...costs))];
    taken.push({x: at[0], y: at[1] - LABEL_PX / 2, width, height: LABEL_PX, weight: NAME_WEIGHT});
    return at;
  }

  const isSeen = (camera, x, y, reach) =>
    x > -reach && y > -reach && x < camera.width + reach && y < camera.height + reach;

  /* What a name would hide, were it put there. */
  function takeBody(camera, robot, i) {
    const [x, y] = camera.toScreen(robot.x, robot.y), reach = bodies[i].reach * camera.scale;
    if (isSeen(camera, x, y, reach)) taken.push({x, y, width: 2 * reach, height: 2 * reach, weight: 1});
  }

  function drawName(context, camera, robot, i, minds, look) {
    const [x, y] = camera.toScreen(robot.x, robot.y);
    const reach = Math.max(SMALLEST_PX, bodies[i].reach * camera.scale);
    if (!isSeen(camera, x, y, reach)) return;
    drawState(context, x, y, reach, robot, look.ink);
    if (!look.named) return;
    const goal = minds.goalOf(i);
    const words = [scene.robots[i].name.slice(0, 40)];
    if (goal) words.push(goal.slice(0, 32));
    if (robot.state !== 'running') words.push(robot.state);
    if (robot.stalled) words.push('stalled');
    const font = `${look.picked ? '700 16px' : '600 14px'} system-ui, sans-serif`;
    const ink = robot.stalled ? look.ink.bad : look.ink.ink;
    const label = labelOf(words.join(' · '), font, ink, look.ink.halo, look.ratio);
    const [ax, ay] = placeLabel(camera, label.width + 18, x, y, reach);
    drawLabel(context, label, ax, ay);
    drawDot(context, ax - label.width / 2 - 9, ay - 8, look);
  }

  /* No program drives it, and none will: its body stands there like a wall. */
  const isGone = (robot, i, agents) => robot.state === 'absent' &&
    (!scene.robots[i].controlled || (agents.size > 0 && !agents.has(scene.robots[i].name)));

  return {
    load,
    /** @return index of the robot at a place in pixels, or -1 */
    pick(camera, frame, px, py) {
      let best = -1, nearest = 14;
      frame.robots.forEach((robot, i) => {
        const [x, y] = camera.toScreen(robot.x, robot.y);
        const away = Math.hypot(px - x, py - y) - (bodies[i]?.reach ?? 0) * camera.scale;
        if (away < nearest) [best, nearest] = [i, away];
      });
      return best;
    },
    draw(context, camera, frame, minds, {colors, ink, picked, names, ratio, agents}) {
      camera.enter(context, ratio);
      drawThings(context, camera, frame, ink);
      const look = (i) => ({color: colors[i], pattern: scene.robots[i].identity.pattern, ink, picked: i === picked,
        gone: isGone(frame.robots[i], i, agents)});
      frame.robots.forEach((robot, i) => bodies[i] && drawBody(context, camera, robot, bodies[i], look(i)));
      context.setTransform(ratio, 0, 0, ratio, 0, 0);
      taken = [];
      frame.robots.forEach((robot, i) => bodies[i] && takeBody(camera, robot, i));
      const all = names && (frame.robots.length <= LABELS_MAX || camera.scale > 90);
      frame.robots.forEach((robot, i) => {
        if (!bodies[i] || (i !== picked && isGone(robot, i, agents))) return;
        const named = all || i === picked;
        drawGoal(context, camera, frame, minds, i, look(i));
        drawName(context, camera, robot, i, minds, {...look(i), named, ratio});
      });
    },
  };
}
