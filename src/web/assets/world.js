// SPDX-License-Identifier: Apache-2.0
// Hands on the world: the tab with its line, what became of each order, and a row for each robot.

import {byId, element, say} from './dom.js';
import {createLine, createPane} from './pane.js';

const PACES = ['0.25', '0.5', '1', '2', '5', '10', '0'];
const SENSORS = ['all', 'sonar', 'laser', 'camera', 'fiducials'];
const PUSH_N = 100;
const TOAST_MS = 5000;

/* Also for who looks at another tab. */
function toast(line, text, bad) {
  const said = byId('said');
  say(said, `${line}: ${text}`);
  said.classList.toggle('bad', bad);
  said.hidden = false;
  clearTimeout(toast.timer);
  toast.timer = setTimeout(() => { said.hidden = true; }, TOAST_MS);
}

/** A number as an order has it. */
export const number = (x) => String(+x.toFixed(3));

export function createWorld(actor) {
  const {pane, add} = createPane();
  const asked = new Map(); /* orders that have no answer yet, by number */
  const denied = element('p', {class: 'denied'});
  const pace = element('select', {'aria-label': 'times real time', change: setPace},
    element('option', {value: ''}, 'choose'),
    ...PACES.map((value) => element('option', {value}, value === '0' ? 'as fast as it goes' : `${value} ×`)));
  const reset = element('button', {type: 'button', 'data-do': 'Reset all', click: () => order('reset')}, 'Reset all');
  const {row, input} = createLine({label: 'world>', about: 'an order to the world', placeholder: 'place red 1 -2 90', onLine: order});
  const panel = element('div', {class: 'panel console'},
    element('h2', {}, 'The world'), denied,
    element('p', {class: 'quiet wraps'}, 'place NAME X Y [DEG] · push NAME FX FY [TORQUE] · reset [NAME] · sensor NAME SENSOR on|off · pace R'),
    element('div', {class: 'row'}, reset, element('label', {}, 'pace', pace)), pane, row);

  function setPace() {
    if (pace.value) order(`pace ${pace.value}`);
    pace.value = '';
  }

  function order(line) {
    const {ask, failed} = actor.order(line);
    asked.set(ask, line);
    add('typed', `world> ${line}\n`);
    failed.then((why) => {
      if (why) end(ask, 'failure', why);
    });
  }

  function end(ask, kind, text) {
    const line = asked.get(ask);
    asked.delete(ask);
    add(kind, `${line ?? 'an order'}: ${text}\n`);
    toast(line, text, kind === 'failure');
  }

  return {
    panel,
    order,
    focus: () => input.focus(),
    ordered({ask, good, step, text}) {
      end(ask, good ? 'answer' : 'failure', good ? `done at step ${step}` : text);
    },
    /** Others have hands, too. */
    take(frame) {
      for (const {source, order: what, name} of frame.orders) {
        if (source !== 'page') add('trace', `${frame.time.toFixed(1)} s  ${source}: ${what} ${name}\n`);
      }
    },
    forget: () => asked.clear(),
    draw() {
      say(denied, actor.denied);
      denied.hidden = !actor.denied;
      for (const control of [pace, reset, input]) control.disabled = Boolean(actor.denied);
    },
  };
}

/** What hands can do to one robot.  poseOf: where it is now; null: nobody knows. */
export function createHandsRow(name, order, poseOf) {
  const field = (what) => element('input', {type: 'number', step: 'any', 'aria-label': what, placeholder: what});
  const x = field('x m'), y = field('y m'), turn = field('degrees');
  const sensor = element('select', {'aria-label': 'sensor'}, ...SENSORS.map((value) => element('option', {value}, value)));

  /* What is left empty stays as it is. */
  function place() {
    const pose = poseOf();
    if (!pose) return;
    const at = [x.value || number(pose.x), y.value || number(pose.y)];
    order(['place', name, ...at, ...(turn.value ? [turn.value] : [])].join(' '));
  }

  function push() {
    const pose = poseOf();
    if (pose) order(`push ${name} ${number(PUSH_N * Math.cos(pose.heading))} ${number(PUSH_N * Math.sin(pose.heading))}`);
  }

  const does = [['Place', place], [`Push, ${PUSH_N} N ahead`, push], ['Reset', () => order(`reset ${name}`)],
    ['Block', () => order(`sensor ${name} ${sensor.value} off`)], ['Unblock', () => order(`sensor ${name} ${sensor.value} on`)]];
  const [placing, pushing, resetting, blocking, unblocking] = does.map(([title, run]) =>
    element('button', {type: 'button', 'data-hand': title.split(',')[0], click: run}, title));
  const controls = [x, y, turn, sensor, placing, pushing, resetting, blocking, unblocking];
  return {
    row: element('details', {class: 'hands'}, element('summary', {}, 'hands on it'),
      element('div', {class: 'row'}, x, y, turn, placing),
      element('div', {class: 'row'}, pushing, resetting, sensor, blocking, unblocking)),
    allow(may) {
      for (const control of controls) control.disabled = !may;
    },
  };
}
