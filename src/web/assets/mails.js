// SPDX-License-Identifier: Apache-2.0
// Mail on its way: from body to body, to all as a ring; agents without a body are in a corner.

const FLIGHT_MS = 550;
const RING_MS = 700;
const FLYING_MAX = 60; /* of more, some are shown */
const ENVELOPES_MAX = 25; /* of more, each is a mere block */
const STATION = {x: 18, y: 24};
const STATIONS_MAX = 8;
const STATION_MS = 4000; /* so long one is shown behind its last mail */

const wide = (to) => to === 'all' || to === 'robots' || to.startsWith('group:') || to === 'special';

export function createMails() {
  let flying = [], names = new Map(), stations = []; /* {name, used} */

  /* Its own, else one that is shown no longer, else the one that has been used least lately. */
  function stationOf(name, now) {
    const own = stations.findIndex((station) => station.name === name);
    if (own >= 0) return own;
    const over = stations.findIndex((station) => now - station.used > STATION_MS);
    if (over >= 0 || stations.length < STATIONS_MAX) return over >= 0 ? over : stations.length;
    return stations.reduce((best, station, i) => (station.used < stations[best].used ? i : best), 0);
  }

  function placeOf(camera, frame, name, now) {
    const index = names.get(name);
    const robot = index === undefined ? null : frame.robots[index];
    if (robot) return camera.toScreen(robot.x, robot.y);
    const at = stationOf(name, now);
    stations[at] = {name, used: now};
    return [STATION.x, STATION.y + 22 * at];
  }

  function drawFlight(context, from, to, share, {color, ink, plain}) {
    const bend = 0.12 * Math.hypot(to[0] - from[0], to[1] - from[1]);
    const x = from[0] + (to[0] - from[0]) * share;
    const y = from[1] + (to[1] - from[1]) * share - 4 * bend * share * (1 - share);
    context.fillStyle = color;
    if (plain) {
      context.fillRect(x - 5, y - 3, 10, 6);
      return;
    }
    context.strokeStyle = ink.ink;
    context.lineWidth = 1.2;
    context.beginPath();
    context.rect(x - 6, y - 4, 12, 8);
    context.fill();
    context.moveTo(x - 6, y - 4);
    context.lineTo(x, y + 1);
    context.lineTo(x + 6, y - 4);
    context.stroke();
  }

  function drawRing(context, from, share, color) {
    context.beginPath();
    context.arc(from[0], from[1], 10 + 46 * share, 0, 2 * Math.PI);
    context.globalAlpha = 0.7 * (1 - share);
    context.strokeStyle = color;
    context.lineWidth = 2;
    context.stroke();
    context.globalAlpha = 1;
  }

  function drawStations(context, ink, now) {
    context.font = '600 13px system-ui, sans-serif';
    context.textAlign = 'left';
    context.textBaseline = 'middle';
    stations.forEach(({name, used}, i) => {
      if (now - used > STATION_MS) return;
      const y = STATION.y + 22 * i;
      context.fillStyle = ink.soft;
      context.fillRect(STATION.x - 6, y - 6, 12, 12);
      context.fillText(name.slice(0, 32), STATION.x + 14, y);
    });
  }

  return {
    load(scene) {
      names = new Map(scene.robots.map((robot, i) => [robot.name, i]));
      flying = [];
      stations = [];
    },
    /** Mails of a frame set out. */
    take(frame, now) {
      for (const mail of frame.mails) {
        const last = flying.findLast((f) => f.mail.from === mail.from && f.mail.to === mail.to);
        const crowded = wide(mail.to) && last && now - last.began < RING_MS / 2;
        if (!crowded && flying.length < FLYING_MAX) flying.push({mail, began: now});
      }
    },
    draw(context, camera, frame, now, {colors, ink, ratio}) {
      context.setTransform(ratio, 0, 0, ratio, 0, 0);
      flying = flying.filter((f) => now - f.began < (wide(f.mail.to) ? RING_MS : FLIGHT_MS));
      const plain = flying.length > ENVELOPES_MAX;
      for (const {mail, began} of flying) {
        const color = colors[names.get(mail.from)] ?? ink.soft;
        const from = placeOf(camera, frame, mail.from, now);
        /* The picture's time may lie a little before that at which a mail came. */
        const age = Math.max(0, now - began);
        if (wide(mail.to)) drawRing(context, from, age / RING_MS, color);
        for (const to of wide(mail.to) ? [] : mail.to.split(',')) {
          drawFlight(context, from, placeOf(camera, frame, to, now), age / FLIGHT_MS, {color, ink, plain});
        }
      }
      drawStations(context, ink, now);
    },
  };
}
