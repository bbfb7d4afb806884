// SPDX-License-Identifier: Apache-2.0
// Where one looks: the middle of the picture in metres, and how many pixels a metre has.

const NEAREST = 2000;
const FARTHEST = 0.5;

export function createCamera() {
  const camera = {
    x: 0, y: 0, scale: 40, width: 1, height: 1,
    /** Is counted up with each change, for users that keep a picture of what does not move. */
    version: 0,
    /** Whether all is shown, and the view was not moved since. */
    fitted: true,

    resize(width, height) {
      if (width === camera.width && height === camera.height) return;
      camera.width = width;
      camera.height = height;
      camera.version++;
    },

    moveTo(x, y) {
      if (x === camera.x && y === camera.y) return;
      camera.x = x;
      camera.y = y;
      camera.fitted = false;
      camera.version++;
    },

    /** Shows all of [x0, y0, x1, y1], in metres. */
    fit([x0, y0, x1, y1]) {
      const margin = 1.08;
      const wide = camera.width / Math.max(0.1, (x1 - x0) * margin);
      const high = (camera.height - 50) / Math.max(0.1, (y1 - y0) * margin);
      camera.scale = Math.min(NEAREST, Math.max(FARTHEST, Math.min(wide, high)));
      camera.version++;
      camera.moveTo((x0 + x1) / 2, (y0 + y1) / 2 - 20 / camera.scale);
      camera.fitted = true;
    },

    /** Moves the picture with the hand. */
    pan(dx, dy) {
      camera.moveTo(camera.x - dx / camera.scale, camera.y + dy / camera.scale);
    },

    /** Nearer by a factor; what is at (px, py) stays there. */
    zoom(factor, px = camera.width / 2, py = camera.height / 2) {
      const [x, y] = camera.toWorld(px, py);
      camera.scale = Math.min(NEAREST, Math.max(FARTHEST, camera.scale * factor));
      camera.fitted = false;
      camera.version++;
      camera.moveTo(x - (px - camera.width / 2) / camera.scale,
                    y + (py - camera.height / 2) / camera.scale);
    },

    toWorld(px, py) {
      return [camera.x + (px - camera.width / 2) / camera.scale,
              camera.y - (py - camera.height / 2) / camera.scale];
    },

    toScreen(x, y) {
      return [(x - camera.x) * camera.scale + camera.width / 2,
              (camera.y - y) * camera.scale + camera.height / 2];
    },

    /** From here on a context takes metres, y upwards. */
    enter(context, ratio) {
      const s = camera.scale * ratio;
      context.setTransform(s, 0, 0, -s, camera.width / 2 * ratio - camera.x * s,
                           camera.height / 2 * ratio + camera.y * s);
    },
  };
  return camera;
}
