// SPDX-License-Identifier: Apache-2.0
// Inks of the drawing on a light ground and on a dark one, and the colours by which robots are told apart.

import {createStore} from './dom.js';

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

/** The colour of each robot of a scene, for a theme: those of the report, too. */
export const robotColors = (robots, theme) => robots.map(({identity}) => identity[theme]);

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
