// SPDX-License-Identifier: Apache-2.0
// Hands on the world: the tab with its line, what became of each order, and a row for each robot.

import {byId, element, say} from './dom.js';
import {createLine, createPane} from './pane.js';

const PACES = ['0.25', '0.5', '1', '2', '5', '10', '0'];
const PUSH_N = 100;
const TOAST_MS = 5000;

/* Also while another tab is shown. */
function toast(text, bad) {
  const said = byId('said');
  say(said, text);
  said.classList.toggle('bad', bad);
  said.hidden = false;
  clearTimeout(toast.timer);
  toast.timer = setTimeout(() => { said.hidden = true; }, TOAST_MS);
}

/** A number as an order has it. */
export const number = (x) => String(+x.toFixed(3));

/* An order as people read it; at, when: '' for none. */
const shownOf = (line, at, when) => [line, at && `at ${at} s`, when && `when ${when}`].filter(Boolean).join(', ');

/* When an order is to be done: a time, a condition, or both; empty: at once. */
function createLater(onEnter) {
  const keydown = (event) => event.key === 'Enter' && onEnter?.();
  const at = element('input', {class: 'seconds', inputmode: 'decimal', autocomplete: 'off', placeholder: 'at once', 'aria-label': 'not before this time of the run, in seconds', keydown});
  const when = element('input', {spellcheck: 'false', autocomplete: 'off', placeholder: 'red near blue 0.5', 'aria-label': 'not before this condition has come true', keydown});
  const get = () => ({at: at.value.trim(), when: when.value.trim()});
  return {
    controls: [at, when],
    row: element('div', {class: 'row later'}, element('label', {}, 'at', at, 's'), element('label', {class: 'rest'}, 'when', when)),
    get,
    /** The order is out; what was typed since stays. */
    done(sent) {
      if (get().at === sent.at) at.value = '';
      if (get().when === sent.when) when.value = '';
    },
  };
}

export function createWorld(actor) {
  const {pane, add} = createPane('Orders, and what became of them.');
  const asked = new Map(); /* orders that have no answer yet, by number */
  const denied = element('p', {class: 'denied'});
  const pace = element('select', {'aria-label': 'times real time', change: setPace},
    element('option', {value: ''}, 'choose'),
    ...PACES.map((value) => element('option', {value}, value === '0' ? 'as fast as it goes' : `${value} ×`)));
  const reset = element('button', {type: 'button', 'data-do': 'Reset all', click: () => order('reset', later)}, 'Reset all');
  const {row, input, enter} = createLine({label: 'world>', about: 'an order to the world', placeholder: 'place red 1 -2 90', onLine: (line) => order(line, later)});
  const later = createLater(enter);
  const waiting = element('ul', {class: 'waiting', 'aria-label': 'orders that wait'});
  const panel = element('div', {class: 'panel console'},
    element('h2', {}, 'The world'), denied,
    element('p', {class: 'quiet wraps'}, 'place NAME X Y [DEG] · push NAME FX FY [TORQUE] · reset [NAME] · sensor NAME SENSOR on|off · pace R'),
    element('div', {class: 'row'}, reset, element('label', {}, 'pace', pace)), waiting, pane, row, later.row);

  function setPace() {
    if (pace.value) order(`pace ${pace.value}`);
    pace.value = '';
  }

  /* times: the fields that say when; without them: at once. */
  function order(line, times) {
    const {at = '', when = ''} = times?.get() ?? {};
    const {ask, failed} = actor.order([line, at && `at ${at}`, when && `when ${when}`].filter(Boolean).join('\n'));
    const shown = shownOf(line, at, when);
    asked.set(ask, shown);
    add('typed', `world> ${shown}\n`);
    failed.then((why) => {
      if (!why) times?.done({at, when});
      else if (asked.has(ask)) end(ask, 'failure', why);
    });
  }

  function end(ask, kind, text) {
    const shown = asked.get(ask);
    asked.delete(ask);
    add(kind, `${shown}: ${text}\n`);
    toast(`${shown}: ${text}`, kind === 'failure');
  }

  return {
    panel,
    order,
    focus: () => input.focus(),
    ordered({ask, good, step, text, order: line, at_s: at, when}) {
      const became = good ? `done at step ${step}` : text;
      if (asked.has(ask)) end(ask, good ? 'answer' : 'failure', became);
      else add('trace', `page: ${shownOf(line, at, when)}: ${became}\n`);
    },
    /** All orders for later that wait, of all pages. */
    wait(orders) {
      waiting.replaceChildren(...orders.map(({order: line, at_s: at, when}) =>
        element('li', {}, element('b', {}, 'waits'), ' ', shownOf(line, at, when))));
    },
    /** Others have hands, too. */
    take(frame) {
      for (const {source, order: what, name} of frame.orders) {
        if (source !== 'page') add('trace', `${frame.time.toFixed(1)} s  ${source}: ${what} ${name}\n`);
      }
    },
    /** Answers are lost, or the server is, which knows nothing of us when it is there again. */
    forget(why) {
      if (asked.size > 0) add('note', `no answer: ${why}\n`);
      asked.clear();
    },
    draw() {
      say(denied, actor.denied);
      denied.hidden = !actor.denied;
      for (const control of [pace, reset, input, ...later.controls]) control.disabled = Boolean(actor.denied);
    },
  };
}

/** What hands can do to one robot.  sensors: their words.  poseOf: where it is now; null: not known. */
export function createHandsRow(name, order, sensors, poseOf) {
  const field = (what) => element('input', {type: 'number', step: 'any', 'aria-label': what, placeholder: what});
  const x = field('x m'), y = field('y m'), turn = field('degrees'), later = createLater();
  const sensor = element('select', {'aria-label': 'sensor'}, ...['all', ...sensors].map((value) => element('option', {value}, value)));

  /* What is left empty stays as it is. */
  function place() {
    const pose = poseOf();
    if (!pose) return;
    const at = [x.value || number(pose.x), y.value || number(pose.y)];
    order(['place', name, ...at, ...(turn.value ? [turn.value] : [])].join(' '), later);
  }

  function push() {
    const pose = poseOf();
    if (pose) order(`push ${name} ${number(PUSH_N * Math.cos(pose.heading))} ${number(PUSH_N * Math.sin(pose.heading))}`, later);
  }

  const does = [['Place', place], [`Push, ${PUSH_N} N ahead`, push], ['Reset', () => order(`reset ${name}`, later)],
    ['Block', () => order(`sensor ${name} ${sensor.value} off`, later)], ['Unblock', () => order(`sensor ${name} ${sensor.value} on`, later)]];
  const [placing, pushing, resetting, blocking, unblocking] = does.map(([title, run]) =>
    element('button', {type: 'button', 'data-hand': title.split(',')[0], click: run}, title));
  const controls = [x, y, turn, sensor, placing, pushing, resetting, blocking, unblocking, ...later.controls];
  return {
    row: element('details', {class: 'hands'}, element('summary', {}, 'hands on it'),
      element('div', {class: 'row'}, x, y, turn, placing),
      element('div', {class: 'row'}, pushing, resetting, sensor, blocking, unblocking), later.row),
    allow(may) {
      for (const control of controls) control.disabled = !may;
    },
  };
}
