// SPDX-License-Identifier: Apache-2.0
// What people do from the page.  Only a page with the token can: it comes in the address's fragment,
// which browsers do not send, and is kept for this tab alone.

import {createStore} from './dom.js';

const PATIENCE_MS = 6000;
const PAUSE_MS = 150;

function takeToken() {
  const store = createStore('sessionStorage'), found = /^#token=([0-9a-f]{32})$/.exec(location.hash);
  if (!found) return store.get('muster-token');
  store.set('muster-token', found[1]);
  history.replaceState(null, '', location.pathname);
  return found[1];
}

const pause = () => new Promise((resolve) => setTimeout(resolve, PAUSE_MS));

export function createActor() {
  const token = takeToken();
  let viewer = null, asks = 0, readOnly = false;

  function send(path, ask, body) {
    return fetch(path, {
      method: 'POST', body,
      headers: {'X-Muster-Token': token, 'X-Muster-Viewer': viewer, 'X-Muster-Ask': String(ask),
                'Content-Type': 'text/plain; charset=utf-8'},
    });
  }

  /* One after the other: lines are to arrive in the order in which they were typed.  Each receiver
   * has a turn of its own, so that no console waits for the lines of another. */
  const turns = new Map();
  function postInTurn(whom, ...request) {
    const done = (turns.get(whom) ?? Promise.resolve()).then(() => post(...request), () => post(...request));
    turns.set(whom, done);
    return done.catch(() => 'muster web does not answer');
  }

  /* The server says 503 while its agent joins, 429 while others' lines wait. */
  async function post(path, ask, body = '') {
    const until = performance.now() + PATIENCE_MS;
    for (;;) {
      const answer = await send(path, ask, body);
      if (answer.ok) return '';
      const later = answer.status === 503 || answer.status === 429;
      if (!later || performance.now() > until) return (await answer.text()).trim();
      await pause();
    }
  }

  return {
    hello(data) {
      viewer = data.viewer;
      readOnly = data.read_only;
    },
    /** Why this page may not act; "": it may. */
    get denied() {
      if (readOnly) return 'This page was started with --read-only: it only shows.';
      return token ? '' : 'To act, open the address that muster web has printed: it has the token.';
    },
    /** Sends lines of CLIPS.  @return {ask, failed}: failed is a promise of why not, or "" */
    say(agent, text) {
      const ask = ++asks;
      return {ask, failed: postInTurn(agent, `/lines/${encodeURIComponent(agent)}`, ask, text)};
    },
    /** Asks how a line goes on.  @return likewise */
    complete(agent, text) {
      const ask = ++asks;
      return {ask, failed: postInTurn(agent, `/words/${encodeURIComponent(agent)}`, ask, text)};
    },
    /** Sends an order to the world: its line, and in lines behind it when.  @return likewise */
    order(text) {
      const ask = ++asks;
      return {ask, failed: postInTurn('the world', '/world', ask, text)};
    },
    /** Asks to be shown what the agent prints, or no longer. */
    watch: (agent, on) => postInTurn(agent, `/${on ? 'watch' : 'leave'}/${encodeURIComponent(agent)}`, 0),
  };
}
