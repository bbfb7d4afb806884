// SPDX-License-Identifier: Apache-2.0
// Outlines of the scene as paths, in metres.

/** The path of a convex piece, or of a disc about its only corner. */
export function outlinePath(outline, path = new Path2D()) {
  const c = outline.corners;
  if (outline.radius > 0) {
    path.moveTo((c[0] ?? 0) + outline.radius, c[1] ?? 0);
    path.arc(c[0] ?? 0, c[1] ?? 0, outline.radius, 0, 2 * Math.PI);
    return path;
  }
  for (let i = 0; i + 1 < c.length; i += 2) {
    if (i === 0) path.moveTo(c[0], c[1]);
    else path.lineTo(c[i], c[i + 1]);
  }
  path.closePath();
  return path;
}

/** How far an outline reaches from its origin. */
export function outlineReach(outline) {
  const c = outline.corners;
  let reach = 0.05;
  for (let i = 0; i + 1 < c.length; i += 2) {
    reach = Math.max(reach, Math.hypot(c[i], c[i + 1]) + (outline.radius ?? 0));
  }
  return reach;
}

const LABELS_MAX = 500;
const labels = new Map();

/**
 * Text with a halo, so that it is legible on anything, as a picture: halos take long to draw, and
 * names seldom change.  @return {image, width}: width of the text, in pixels of the page
 */
export function labelOf(text, font, ink, halo, ratio) {
  const key = [text, font, ink, halo, ratio].join('\n');
  if (labels.has(key)) return labels.get(key);
  if (labels.size >= LABELS_MAX) labels.clear();
  const image = new OffscreenCanvas(1, 1);
  const context = image.getContext('2d');
  context.font = font;
  const width = Math.ceil(context.measureText(text).width);
  image.width = (width + 8) * ratio;
  image.height = 26 * ratio;
  context.scale(ratio, ratio);
  Object.assign(context, {font, textBaseline: 'bottom', lineJoin: 'round', lineWidth: 4, strokeStyle: halo, fillStyle: ink});
  context.strokeText(text, 4, 22);
  context.fillText(text, 4, 22);
  const label = {image, width};
  labels.set(key, label);
  return label;
}

/** Draws it with the middle of its lower edge there. */
export function drawLabel(context, {image, width}, x, y) {
  context.drawImage(image, Math.round(x - width / 2) - 4, Math.round(y) - 22, width + 8, 26);
}

/** A step of 1, 2 or 5 times a power of ten, near a length. */
export function roundStep(length) {
  const power = 10 ** Math.floor(Math.log10(length));
  return power * (length / power >= 5 ? 5 : length / power >= 2 ? 2 : 1);
}
