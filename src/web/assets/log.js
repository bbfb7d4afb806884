// SPDX-License-Identifier: Apache-2.0
// The mail that was sent lately, as a list; newest below.

import {element} from './dom.js';

const LINES_MAX = 400;
const EACH_STEP_MAX = 12;

export function createLog() {
  const list = element('ol', {class: 'log', 'aria-label': 'mail'});
  const filter = element('input', {placeholder: 'show mail with...', 'aria-label': 'show mail with'});
  const panel = element('div', {class: 'panel console'}, element('div', {class: 'line'}, filter), list);
  let waiting = [];

  function lineOf({time, mail}) {
    const performative = mail.performative ? ` ${mail.performative}` : '';
    return element('li', {}, element('time', {}, time.toFixed(1)), element('b', {}, mail.from),
      ' → ', element('b', {}, mail.to), element('i', {}, performative), ' ', mail.content);
  }

  const wanted = ({mail}) => {
    const word = filter.value.trim();
    return !word || [mail.from, mail.to, mail.performative, mail.content].some((text) => text.includes(word));
  };

  return {
    panel,
    clear() {
      waiting = [];
      list.replaceChildren();
    },
    take(frame) {
      const lines = frame.mails.map((mail) => ({time: frame.time, mail})).filter(wanted);
      waiting = waiting.concat(lines.slice(0, EACH_STEP_MAX)).slice(-LINES_MAX);
    },
    /** Mails of several steps: {time, mail}. */
    takeLately(lines) {
      waiting = waiting.concat(lines.filter(wanted)).slice(-LINES_MAX);
    },
    draw() {
      if (waiting.length === 0 || panel.hidden) return;
      const below = list.scrollTop + list.clientHeight >= list.scrollHeight - 20;
      list.append(...waiting.map(lineOf));
      waiting = [];
      while (list.children.length > LINES_MAX) list.firstChild.remove();
      if (below) list.scrollTop = list.scrollHeight;
    },
  };
}
