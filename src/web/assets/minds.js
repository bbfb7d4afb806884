// SPDX-License-Identifier: Apache-2.0
// What is known of robots' minds: their goals, from frames or from the facts that a console showed.

const GOAL = /\(goal ([^()]*)\)/g;

export function createMinds() {
  let goals = [], seen = new Map(), names = [], step = 0;
  return {
    load(scene) {
      names = scene.robots.map((robot) => robot.name);
      goals = [];
      seen = new Map();
    },
    take(frame) {
      goals = frame.goals;
      step = frame.step;
      for (const {robot} of frame.fired) {
        if (seen.get(names[robot])?.until < step) seen.delete(names[robot]);
      }
    },
    /** Facts that a console has shown: they hold until a rule fires.  An answer overtakes frames. */
    takeFacts(name, text) {
      const found = [...text.matchAll(GOAL)].pop();
      if (found) seen.set(name, {goal: found[1], until: step + 5});
      else seen.delete(name);
    },
    /** In words, or "". */
    goalOf: (index) => goals[index] || seen.get(names[index])?.goal || '',
    /** Where it wants to go, in metres; null: nowhere that is known. */
    placeOf(index) {
      const [word, x, y] = this.goalOf(index).split(' ');
      const known = word === 'gohome' && isFinite(x) && isFinite(y);
      return known ? {x: x / 1000, y: y / 1000} : null;
    },
  };
}
