// SPDX-License-Identifier: Apache-2.0
// Puts the page together: the feed fills a model, sixty times a second the view draws it.

import {createActor} from './act.js';
import {createTheme} from './colors.js';
import {createConsole} from './console.js';
import {decodeFrame, decodeLately, decodeStatistics} from './decode.js';
import {createDiary} from './diary.js';
import {byId, mark} from './dom.js';
import {fetchScene, openFeed} from './feed.js';
import {createHands} from './hands.js';
import {createHeader} from './header.js';
import {attachKeys} from './keys.js';
import {createLog} from './log.js';
import {createMinds} from './minds.js';
import {createPast, fetchRecording, fetchTracks, fetchWhy} from './past.js';
import {attachPointer} from './pointer.js';
import {createStatistics} from './statistics.js';
import {createTabs} from './tabs.js';
import {createTween} from './tween.js';
import {createView} from './view.js';
import {createHandsRow, createWorld} from './world.js';

const WORDS_MS = 200; /* tables and texts need not change more often */
const PAN_PX = 60;

const recording = await fetchRecording(); /* null: a run is shown */
const tracks = recording && await fetchTracks();
const actor = createActor();
const view = createView(byId('ground'), byId('live'));
const tween = createTween(), minds = createMinds(), header = createHeader(), log = createLog();
const model = {scene: null, frame: null, run: null, agents: new Map(), fired: new Map()};
const statistics = createStatistics({onPick: pick, onOpen: (name) => tabs.show(name)});
const world = createWorld(actor);
const tabs = createTabs([['Robots', statistics.panel], ['Mail', log.panel], ...(recording ? [] : [['World', world.panel]])],
  (name, onClose) => (recording ? createDiary(name, {stepMs: recording.step_ms, onWhy: tellWhy, onClose}) : consoleFor(name, onClose)),
  recording ? [] : ['observer'],
  (name) => { const index = indexOf(name); if (index >= 0 && index !== view.look.picked) pick(index); });
const hands = createHands({camera: view.camera, bodiesOf, order: world.order, canAct: () => !recording && !actor.denied && !isOver()});
view.onTop = hands.draw;
const theme = createTheme(paint);

function paint(name) {
  view.paint(name);
  statistics.paint(view.colors);
}

let picked = ''; /* name of the picked robot, for the next scene */

/* The picked robot and the console in front are one choice. */
function pick(index) {
  view.look.picked = index;
  picked = nameOf(index) ?? '';
  if (picked && indexOf(tabs.shown) >= 0 && tabs.shown !== picked) tabs.show(picked);
  if (index < 0) view.look.follow = false;
  drawTools();
}

const indexOf = (name) => model.scene?.robots.findIndex((robot) => robot.name === name) ?? -1;

const nameOf = (index) => model.scene?.robots[index]?.name;

const poseOf = (name) => bodiesOf().find((body) => body.name === name)?.pose ?? null;

function consoleFor(name, onClose) {
  return createConsole(name, actor, name === 'observer' ? null : createHandsRow(name, world.order, model.scene?.sensors ?? [], () => poseOf(name)), onClose);
}

/* All that hands can take. */
function bodiesOf() {
  const {scene, frame} = model;
  if (!scene || !frame) return [];
  const pair = (figures, poses) => figures.flatMap(({name, shape}, i) => (poses[i] ? [{name, shape, pose: poses[i]}] : []));
  return [...pair(scene.robots, frame.robots), ...pair(scene.objects, frame.objects)];
}

// --- what comes ----------------------------------------------------------------------------------

let scenes = 0, bounds = '';
let early = {}; /* what came while its scene was fetched: of a run that has ended there is no more */

/* Frames that come before their scene are none of the world that is shown.  When the server is gone
 * again it says later that there is a scene. */
async function takeScene() {
  const asked = ++scenes;
  model.scene = null;
  early = {};
  const {scene, why = ''} = await fetchScene().catch(() => ({}));
  if (asked !== scenes) return;
  header.set({blind: why});
  if (!scene) return;
  const fresh = bounds !== JSON.stringify(scene.bounds), was = picked;
  bounds = JSON.stringify(scene.bounds);
  model.scene = scene;
  model.frame = null;
  model.fired.clear();
  tween.clear();
  minds.load();
  view.load(scene);
  statistics.load(scene);
  paint(theme.name);
  tabs.load(scene);
  log.clear();
  header.set({scene});
  pick(scene.robots.findIndex(({name}) => name === was));
  if (fresh) view.fit();
  if (recording) loadPast(scene);
  if (early.frame) takeFrame(early.frame);
  if (early.statistics) takeStatistics(early.statistics);
}

function takeFrame(data) {
  if (!model.scene) early.frame = data;
  if (!model.scene || data.robots.length !== model.scene.robots.length) return;
  const frame = decodeFrame(data), now = performance.now();
  model.frame = frame;
  for (const {robot, rules} of frame.fired) model.fired.set(robot, {rules, step: frame.step});
  minds.take(frame);
  tween.push(frame, now);
  view.trails.add(frame);
  view.mails.take(frame, now);
  log.take(frame);
  world.take(frame);
  header.set({frame});
}

