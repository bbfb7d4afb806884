// SPDX-License-Identifier: Apache-2.0
// From what the server sends to what is drawn: metres, radians, seconds, names.  Pure.

const DIGITS = 'ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_';
const VALUES = new Uint8Array(128);
for (let i = 0; i < DIGITS.length; i++) VALUES[DIGITS.charCodeAt(i)] = i;

const STATES = ['standby', 'running', 'suspended', 'moving', 'absent'];
const FLAG_STALLED = 8;

/** Readings of a list, two characters each: metres, or what the list is of. */
export function decodeBeams(text) {
  const ranges = new Float32Array(text.length >> 1);
  for (let i = 0; i < ranges.length; i++) {
    const high = VALUES[text.charCodeAt(2 * i) & 127];
    ranges[i] = (high * 64 + VALUES[text.charCodeAt(2 * i + 1) & 127]) / 100;
  }
  return ranges;
}

function decodeRobot([x, y, heading, forward, turn, , , flags]) {
  return {
    x: x / 1000, y: y / 1000, heading: heading / 1000,
    forward: forward / 1000, turn: turn / 1000,
    state: STATES[flags & 7] ?? 'absent',
    stalled: (flags & FLAG_STALLED) !== 0,
  };
}

const decodePlace = ([x, y, heading]) => ({x: x / 1000, y: y / 1000, heading: heading / 1000});

const decodeSensor = (list) => new Map(list.map(([robot, text]) => [robot, decodeBeams(text)]));

/** One step, as the view and the panels read it. */
export function decodeFrame(data) {
  return {
    step: data.step,
    time: data.time_ms / 1000,
    wall: data.wall_ms / 1000,
    robots: data.robots.map(decodeRobot),
    objects: data.objects.map(decodePlace),
    lists: Object.fromEntries(Object.entries(data.lists).map(([word, list]) => [word, decodeSensor(list)])),
    fired: data.fired.map(([robot, count, rules]) => ({robot, count, rules})),
    mails: data.mails.map(([from, to, performative, content]) => ({from, to, performative, content})),
    goals: data.goals,
    orders: data.orders.map(([source, order, name]) => ({source, order, name})),
  };
}

/** Mails of the steps before a moment. */
export function decodeLately(data, stepMs) {
  return data.map(([step, from, to, performative, content]) =>
    ({step, time: step * stepMs / 1000, mail: {from, to, performative, content}}));
}

/** Totals since the run began, in the order of the scene. */
export function decodeStatistics(data) {
  const time = data.time_ms / 1000;
  return {
    time,
    robots: data.robots.map(([distance, stalls, stalled, firings, sent, received]) => ({
      distance: distance / 1000, stalls, stalled: stalled / 1000, firings, sent, received,
      speed: time > 0 ? distance / 1000 / time : 0,
    })),
  };
}
