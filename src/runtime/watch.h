/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file watch.h
 * From samples of Scene and Frame to what a stranger's program sees of them.
 */
#ifndef MUSTER_RUNTIME_WATCH_H
#define MUSTER_RUNTIME_WATCH_H

#include "muster/monitor.h"
#include "wire.h"

struct watch_room; /* start-up memory */

struct watch_room *watch_room_take(void);

/** @return the Scene, good until the next one, as the sample is */
const struct mu_scene *watch_scene(struct watch_room *r, const muster_Scene *sample);

/** @return the Frame, good until the next one, as the sample is; missed is 0 */
struct mu_frame *watch_frame(struct watch_room *r, const muster_Frame *sample);

#endif
