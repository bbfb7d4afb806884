// SPDX-License-Identifier: Apache-2.0
// The tabs at the side: the table, mail, the observer's console, and one for each robot.

import {byId, element, mark} from './dom.js';

const OPEN_AT_ONCE = 8; /* of so many robots each has a tab from the beginning */

/**
 * fixed: [title, panel] of tabs that are always there; makeConsole: by name, and what closes it;
 * names: opened at once; onShow: called with the name of an agent whose console comes to the front.
 */
export function createTabs(fixed, makeConsole, names, onShow = () => {}) {
  const strip = byId('tabs'), panels = byId('panels');
  const tabs = new Map(); /* by key: {button, panel, console} */
  let selected = '';

  function add(key, title, panel, console = null) {
    const dot = console ? element('span', {class: 'dot'}) : '';
    const button = element('button', {type: 'button', role: 'tab', 'data-tab': key, click: () => select(key)}, dot, title.slice(0, 40));
    panel.setAttribute('role', 'tabpanel');
    panel.setAttribute('aria-label', title);
    panel.hidden = true;
    tabs.set(key, {button, panel, console, dot});
    strip.append(button);
    panels.append(panel);
  }

  function select(key) {
    selected = key;
    for (const [name, tab] of tabs) {
      mark(tab.button, 'aria-selected', String(name === key));
      tab.button.tabIndex = name === key ? 0 : -1;
      tab.panel.hidden = name !== key;
    }
    tabs.get(key)?.button.scrollIntoView({block: 'nearest', inline: 'nearest'});
    if (tabs.get(key)?.console) onShow(key.slice('agent '.length));
  }

  function open(name) {
    const key = `agent ${name}`;
    if (!tabs.has(key)) {
      const console = makeConsole(name, () => close(key));
      add(key, name, console.panel, console);
    }
    return key;
  }

  /* A person that looked at it looks at the one before. */
  function close(key) {
    const {button, panel, console} = tabs.get(key);
    const keys = [...tabs.keys()], before = keys[keys.indexOf(key) - 1];
    console.leave();
    button.remove();
    panel.remove();
    tabs.delete(key);
    if (selected !== key) return;
    select(before);
    tabs.get(before).button.focus();
  }

  strip.addEventListener('keydown', (event) => {
    const keys = [...tabs.keys()], at = keys.indexOf(selected);
    const step = {ArrowRight: 1, ArrowLeft: -1}[event.key];
    if (!step) return;
    select(keys[(at + step + keys.length) % keys.length]);
    tabs.get(selected).button.focus();
    event.stopPropagation();
  });

  for (const [title, panel] of fixed) add(title, title, panel);
  names.forEach(open);
  select(fixed[0][0]);

  return {
    select,
    /** Shows the console of an agent, and gives it. */
    show(name) {
      const key = open(name);
      select(key);
      return tabs.get(key).console;
    },
    /** Another scene: tabs for its robots, where they are few. */
    load(scene) {
      if (scene.robots.length <= OPEN_AT_ONCE) scene.robots.forEach((robot) => robot.controlled && open(robot.name));
    },
    /** Whose console is shown; '': none. */
    get shown() {
      return tabs.get(selected)?.console ? selected.slice('agent '.length) : '';
    },
    consoleOf: (name) => tabs.get(`agent ${name}`)?.console,
    get consoles() {
      return [...tabs.values()].filter((tab) => tab.console);
    },
    draw(lookOf) {
      for (const [key, tab] of tabs) {
        if (!tab.console) continue;
        const look = lookOf(key.slice('agent '.length));
        tab.dot.style.setProperty('--robot', look.color ?? '');
        if (!tab.panel.hidden) tab.console.draw(look);
      }
    },
  };
}
