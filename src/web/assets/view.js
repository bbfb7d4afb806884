// SPDX-License-Identifier: Apache-2.0
// The picture of a world: a function of a scene, a frame, what is known of minds, and how one looks
// at it.  Where frames come from, a run or a recording, is nothing to it.

import {drawBeams} from './beams.js';
import {createCamera} from './camera.js';
import {INKS, robotColors} from './colors.js';
import {createGround} from './ground.js';
import {createMails} from './mails.js';
import {createRobots} from './robots.js';
import {createTrails} from './trails.js';

const BEAMS_ALL_MAX = 40;

/** Two canvases: what stays, and above it what lives. */
export function createView(groundCanvas, liveCanvas) {
  const below = groundCanvas.getContext('2d', {alpha: false});
  const above = liveCanvas.getContext('2d');
  const camera = createCamera();
  const ground = createGround(), trails = createTrails(), robots = createRobots(), mails = createMails();
  let scene = null, colors = [], theme = 'light', drawnVersion = -1, drawnTrails = null, stale = true;

  const view = {
    camera, robots, mails, trails,
    /** Draws above all else, if it is set. */
    onTop: null,
    /** What people switch. */
    look: {picked: -1, follow: false, trails: true, beams: 'picked', mail: true, names: true},
    get colors() {
      return colors;
    },

    load(next) {
      scene = next;
      colors = robotColors(scene.robots, theme);
      robots.load(scene);
      mails.load(scene);
      trails.clear(scene.robots);
      stale = true;
    },

    /** After a leap to a step of a recording: trails are as they were then. */
    restart(tracks, step) {
      trails.restart(tracks, step);
      stale = true;
    },

    paint(name) {
      theme = name;
      colors = scene ? robotColors(scene.robots, theme) : [];
      stale = true;
    },

    fit() {
      if (scene) camera.fit(scene.bounds);
    },

    /** The canvases take the size that they are shown in; what was all to be seen is so again. */
    resize() {
      const ratio = devicePixelRatio || 1;
      const width = liveCanvas.clientWidth, height = liveCanvas.clientHeight;
      const wide = Math.round(width * ratio), high = Math.round(height * ratio);
      if (liveCanvas.width === wide && liveCanvas.height === high) return;
      for (const canvas of [groundCanvas, liveCanvas]) {
        canvas.width = wide;
        canvas.height = high;
      }
      camera.resize(width, height);
      if (camera.fitted) view.fit();
      stale = true;
    },

    /** Draws a frame; now: ms, for what flies; agents: by name, those that are there. */
    draw(frame, minds, now, agents = new Map()) {
      const ink = INKS[theme], ratio = devicePixelRatio || 1;
      const {picked, follow} = view.look;
      if (follow && frame?.robots[picked]) camera.moveTo(frame.robots[picked].x, frame.robots[picked].y);
      drawBelow(ink, ratio);
      above.setTransform(1, 0, 0, 1, 0, 0);
      above.clearRect(0, 0, liveCanvas.width, liveCanvas.height);
      if (!scene || !frame) return;
      drawSensing(frame, ink, ratio);
      const {names} = view.look;
      robots.draw(above, camera, frame, minds, {colors, ink, picked, names, ratio, agents});
      if (view.look.mail) mails.draw(above, camera, frame, now, {colors, ink, ratio});
      view.onTop?.(above, ink, ratio);
    },
  };

  /* Most of the time trails alone have changed, by a little at their ends. */
  function drawBelow(ink, ratio) {
    const shown = view.look.trails;
    const again = stale || camera.version !== drawnVersion || shown !== drawnTrails;
    if (again) ground.draw(below, scene, camera, ink, ratio);
    if (shown && (again || trails.grew)) trails.draw(below, camera, scene?.robots ?? [], colors, again, ratio);
    drawnVersion = camera.version;
    drawnTrails = shown;
    stale = false;
  }

  function drawSensing(frame, ink, ratio) {
    const {beams, picked} = view.look;
    camera.enter(above, ratio);
    if (beams === 'all' && frame.robots.length <= BEAMS_ALL_MAX) {
      scene.robots.forEach((figure, i) => frame.robots[i] && drawBeams(above, camera, figure, frame, i, ink));
    } else if (beams !== 'none' && frame.robots[picked]) {
      drawBeams(above, camera, scene.robots[picked], frame, picked, ink);
    }
  }

  return view;
}
