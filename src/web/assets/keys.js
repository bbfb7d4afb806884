// SPDX-License-Identifier: Apache-2.0
// The keyboard: one table, which the help is made from, too.

import {byId, element} from './dom.js';

/** table: rows of {keys, shown, help, run}. */
export function attachKeys(table) {
  const dialog = byId('keys');
  const words = table.flatMap(({shown, help}) => [element('dt', {}, ...shown.split(' ').flatMap((key) => [element('kbd', {}, key), ' '])), element('dd', {}, help)]);
  dialog.append(element('h2', {}, 'Keys'), element('dl', {}, ...words));
  dialog.addEventListener('click', () => dialog.close());
  byId('help').addEventListener('click', () => dialog.showModal());

  addEventListener('keydown', (event) => {
    /* A slider knows arrows, and nothing of spaces. */
    const typing = event.target.matches(event.key === ' ' ? 'input:not([type=range])' : 'input, textarea');
    if (typing || event.ctrlKey || event.altKey || event.metaKey) return;
    if (event.key === '?') {
      if (dialog.open) dialog.close();
      else dialog.showModal();
      return;
    }
    if (dialog.open) return;
    const onButton = event.target.matches('button, select') && (event.key === ' ' || event.key === 'Enter');
    const row = onButton ? null : table.find(({keys}) => keys.includes(event.key));
    if (!row) return;
    event.preventDefault();
    row.run(event.key);
  });
}
