// SPDX-License-Identifier: Apache-2.0
// The stream of events from the server.  The browser connects again by itself when it breaks.

const EVENTS = ['hello', 'run', 'scene', 'frame', 'statistics', 'agents', 'said', 'ended',
  'completed', 'ordered', 'later', 'missed'];

/** handlers: by event, each with its data; and `link`, with whether the server is there. */
export function openFeed(handlers) {
  const source = new EventSource('/events');
  for (const name of EVENTS) {
    source.addEventListener(name, (event) => handlers[name]?.(JSON.parse(event.data)));
  }
  source.onopen = () => handlers.link(true);
  source.onerror = () => {
    handlers.link(false);
    if (source.readyState === EventSource.CLOSED) setTimeout(() => openFeed(handlers), 2000);
  };
}

/** The scene, which is fetched because it may be large; null: there is none. */
export async function fetchScene() {
  const answer = await fetch('/scene', {cache: 'no-store'});
  return answer.ok ? answer.json() : null;
}