function takeStatistics(data) {
  if (!model.scene) early.statistics = data;
  statistics.take(decodeStatistics(data));
}

/* What was asked has no answer any more. */
function forgetAsked(why) {
  world.forget(why);
  tabs.consoles.forEach(({console}) => console.forget(why));
}

openFeed({
  link(linked, full) {
    header.set({linked, full});
    if (!linked) forgetAsked('the page has lost muster web');
  },
  hello(hello) {
    actor.hello(hello);
    header.set({hello, missed: 0, lost: 0});
    world.wait([]); /* the server says what waits, if something does */
    tabs.consoles.forEach(({console}) => console.renew());
  },
  run(run) {
    model.run = run;
    header.set({run});
  },
  scene: takeScene,
  frame: takeFrame,
  statistics: takeStatistics,
  agents({agents}) {
    model.agents = new Map(agents.map(([name, kind, state, host, reason]) => [name, {name, kind, state, host, reason}]));
  },
  said: (data) => tabs.consoleOf(data.agent)?.said(data),
  ended: (data) => tabs.consoleOf(data.agent)?.ended({...data, step: model.frame?.step ?? 0}),
  completed: (data) => tabs.consoleOf(data.agent)?.completed(data),
  ordered: (data) => world.ordered(data),
  later: ({orders}) => world.wait(orders),
  missed({frames, answers}) {
    header.set({missed: frames, lost: answers});
    if (answers > 0) forgetAsked('more came than the page could read');
  },
});

// --- a recording ---------------------------------------------------------------------------------

const past = recording && createPast(recording, {robotOf: () => tabs.shown, onMoment: takeMoment, onStall: openStall});
if (past) header.set({run: {state: 'recorded', time_ms: 0, wall_ms: 0, mails: [0], duration_ms: recording.last * recording.step_ms}});

/* The page has found the server again, perhaps. */
function loadPast(scene) {
  past.load(scene, view.colors);
  past.renew();
}

let stallAt = -1; /* the step at which a stall was asked for: it is told why of the one before */

/* After a leap nothing is known of what lies between. */
function takeMoment({frame, statistics: totals, lately, mind}, goesOn) {
  const before = goesOn ? model.frame?.step ?? -1 : -1;
  if (!goesOn) {
    tween.clear();
    log.clear();
    model.fired.clear();
    view.restart(tracks, frame.step);
  }
  log.takeLately(decodeLately(lately, recording.step_ms).filter(({step}) => step > before));
  if (frame.step !== before) takeFrame(frame);
  const decoded = decodeStatistics(totals);
  statistics.take(decoded);
  header.set({mails: decoded.robots.reduce((sum, robot) => sum + robot.sent, 0)});
  if (mind) tabs.consoleOf(mind.robot)?.take(mind);
  if (mind && frame.step !== stallAt) tabs.consoleOf(mind.robot)?.renewWhy();
}

async function tellWhy(name, step = past.step) {
  const text = await fetchWhy(step, name).catch(() => 'muster web does not answer');
  tabs.consoleOf(name)?.tell(`at ${(step * recording.step_ms / 1000).toFixed(1)} s\n${text}\n`);
}

/* A stall that a step finds came of what was set up to the step before. */
function openStall([robot, from]) {
  stallAt = from;
  past.seek(from);
  pick(robot);
  const name = nameOf(robot);
  tabs.show(name).show('Why');
  tellWhy(name, Math.max(0, from - 1));
}

// --- what people do ------------------------------------------------------------------------------

function turn(name) {
  view.look[name] = !view.look[name];
  drawTools();
}

const BEAMS = {picked: 'all', all: 'none', none: 'picked'};

const tools = {
  fit() {
    view.look.follow = false;
    view.fit();
  },
  in: () => view.camera.zoom(1.3),
  out: () => view.camera.zoom(1 / 1.3),
  follow: () => view.look.picked >= 0 && turn('follow'),
  trails: () => turn('trails'),
  mail: () => turn('mail'),
  names: () => turn('names'),
  hands() {
    hands.on = !hands.on;
    hands.cancel();
    drawTools();
  },
  beams() {
    view.look.beams = BEAMS[view.look.beams];
    drawTools();
  },
};

function drawTools() {
  for (const button of byId('tools').children) {
    const tool = button.dataset.tool;
    if (tool === 'beams') button.textContent = `Beams: ${view.look.beams}`;
    else if (tool === 'hands') mark(button, 'aria-pressed', String(hands.on));
    else if (button.hasAttribute('aria-pressed')) mark(button, 'aria-pressed', String(view.look[tool]));
  }
  byId('live').classList.toggle('hands', hands.on);
}

byId('tools').addEventListener('click', (event) => {
  const tool = event.target.dataset.tool;
  tools[tool]?.();
  drawTools();
});
byId('theme').addEventListener('click', () => theme.toggle());

const pickAt = (x, y) => (model.frame ? view.robots.pick(view.camera, model.frame, x, y) : -1);

