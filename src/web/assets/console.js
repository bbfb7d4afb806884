// SPDX-License-Identifier: Apache-2.0
// The console of one agent: its facts, agenda and rules, buttons, and a line of CLIPS.

import {closeButton, element, mark, say} from './dom.js';
import {createAnswer, createLine, createPane} from './pane.js';

/* button, line, key for its title; N stands for the number beside it */
const ROBOT_BUTTONS = [['Start', '(run)'], ['Suspend', '(suspend)'], ['Step', '(step N)'], ['Resume', '(resume)']];
const OBSERVER_BUTTONS = [['Start all', '(start robots)'], ['Suspend all', '(suspend robots)'],
  ['Resume all', '(resume robots)'], ['Agents', '(agents)']];
/* title, line that asks for it, what is said until there is an answer */
const VIEWS = [['Log', null, 'What it prints, what is watched, and answers to lines.'],
  ['Facts', '(facts)', 'No facts were shown yet.'], ['Agenda', '(agenda)', 'No agenda was shown yet.'],
  ['Rules', '(rules)', 'No rules were shown yet.']];
const WATCHES = ['facts', 'rules', 'activations'];

const degrees = (angle) => Math.round(angle * 180 / Math.PI) + 0; /* no minus zero */

/** hands: a row of what hands can do to it; null: none.  onClose: closes its tab; the observer's stays. */
export function createConsole(name, actor, hands, onClose) {
  const isObserver = name === 'observer';
  const panes = new Map(VIEWS.map(([title, line, empty]) => [title, (line ? createAnswer : createPane)(empty)]));
  const asked = new Map(); /* by number: {view, text} */
  const completions = new Map(); /* what waits for a word's end, by number */
  let view = 'Log', watching = false, wasWatching = false;

  const dot = element('span', {class: 'dot'});
  const state = element('span', {class: 'state'});
  /* Lines that are there from the beginning: what comes later must not move a button. */
  const pose = element('div', {class: 'pose', hidden: isObserver});
  const rule = element('div', {class: 'pose', hidden: isObserver});
  const denied = element('p', {class: 'denied'});
  const count = element('input', {type: 'number', value: '1', min: '1', max: '10000', 'aria-label': 'rules in a step'});
  const {row: line, input} = createLine({label: `${name}>`, about: `a line for ${name}; TAB completes`,
    placeholder: isObserver ? '(you-do red wander)' : '(facts)', onLine: type, onTab: complete});
  const buttons = (isObserver ? OBSERVER_BUTTONS : ROBOT_BUTTONS).map(([title, line]) =>
    element('button', {type: 'button', 'data-do': title, click: () => act(line)}, title));
  if (!isObserver) buttons.splice(3, 0, count);
  const views = isObserver ? [] : VIEWS.map(([title]) =>
    element('button', {type: 'button', 'data-view': title, click: () => show(title)}, title));
  const watches = isObserver ? [] : WATCHES.map((what) => element('label', {},
    element('input', {type: 'checkbox', change: (event) => watch(what, event.target.checked)}), what));
  const holder = element('div', {class: 'holder'});
  const panel = element('div', {class: 'panel console'},
    element('h2', {}, dot, name, state, isObserver ? '' : closeButton(onClose)), pose, rule, denied,
    element('div', {class: 'row', role: 'toolbar', 'aria-label': 'what it is to do'}, ...buttons),
    element('div', {class: 'row', role: 'toolbar', 'aria-label': 'what is shown'}, ...views),
    element('div', {class: 'row', hidden: isObserver}, element('span', {class: 'quiet'}, 'watch'), ...watches),
    hands?.row ?? '', holder, line);
  show('Log', false);

  /* What is asked first makes the console known to the agent, so that breaks and traces come. */
  async function attach() {
    if (watching) return;
    watching = true;
    const why = await actor.watch(name, true);
    if (why) {
      watching = false;
      panes.get('Log').add('note', why + '\n');
    }
  }

  function ask(text, into) {
    const {ask: number, failed} = actor.say(name, text);
    asked.set(number, {view: into, text: ''});
    failed.then((why) => {
      if (why && asked.delete(number)) panes.get('Log').add('failure', why + '\n');
    });
    attach();
  }

  function type(text) {
    show('Log', false);
    panes.get('Log').add('typed', `${name}> ${text}\n`);
    ask(text, 'Log');
  }

  function act(line) {
    panes.get('Log').add('typed', `${name}> ${line.replace('N', count.value)}\n`);
    ask(line.replace('N', count.value), 'Log');
    if (view !== 'Log') refresh();
  }

  function refresh() {
    const line = VIEWS.find(([title]) => title === view)[1];
    if (line && !actor.denied) ask(line, view);
  }

  function watch(what, on) {
    ask(`(${on ? 'watch' : 'unwatch'} ${what})`, 'Log');
    show('Log', false);
  }

  function show(title, fresh = true) {
    view = title;
    const {pane} = panes.get(title);
    if (holder.firstChild !== pane) holder.replaceChildren(pane);
    for (const button of views) mark(button, 'aria-pressed', String(button.dataset.view === title));
    if (fresh) refresh();
  }

  function completed(number, rest) {
    completions.get(number)?.(rest);
    completions.delete(number);
  }

  /** @return a promise of how the line goes on */
  function complete(text) {
    const {ask: number, failed} = actor.complete(name, text);
    failed.then((why) => why && completed(number, ''));
    return new Promise((done) => completions.set(number, done));
  }

  return {
    panel,
    focus: () => input.focus(),
    /** The same as a press on Suspend, or on Resume or Start. */
    toggle() {
      const now = state.dataset.state;
      if (!actor.denied) act(now === 'suspended' ? '(resume)' : now === 'standby' ? '(run)' : '(suspend)');
    },
    said({kind, ask: number, text}) {
      const question = asked.get(number);
      if (number && !question) return; /* it was asked in a console that is closed */
      if (question && question.view !== 'Log') question.text += text;
      else panes.get('Log').add(kind, kind === 'note' ? text + '\n' : text);
    },
    ended({ask: number, step}) {
      const question = asked.get(number);
      asked.delete(number);
      if (!question || question.view === 'Log') return;
      panes.get(question.view).replace(question.text, `as of step ${step}\n`);
    },
    /** One way to go on is taken; several are shown. */
    completed({ask: number, rest, words}) {
      completed(number, rest);
      if (words.length === 0) return;
      show('Log', false);
      panes.get('Log').add('trace', words.join('  ') + '\n');
    },
    /** Answers are lost, or the server is, which knows nothing of us when it is there again. */
    forget(why) {
      if (asked.size > 0) panes.get('Log').add('note', `no answer: ${why}\n`);
      wasWatching = wasWatching || watching;
      watching = false;
      asked.clear();
      for (const number of [...completions.keys()]) completed(number, '');
    },
    /** It is closed: what is watched is not shown any more. */
    leave() {
      if (watching) actor.watch(name, false);
    },
    /** The server knows us: what was watched is watched again. */
    renew() {
      if (wasWatching) attach();
      wasWatching = false;
    },
    draw({color, robot, agent, fired, over}) {
      dot.style.setProperty('--robot', color ?? '');
      const word = agent?.state ?? (over ? 'gone' : robot?.state ?? 'not there');
      say(state, agent?.reason ? ` ${word}: ${agent.reason}` : ` ${word}`);
      mark(state, 'data-state', word);
      say(denied, actor.denied);
      denied.hidden = !actor.denied;
      for (const button of buttons) button.disabled = Boolean(actor.denied);
      input.disabled = Boolean(actor.denied);
      hands?.allow(!actor.denied && !over);
      say(rule, fired ? `last fired: ${fired.rules} (step ${fired.step})` : '');
      if (!robot) return;
      say(pose, `x ${robot.x.toFixed(2)} m   y ${robot.y.toFixed(2)} m   heading ${degrees(robot.heading)}°   ` +
        `${robot.forward.toFixed(2)} m/s   ${degrees(robot.turn)}°/s`);
    },
  };
}
