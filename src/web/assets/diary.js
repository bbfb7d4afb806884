// SPDX-License-Identifier: Apache-2.0
// A robot's mind at a moment of a recording: facts, agenda, what fired last, its mails, and why it
// drove as it did.  It stands where a run has the robot's console.

import {closeButton, element, mark, say} from './dom.js';

/* title, lines of a mind */
const VIEWS = [
  ['Facts', (mind) => mind.facts.map(([index, fact]) => `${index.padEnd(8)}${fact}`)],
  ['Agenda', (mind) => mind.agenda.map(([rule, facts]) => `${rule}: ${factsOf(facts)}`)],
  ['Fired', (mind, secondsOf) => mind.fired.map(([step, rule, facts]) => `${secondsOf(step)}  ${rule}: ${factsOf(facts)}`)],
  ['Mail', (mind, secondsOf) => mind.mails.map(([step, text, sent]) => `${secondsOf(step)}  ${sent ? 'to' : 'from'} ${text}`)],
];

const factsOf = (list) => list.split(',').map((fact) => (/^\d+$/.test(fact) ? `f-${fact}` : fact)).join(',');

export function createDiary(name, {stepMs, onWhy, onClose}) {
  const output = element('pre', {class: 'output', tabindex: '0'});
  const dot = element('span', {class: 'dot'}), state = element('span', {class: 'state'});
  const pose = element('div', {class: 'pose'}), rule = element('div', {class: 'pose'});
  const secondsOf = (step) => `${(step * stepMs / 1000).toFixed(1)} s`;
  const views = [...VIEWS.map(([title]) => title), 'Why'].map((title) =>
    element('button', {type: 'button', 'data-view': title, click: () => show(title)}, title));
  const panel = element('div', {class: 'panel console'},
    element('h2', {}, dot, name, state, closeButton(onClose)), pose, rule,
    element('div', {class: 'row', role: 'toolbar', 'aria-label': 'what is shown'}, ...views), output);
  let view = 'Facts', mind = null, had = new Set();
  show('Facts');

  function fill() {
    const row = VIEWS.find(([title]) => title === view);
    if (!row || !mind) return;
    const known = mind.step < 0 ? ['The recording knows nothing of its mind then.'] : row[1](mind, secondsOf);
    const lines = known.length > 0 ? known : ['There is nothing.'];
    const fresh = (line) => view === 'Facts' && had.size > 0 && !had.has(line);
    const top = output.scrollTop;
    output.replaceChildren(...lines.map((line) => element('span', {class: fresh(line) ? 'new' : ''}, line + '\n')));
    output.scrollTop = top;
    had = view === 'Facts' ? new Set(lines) : new Set();
  }

  function show(title) {
    view = title;
    had = new Set();
    output.replaceChildren();
    for (const button of views) mark(button, 'aria-pressed', String(button.dataset.view === title));
    if (title === 'Why') onWhy(name);
    else fill();
  }

  return {
    panel,
    focus: () => output.focus(),
    toggle() {},
    said() {},
    ended() {},
    forget() {},
    renew() {},
    leave() {},
    show,
    /** A chain of causes, when that is what is looked at. */
    tell(text) {
      if (view === 'Why') say(output, text);
    },
    /** Another moment is shown. */
    renewWhy() {
      if (view === 'Why') onWhy(name);
    },
    /** What was in its mind at the moment that is shown. */
    take(next) {
      mind = next;
      fill();
    },
    draw({color, robot}) {
      dot.style.setProperty('--robot', color ?? '');
      if (!robot) return;
      say(state, ` ${robot.stalled ? 'stalled' : robot.state}`);
      mark(state, 'data-state', robot.stalled ? 'stalled' : robot.state);
      say(rule, mind?.fired[0] ? `last fired: ${mind.fired[0][1]} (${secondsOf(mind.fired[0][0])})` : '');
      say(pose, `x ${robot.x.toFixed(2)} m   y ${robot.y.toFixed(2)} m   heading ${(robot.heading * 180 / Math.PI).toFixed(0)}°   ` +
        `${robot.forward.toFixed(2)} m/s   ${(robot.turn * 180 / Math.PI).toFixed(0)}°/s`);
    },
  };
}