attachPointer(byId('live'), view.camera, hands, {
  onPick: (x, y) => pick(pickAt(x, y)),
  onOpen(x, y) {
    const name = nameOf(pickAt(x, y));
    if (name) tabs.show(name);
  },
  onMove() {
    if (view.look.follow) turn('follow');
  },
});

function next(step) {
  const count = model.scene?.robots.length ?? 0;
  if (count) pick((view.look.picked + step + count) % count);
}

function withConsole(run) {
  const name = nameOf(view.look.picked);
  if (name) run(tabs.show(name));
}

const HANDS_MS = 100; /* a key that is held down is no flood of orders */
let handsAt = 0;

/* With hands on, arrows and brackets move the picked robot. */
function handsKey(key, shift, repeats) {
  const now = performance.now();
  if (key === 'Escape' && hands.on) tools.hands();
  else if (repeats && now - handsAt < HANDS_MS) return hands.on;
  else if (!hands.key(key, shift, bodiesOf()[view.look.picked])) return false;
  else handsAt = now;
  return true;
}

const RUN_KEYS = [
  {keys: ['h'], shown: 'H', help: 'hands: drag a body to place it, with Shift to push it; or arrows, [ and ], for the picked robot', run: () => tools.hands()},
  {keys: ['w'], shown: 'W', help: 'orders to the world', run: () => { tabs.select('World'); world.focus(); }},
  {keys: ['s'], shown: 'S', help: 'suspend it, or let it go on', run: () => withConsole((c) => c.toggle())},
  {keys: ['o'], shown: 'O', help: 'the observer\'s console', run: () => tabs.show('observer').focus()},
];

const PAST_KEYS = [
  {keys: [' '], shown: 'Space', help: 'play, pause', run: () => past.toggle()},
  {keys: [','], shown: ',', help: 'a step back', repeats: true, run: () => past.by(-1)},
  {keys: ['.'], shown: '.', help: 'a step on', repeats: true, run: () => past.by(1)},
];

attachKeys([
  {keys: ['ArrowLeft', 'ArrowRight', 'ArrowUp', 'ArrowDown'], shown: '← → ↑ ↓', help: 'move the world', repeats: true,
   run: (key) => view.camera.pan({ArrowLeft: PAN_PX, ArrowRight: -PAN_PX}[key] ?? 0, {ArrowUp: PAN_PX, ArrowDown: -PAN_PX}[key] ?? 0)},
  {keys: ['+', '='], shown: '+', help: 'nearer', repeats: true, run: tools.in},
  {keys: ['-'], shown: '-', help: 'farther', repeats: true, run: tools.out},
  {keys: ['f', '0'], shown: 'F', help: 'show all of the world', run: tools.fit},
  {keys: ['j'], shown: 'J', help: 'pick the next robot', repeats: true, run: () => next(1)},
  {keys: ['k'], shown: 'K', help: 'pick the one before', repeats: true, run: () => next(-1)},
  {keys: ['Escape'], shown: 'Esc', help: 'pick none', run: () => pick(-1)},
  {keys: ['c'], shown: 'C', help: 'follow the picked robot', run: tools.follow},
  {keys: ['Enter', '/'], shown: 'Enter /', help: past ? 'its mind' : 'a line on its console', run: () => withConsole((c) => c.focus())},
  {keys: ['r'], shown: 'R', help: 'the table of robots', run: () => tabs.select('Robots')},
  ...(past ? PAST_KEYS : RUN_KEYS),
  {keys: ['t'], shown: 'T', help: 'trails', run: tools.trails},
  {keys: ['b'], shown: 'B', help: 'beams of the picked robot, of all, of none', run: tools.beams},
  {keys: ['m'], shown: 'M', help: 'mail on its way', run: tools.mail},
  {keys: ['n'], shown: 'N', help: 'names', run: tools.names},
  {keys: ['d'], shown: 'D', help: 'light or dark', run: () => theme.toggle()},
  {keys: [], shown: '?', help: 'these keys', run() {}},
], handsKey);

// --- sixty times a second ------------------------------------------------------------------------

/* Its robots are as they were last, and not there any more. */
const isOver = () => model.run?.state === 'done' || model.run?.state === 'fault';

function lookOf(name) {
  const index = model.scene ? model.scene.robots.findIndex((robot) => robot.name === name) : -1;
  return {color: view.colors[index], robot: model.frame?.robots[index], over: isOver(),
    agent: model.agents.get(name), fired: model.fired.get(index)};
}

let wordsAt = 0;

function draw(now) {
  requestAnimationFrame(draw); /* first: one picture that fails is not to be the last */
  view.resize();
  past?.draw(now);
  view.draw(tween.at(now), minds, now, model.agents);
  if (now - wordsAt >= WORDS_MS) {
    wordsAt = now;
    if (past) header.set({rate: past.speed});
    header.draw();
    log.draw();
    statistics.draw(model.frame, model.agents, view.look.picked, isOver());
    tabs.draw(lookOf);
    world.draw();
  }
}

document.querySelector('[data-tool=hands]').hidden = Boolean(recording);
drawTools();
requestAnimationFrame(draw);
