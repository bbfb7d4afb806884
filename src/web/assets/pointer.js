// SPDX-License-Identifier: Apache-2.0
// Mouse and fingers on the world: drag moves it, wheel and two fingers zoom, a click picks.

const CLICK_PX = 5;

/** hands: may take what is dragged. */
export function attachPointer(canvas, camera, hands, {onPick, onOpen, onMove}) {
  const down = new Map();
  let moved = 0, spread = 0, holds = false;

  const placeOf = (event) => {
    const box = canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  const spreadOf = () => {
    const [[ax, ay], [bx, by]] = [...down.values()];
    return {far: Math.hypot(ax - bx, ay - by), x: (ax + bx) / 2, y: (ay + by) / 2};
  };

  canvas.addEventListener('pointerdown', (event) => {
    canvas.setPointerCapture(event.pointerId);
    down.set(event.pointerId, placeOf(event));
    moved = down.size > 1 ? Infinity : 0;
    spread = down.size === 2 ? spreadOf().far : 0;
    if (down.size > 1) hands.cancel();
    holds = down.size === 1 && event.button === 0 && hands.grab(...placeOf(event), event.shiftKey);
    canvas.classList.add('dragging');
  });
  canvas.addEventListener('pointermove', (event) => {
    const before = down.get(event.pointerId);
    if (!before) return;
    const [x, y] = placeOf(event);
    down.set(event.pointerId, [x, y]);
    if (down.size === 2) {
      const now = spreadOf();
      camera.zoom(now.far / Math.max(1, spread), now.x, now.y);
      spread = now.far;
      return;
    }
    moved += Math.hypot(x - before[0], y - before[1]);
    if (holds) hands.drag(x, y);
    if (holds || moved <= CLICK_PX) return;
    camera.pan(x - before[0], y - before[1]);
    onMove();
  });
  const up = (event) => {
    const lets = down.delete(event.pointerId) && event.type === 'pointerup';
    if (holds) hands.drop(lets && moved > CLICK_PX);
    if (lets && moved <= CLICK_PX) onPick(...placeOf(event));
    holds = false;
    canvas.classList.toggle('dragging', down.size > 0);
  };
  canvas.addEventListener('pointerup', up);
  canvas.addEventListener('pointercancel', up);
  canvas.addEventListener('dblclick', (event) => onOpen(...placeOf(event)));
  canvas.addEventListener('wheel', (event) => {
    event.preventDefault();
    camera.zoom(Math.exp(-event.deltaY * (event.deltaMode ? 0.05 : 0.0015)), ...placeOf(event));
  }, {passive: false});
}
