// SPDX-License-Identifier: Apache-2.0
// What consoles are made of: a pane of text, and a line with a history.

import {element} from './dom.js';

const NODES_MAX = 1500;
const HISTORY_MAX = 200;
const END_PX = 20; /* so near the end is at it */

/**
 * Keeps what is scrolled where it is: at its end, as long as it was not scrolled elsewhere.  A
 * browser forgets that of what is not to be seen.  @return does a change of what is in it
 */
export function createScroll(node) {
  let atEnd = true, top = 0;

  function note() {
    if (node.clientHeight === 0) return;
    top = node.scrollTop;
    atEnd = top + node.clientHeight >= node.scrollHeight - END_PX;
  }

  function settle() {
    node.scrollTop = atEnd ? node.scrollHeight : top;
  }

  node.addEventListener('scroll', note);
  new ResizeObserver(settle).observe(node);
  return (change) => {
    change();
    settle();
  };
}

/** One pane of text; what comes is put at its end.  empty: what is said as long as it has none */
export function createPane(empty) {
  const pane = element('pre', {class: 'output', tabindex: '0', 'data-empty': empty});
  const keep = createScroll(pane);
  return {
    pane,
    add(kind, text) {
      keep(() => {
        pane.append(element('span', {class: kind}, text));
        while (pane.childNodes.length > NODES_MAX) pane.firstChild.remove();
      });
    },
  };
}

/** One pane with an answer that takes the place of the one before; lines that had not been are marked. */
export function createAnswer(empty) {
  const pane = element('pre', {class: 'output', tabindex: '0', 'data-empty': empty});
  let top = 0, had = null;
  pane.addEventListener('scroll', () => { top = pane.clientHeight > 0 ? pane.scrollTop : top; });
  new ResizeObserver(() => { pane.scrollTop = top; }).observe(pane);
  return {
    pane,
    replace(text, note) {
      const lines = (text.trim() ? text : 'There is nothing.\n').split('\n'), before = top;
      pane.replaceChildren(...lines.map((line) => element('span', {class: had && !had.has(line) ? 'new' : ''}, line + '\n')),
        element('span', {class: 'note'}, note));
      pane.scrollTop = top = before;
      had = new Set(lines);
    },
  };
}

/**
 * A line to type in.
 *
 * @param onLine  is given what was typed, at Enter
 * @param onTab  is given the line up to the cursor; what it promises is put there.  May be missing
 */
export function createLine({label, about, placeholder, onLine, onTab}) {
  const input = element('input', {spellcheck: 'false', autocomplete: 'off', 'aria-label': about, placeholder, keydown: onKey});
  const history = [];
  let place = 0;

  function enter() {
    if (!input.value.trim()) return;
    history.push(input.value);
    if (history.length > HISTORY_MAX) history.shift();
    place = history.length;
    onLine(input.value);
    input.value = '';
  }

  function recall(by) {
    place = Math.min(history.length, Math.max(0, place + by));
    input.value = history[place] ?? '';
  }

  /* Only if nothing was typed meanwhile. */
  async function complete() {
    const before = input.value, at = input.selectionStart;
    const rest = await onTab(before.slice(0, at));
    if (rest && input.value === before) input.setRangeText(rest, at, at, 'end');
  }

  function onKey(event) {
    const completes = onTab && event.key === 'Tab' && !event.shiftKey && input.value.trim();
    if (event.key === 'Enter') enter();
    else if (event.key === 'ArrowUp') recall(-1);
    else if (event.key === 'ArrowDown') recall(1);
    else if (completes) complete();
    else if (event.key === 'Escape') input.blur();
    if (completes || event.key === 'ArrowUp' || event.key === 'ArrowDown') event.preventDefault();
  }

  return {row: element('div', {class: 'line'}, element('label', {}, label), input), input, enter};
}
