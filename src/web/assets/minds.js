// SPDX-License-Identifier: Apache-2.0
// What is known of robots' minds: their goals, as they say them in frames.

export function createMinds() {
  let goals = [];
  return {
    load() {
      goals = [];
    },
    take(frame) {
      goals = frame.goals;
    },
    /** In words, or "". */
    goalOf: (index) => goals[index] || '',
    /** Where it wants to go, in metres; null: nowhere that is known. */
    placeOf(index) {
      const [word, x, y] = this.goalOf(index).split(' ');
      const known = word === 'gohome' && isFinite(x) && isFinite(y);
      return known ? {x: x / 1000, y: y / 1000} : null;
    },
  };
}
