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

/** Draws text with a halo, so that it is legible on anything. */
export function drawText(context, text, x, y, ink, halo) {
  context.lineJoin = 'round';
  context.lineWidth = 4;
  context.strokeStyle = halo;
  context.strokeText(text, x, y);
  context.fillStyle = ink;
  context.fillText(text, x, y);
}

/** A step of 1, 2 or 5 times a power of ten, near a length. */
export function roundStep(length) {
  const power = 10 ** Math.floor(Math.log10(length));
  return power * (length / power >= 5 ? 5 : length / power >= 2 ? 2 : 1);
}
