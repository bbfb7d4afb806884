/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file watch.h
 * A run that is watched: its phases, and from samples of Scene and Frame to what a stranger's
 * program sees of them.
 */
#ifndef MUSTER_RUNTIME_WATCH_H
#define MUSTER_RUNTIME_WATCH_H

#include "muster/monitor.h"
#include "wire.h"

/* A run as a watch sees it. */
enum watch_phase {
    WATCH_AWAY, /* no simulator is here */
    WATCH_MET,  /* one is */
    WATCH_SEEN, /* its Scene has come, too */
    WATCH_OVER_AWAY,
    WATCH_OVER_MET, /* its status says that the run is over; Frames may still come */
    WATCH_OVER_SEEN,
    WATCH_TOLD_AWAY, /* the program knows of the end, and the status still stands */
    WATCH_TOLD_MET,
    WATCH_PHASES
};

enum watch_event {
    WATCH_MEETS, /* what the network brings */
    WATCH_SCENE,
    WATCH_GOES_ON, /* a status that is no end */
    WATCH_ENDS,
    WATCH_LEAVES, /* the simulator */
    WATCH_TELLS,  /* our own: the program is told of the end */
    WATCH_EVENTS
};

/** Applies an event.  There is no end to tell of a run that is not known, or was told. */
void watch_phase_on(enum watch_phase *phase, enum watch_event event);

/** @return whether the program is to hear of an end */
bool watch_may_tell(enum watch_phase phase);

struct watch_room; /* start-up memory */

struct watch_room *watch_room_take(void);

/** @return the Scene, good until the next one, as the sample is */
const struct mu_scene *watch_scene(struct watch_room *r, const muster_Scene *sample);

/** @return the Frame, good until the next one, as the sample is; missed is 0 */
struct mu_frame *watch_frame(struct watch_room *r, const muster_Frame *sample);

#endif
