// SPDX-License-Identifier: Apache-2.0
// Elements without markup: what strangers wrote is only ever text.

/** Makes an element; children are elements or strings. */
export function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === 'function') made.addEventListener(name, value);
    else if (value === true) made.setAttribute(name, '');
    else if (value !== false && value !== undefined) made.setAttribute(name, value);
  }
  made.append(...children);
  return made;
}

/** Closes what it stands on. */
export const closeButton = (run) => element('button', {type: 'button', class: 'close', title: 'close this tab', click: run}, 'Close');

/** Sets text only where it differs, which spares the browser a layout. */
export function say(node, text) {
  if (node.textContent !== text) node.textContent = text;
}

/** Sets an attribute only where it differs. */
export function mark(node, name, value) {
  if (node.getAttribute(name) !== value) node.setAttribute(name, value);
}

/** What a browser keeps in its localStorage or sessionStorage; one that keeps nothing gives null. */
export function createStore(kind) {
  const attempt = (run) => {
    try {
      return run(window[kind]);
    } catch {
      return null;
    }
  };
  return {
    get: (name) => attempt((store) => store.getItem(name)),
    set: (name, value) => attempt((store) => store.setItem(name, value)),
  };
}

export const byId = (id) => document.getElementById(id);
