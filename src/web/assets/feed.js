// SPDX-License-Identifier: Apache-2.0
// The stream of events from the server.  The browser connects again by itself when it breaks.

const EVENTS = ['hello', 'run', 'scene', 'frame', 'statistics', 'agents', 'said', 'ended',
  'completed', 'ordered', 'later', 'missed'];
const AGAIN_MS = 2000;

/* Whether the server has no room for another page; what it does not say it has not. */
async function isFull() {
  const answer = await fetch('/events', {method: 'HEAD', cache: 'no-store'}).catch(() => null);
  return answer?.status === 503;
}

/**
 * handlers: by event, each with its data; and `link`, with whether the server is there, and if not,
 * whether it has too many pages.
 */
export function openFeed(handlers) {
  const source = new EventSource('/events');
  for (const name of EVENTS) {
    source.addEventListener(name, (event) => handlers[name]?.(JSON.parse(event.data)));
  }
  source.onopen = () => handlers.link(true, false);
  source.onerror = async () => {
    handlers.link(false, false);
    if (source.readyState !== EventSource.CLOSED) return;
    setTimeout(() => openFeed(handlers), AGAIN_MS);
    if (await isFull()) handlers.link(false, true);
  };
}

/** The scene, which is fetched because it may be large: {scene}, or {why} there is none. */
export async function fetchScene() {
  const answer = await fetch('/scene', {cache: 'no-store'});
  return answer.ok ? {scene: await answer.json()} : {why: (await answer.text()).trim()};
}
