// SPDX-License-Identifier: Apache-2.0
// The table of robots: totals since the run began, and the state of each.

import {element, mark, say} from './dom.js';

const END = 5; /* characters of a name that are shown in any case */

const one = (x) => x.toFixed(1);

/* title, unit, what a row says, what it is sorted by */
const COLUMNS = [
  ['robot', '', null, (row) => row.name],
  ['state', '', (row) => (row.stalled ? 'stalled' : row.state), (row) => row.state],
  ['distance', 'm', (row) => one(row.total?.distance ?? 0), (row) => row.total?.distance ?? -1],
  ['speed', 'mean m/s', (row) => (row.total?.speed ?? 0).toFixed(2), (row) => row.total?.speed ?? -1],
  ['stalls', '', (row) => String(row.total?.stalls ?? 0), (row) => row.total?.stalls ?? -1],
  ['stalled', 's', (row) => one(row.total?.stalled ?? 0), (row) => row.total?.stalled ?? -1],
  ['rules', 'fired', (row) => String(row.total?.firings ?? 0), (row) => row.total?.firings ?? -1],
  ['mails', 'sent', (row) => String(row.total?.sent ?? 0), (row) => row.total?.sent ?? -1],
  ['mails', 'taken', (row) => String(row.total?.received ?? 0), (row) => row.total?.received ?? -1],
];

export function createStatistics({onPick, onOpen}) {
  const body = element('tbody');
  const heads = COLUMNS.map(([title, unit], i) =>
    element('th', {scope: 'col', 'aria-sort': 'none'},
      element('button', {type: 'button', title: 'sort', click: () => sortBy(i)}, title, element('small', {}, unit))));
  const others = element('p', {class: 'quiet also'});
  const panel = element('div', {class: 'panel'},
    element('table', {}, element('thead', {}, element('tr', {}, ...heads)), body), others);
  let rows = [], order = -1, downwards = false;
  /* Of a thousand rows thirty are seen: to write the others takes a browser most of its time. */
  const seen = new Set();
  const watcher = new IntersectionObserver((entries) =>
    entries.forEach(({target, isIntersecting}) => (isIntersecting ? seen.add(target) : seen.delete(target))));

  function sortBy(column) {
    downwards = order === column ? !downwards : column > 1;
    order = column;
    heads.forEach((head, i) => mark(head, 'aria-sort', i !== order ? 'none' : downwards ? 'descending' : 'ascending'));
    arrange();
  }

  function arrange() {
    if (order < 0) return;
    const key = COLUMNS[order][3], sign = downwards ? -1 : 1;
    const sorted = [...rows].sort((a, b) => {
      const [x, y] = [key(a), key(b)];
      return sign * (x < y ? -1 : x > y ? 1 : a.index - b.index);
    });
    if (sorted.every((row, i) => body.children[i] === row.node)) return;
    body.append(...sorted.map((row) => row.node));
  }

  function makeRow(name, index) {
    const dot = element('span', {class: 'dot'});
    const cells = COLUMNS.map((column, i) => (i === 0
      ? element('td', {}, element('span', {class: 'name', title: name}, dot,
        element('span', {class: 'head'}, name.slice(0, -END)), element('span', {}, name.slice(-END))))
      : element('td', {class: i === 1 ? 'state' : ''})));
    const node = element('tr', {click: () => onPick(index), dblclick: () => onOpen(name)}, ...cells);
    return {name, index, node, dot, cells, state: '', reason: '', stalled: false, total: null};
  }

  function drawRow(row, picked) {
    mark(row.node, 'aria-selected', String(row.index === picked));
    mark(row.cells[1], 'data-state', row.stalled ? 'stalled' : row.state);
    mark(row.cells[1], 'title', row.reason);
    COLUMNS.forEach(([, , text], i) => text && say(row.cells[i], text(row)));
  }

  return {
    panel,
    load(scene) {
      rows = scene.robots.map((robot, i) => makeRow(robot.name, i));
      body.replaceChildren(...rows.map((row) => row.node));
      watcher.disconnect();
      seen.clear();
      rows.forEach((row) => watcher.observe(row.node));
    },
    paint(colors) {
      rows.forEach((row, i) => row.dot.style.setProperty('--robot', colors[i]));
    },
    take(statistics) {
      rows.forEach((row, i) => {
        row.total = statistics.robots[i] ?? null;
      });
      arrange();
    },
    draw(frame, agents, picked, over) {
      rows.forEach((row, i) => {
        const robot = frame?.robots[i];
        row.state = agents.get(row.name)?.state ?? (over ? 'gone' : robot?.state ?? '');
        row.stalled = Boolean(robot?.stalled);
        row.reason = agents.get(row.name)?.reason ?? '';
        if (seen.has(row.node)) drawRow(row, picked);
      });
      const known = new Set(rows.map((row) => row.name));
      const rest = [...agents.values()].filter((a) => !known.has(a.name) && !a.name.startsWith('broker'));
      const words = [rows.length === 0 && 'No robots yet.', rest.length && `Also there: ${rest.map((a) => `${a.name} (${a.state})`).join(', ')}`];
      say(others, words.filter(Boolean).join('  '));
    },
  };
}
