// SPDX-License-Identifier: Apache-2.0
// What does not move: floor, grid, walls, starts, a scale.

import {outlinePath, roundStep} from './shapes.js';

const GRID_PX = 60;

function drawGrid(context, camera, ink) {
  const step = roundStep(GRID_PX / camera.scale);
  const [x0, y1] = camera.toWorld(0, 0);
  const [x1, y0] = camera.toWorld(camera.width, camera.height);
  context.beginPath();
  for (let x = Math.ceil(x0 / step) * step; x <= x1; x += step) {
    context.moveTo(x, y0);
    context.lineTo(x, y1);
  }
  for (let y = Math.ceil(y0 / step) * step; y <= y1; y += step) {
    context.moveTo(x0, y);
    context.lineTo(x1, y);
  }
  context.strokeStyle = ink.grid;
  context.lineWidth = 1 / camera.scale;
  context.stroke();
}

function drawScale(context, camera, ink, ratio) {
  const step = roundStep(120 / camera.scale);
  const px = step * camera.scale;
  const right = camera.width - 16, bottom = 30;
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.beginPath();
  context.moveTo(right - px, bottom - 5);
  context.lineTo(right - px, bottom);
  context.lineTo(right, bottom);
  context.lineTo(right, bottom - 5);
  context.strokeStyle = ink.soft;
  context.lineWidth = 2;
  context.stroke();
  context.fillStyle = ink.soft;
  context.font = '13px system-ui, sans-serif';
  context.textAlign = 'right';
  context.textBaseline = 'bottom';
  context.fillText(`${+step.toPrecision(3)} m`, right, bottom - 6);
}

const MARK_ALPHA = 0.15; /* as in tracks.svg */

/** Walls of one scene, as one path; marks on its floor, which robots drive over. */
export function createGround() {
  let scene = null, walls = null, marks = [];
  function load(next) {
    scene = next;
    walls = new Path2D();
    for (const wall of scene.walls) if (!wall.flat) outlinePath(wall, walls);
    marks = scene.walls.filter((wall) => wall.flat).map((mark) => ({color: mark.rgb, path: outlinePath(mark)}));
  }
  return {
    draw(context, next, camera, ink, ratio) {
      context.setTransform(1, 0, 0, 1, 0, 0);
      context.fillStyle = ink.ground;
      context.fillRect(0, 0, context.canvas.width, context.canvas.height);
      if (!next) return;
      if (next !== scene) load(next);
      const [x0, y0, x1, y1] = scene.bounds;
      camera.enter(context, ratio);
      context.fillStyle = ink.floor;
      context.fillRect(x0, y0, x1 - x0, y1 - y0);
      context.globalAlpha = MARK_ALPHA;
      for (const {color, path} of marks) {
        context.fillStyle = color;
        context.fill(path);
      }
      context.globalAlpha = 1;
      drawGrid(context, camera, ink);
      context.fillStyle = ink.wall;
      context.fill(walls);
      context.strokeStyle = ink.wall;
      context.lineWidth = 1 / camera.scale;
      context.stroke(walls);
      drawScale(context, camera, ink, ratio);
    },
  };
}
