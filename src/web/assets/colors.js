// SPDX-License-Identifier: Apache-2.0
// Colours that people tell apart who see few: the set of Okabe and Ito, darker on a light ground
// and lighter on a dark one.  A robot that is called after a colour, or has one, gets its relative.

import {createStore} from './dom.js';

const SETS = {
  light: {
    red: '#c8480a', blue: '#0072b2', green: '#00865f', yellow: '#c99400', purple: '#b8558c',
    sky: '#2f93cf', orange: '#e07b00', grey: '#5b6b78',
  },
  dark: {
    red: '#ff7a3d', blue: '#4ba3ea', green: '#2fc79a', yellow: '#f0dc4e', purple: '#e794c3',
    sky: '#8fd0f5', orange: '#f5a623', grey: '#aab7c2',
  },
};

const ORDER = ['purple', 'sky', 'orange', 'grey', 'blue', 'red', 'green', 'yellow'];

const RELATIVES = {
  red: 'red', crimson: 'red', tomato: 'red', '#ff0000': 'red',
  blue: 'blue', navy: 'blue', royalblue: 'blue', '#0000ff': 'blue',
  green: 'green', lime: 'green', darkgreen: 'green', '#00ff00': 'green', '#008000': 'green',
  yellow: 'yellow', gold: 'yellow', '#ffff00': 'yellow',
  orange: 'orange', '#ffa500': 'orange',
  purple: 'purple', magenta: 'purple', pink: 'purple', violet: 'purple', '#ff00ff': 'purple',
  cyan: 'sky', aqua: 'sky', skyblue: 'sky', lightblue: 'sky', '#00ffff': 'sky',
  gray: 'grey', grey: 'grey', silver: 'grey', black: 'grey', white: 'grey',
};

const normal = (color) => {
  const word = String(color ?? '').trim().toLowerCase();
  return /^0x[0-9a-f]{6}$/.test(word) ? '#' + word.slice(2) : word;
};

/** What the drawing is made of, by theme. */
export const INKS = {
  light: {
    ground: '#f4f6f8', floor: '#ffffff', grid: '#e3e8ec', ink: '#17212b', soft: '#4d5b68',
    wall: '#46535f', halo: 'rgba(255,255,255,.85)', beam: 'rgba(11,99,165,.16)',
    beamEdge: 'rgba(11,99,165,.55)', near: 'rgba(200,72,10,.30)', bad: '#a83200', warn: '#8a5300',
  },
  dark: {
    ground: '#0f151b', floor: '#18212a', grid: '#24303a', ink: '#e8eef3', soft: '#a3b1bd',
    wall: '#93a3b1', halo: 'rgba(15,21,27,.85)', beam: 'rgba(108,184,240,.17)',
    beamEdge: 'rgba(108,184,240,.55)', near: 'rgba(255,144,105,.34)', bad: '#ff9069', warn: '#f2b84b',
  },
};

/** The colour of each robot of a scene, for a theme.  One that all have tells nobody apart. */
export function robotColors(robots, theme) {
  const alike = robots.length > 1 && robots.every(({color}) => color === robots[0].color);
  let others = 0;
  return robots.map((robot) => {
    const name = RELATIVES[normal(robot.name)] ?? (alike ? null : RELATIVES[normal(robot.color)]);
    return SETS[theme][name ?? ORDER[others++ % ORDER.length]];
  });
}

/** The theme: what the person chose, else what the system says. */
export function createTheme(onChange) {
  const dark = matchMedia('(prefers-color-scheme: dark)');
  const store = createStore('localStorage');
  let chosen = store.get('muster-theme');
  const theme = {
    get name() {
      return chosen ?? (dark.matches ? 'dark' : 'light');
    },
    toggle() {
      chosen = theme.name === 'dark' ? 'light' : 'dark';
      store.set('muster-theme', chosen);
      apply();
    },
  };
  const apply = () => {
    document.documentElement.dataset.theme = theme.name;
    onChange(theme.name);
  };
  dark.addEventListener('change', apply);
  document.documentElement.dataset.theme = theme.name;
  return theme;
}
