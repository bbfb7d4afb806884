// SPDX-License-Identifier: Apache-2.0
// The keyboard: one table, which the help is made from, too.

import {byId, element} from './dom.js';

const TYPING = 'input:not([type=checkbox]):not([type=range]), textarea, select';
const MOVED = 'input[type=range]'; /* it knows arrows, and nothing of spaces */
const SCROLLED = '.output, .log, .panel'; /* arrows are theirs */

/**
 * table: rows of {keys, shown, help, repeats, run}; repeats: also while a key is held down.
 * onFirst: may take a key before them, with Shift or not, held down or not.
 */
export function attachKeys(table, onFirst) {
  const dialog = byId('keys');
  const words = table.flatMap(({shown, help}) => [element('dt', {}, ...shown.split(' ').flatMap((key) => [element('kbd', {}, key), ' '])), element('dd', {}, help)]);
  dialog.append(element('h2', {}, 'Keys'), element('dl', {}, ...words));
  dialog.addEventListener('click', () => dialog.close());
  byId('help').addEventListener('click', () => dialog.showModal());

  addEventListener('keydown', (event) => {
    const typing = event.target.matches(TYPING) || (event.target.matches(MOVED) && event.key !== ' ');
    const scrolls = event.target.matches(SCROLLED) && event.key.startsWith('Arrow');
    if (typing || scrolls || event.ctrlKey || event.altKey || event.metaKey) return;
    if (event.key === '?') {
      if (dialog.open) dialog.close();
      else dialog.showModal();
      return;
    }
    if (dialog.open) return;
    const onButton = event.target.matches('button, summary, input') && (event.key === ' ' || event.key === 'Enter');
    if (!onButton && onFirst(event.key, event.shiftKey, event.repeat)) {
      event.preventDefault();
      return;
    }
    const row = onButton ? null : table.find(({keys}) => keys.includes(event.key));
    if (!row) return;
    event.preventDefault();
    if (row.repeats || !event.repeat) row.run(event.key);
  });
}
