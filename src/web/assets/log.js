// SPDX-License-Identifier: Apache-2.0
// The mail that was sent lately, as a list; newest below.

import {element} from './dom.js';
import {createScroll} from './pane.js';

const LINES_MAX = 400;
const EACH_STEP_MAX = 12;

export function createLog() {
  const list = element('ol', {class: 'log', tabindex: '0', 'aria-label': 'mail', 'data-empty': 'No mail yet.'});
  const filter = element('input', {placeholder: 'show mail with...', 'aria-label': 'show mail with', input: again});
  const panel = element('div', {class: 'panel console'}, element('div', {class: 'line'}, filter), list);
  const keep = createScroll(list);
  let kept = [], waiting = []; /* {time, mail}: those that are shown, and those that are not yet */

  function lineOf({time, mail}) {
    const performative = mail.performative ? ` ${mail.performative}` : '';
    return element('li', {}, element('time', {}, time.toFixed(1)), element('b', {}, mail.from),
      ' → ', element('b', {}, mail.to), element('i', {}, performative), ' ', element('span', {}, mail.content));
  }

  const wanted = ({mail}) => {
    const word = filter.value.trim();
    return !word || [mail.from, mail.to, mail.performative, mail.content].some((text) => text.includes(word));
  };

  /* Another word looks through all that is kept. */
  function again() {
    list.replaceChildren();
    list.dataset.empty = filter.value.trim() ? 'No mail with that.' : 'No mail yet.';
    waiting = kept.concat(waiting);
    kept = [];
  }

  function add(lines) {
    waiting = waiting.concat(lines).slice(-LINES_MAX);
  }

  return {
    panel,
    clear() {
      kept = waiting = [];
      list.replaceChildren();
    },
    take(frame) {
      add(frame.mails.slice(0, EACH_STEP_MAX).map((mail) => ({time: frame.time, mail})));
    },
    /** Mails of several steps: {time, mail}. */
    takeLately: add,
    draw() {
      if (waiting.length === 0 || panel.hidden) return;
      keep(() => {
        list.append(...waiting.filter(wanted).map(lineOf));
        while (list.children.length > LINES_MAX) list.firstChild.remove();
      });
      kept = kept.concat(waiting).slice(-LINES_MAX);
      waiting = [];
    },
  };
}
